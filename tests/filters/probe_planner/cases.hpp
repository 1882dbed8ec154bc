// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parts whose edges are known, and how the tests plan them.

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>

#include "probe_planner/contact_range.hpp"
#include "probe_planner/probe_planner.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {

inline constexpr double pi = std::numbers::pi, degree = pi / 180;

/// Every triangle cut into four, `times` times; vertices are shared.
inline TriangleMesh refined(TriangleMesh mesh, int times) {
    for (int i = 0; i < times; ++i) {
        Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
        Array<Triangle> triangles;
        std::map<Edge, u32> middles;
        const auto middle = [&](u32 a, u32 b) {
            const auto [found, is_new] = middles.emplace(make_edge(a, b), static_cast<u32>(positions.size()));
            if (is_new) positions.push_back((positions[a] + positions[b]) / 2);
            return found->second;
        };
        for (const auto& [a, b, c] : mesh.triangles) {
            const u32 ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            triangles.insert(triangles.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
        }
        mesh.positions = std::move(positions);
        mesh.triangles = std::move(triangles);
    }
    return mesh;
}

/// Two meshes as one.
inline TriangleMesh joined(const TriangleMesh& one, const TriangleMesh& other) {
    TriangleMesh mesh;
    Array<Vec3> positions(one.positions.begin(), one.positions.end());
    Array<Triangle> triangles(one.triangles.begin(), one.triangles.end());
    const auto shift = static_cast<u32>(positions.size());
    positions.insert(positions.end(), other.positions.begin(), other.positions.end());
    for (const auto& [a, b, c] : other.triangles) triangles.push_back({a + shift, b + shift, c + shift});
    mesh.positions = std::move(positions);
    mesh.triangles = std::move(triangles);
    return mesh;
}

template <class Map>
TriangleMesh mapped(TriangleMesh mesh, Map&& map) {
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& p : positions) p = map(p);
    mesh.positions = std::move(positions);
    return mesh;
}

inline TriangleMesh box(const Vec3& low, const Vec3& high, int times) {
    return refined(mapped(cube(), [&](const Vec3& p) { return Vec3(low + p.cwiseProduct(high - low)); }), times);
}

inline FeatureGraph lines_of(const TriangleMesh& mesh, double sharp_angle = 40) {
    FeatureParams params;
    params.sharp_angle = Angle::degrees(sharp_angle);
    return find_features(mesh, params, Execution()).graph;
}

/// A ball of a radius and two faces at the angle alpha, in the plane of contact_range.hpp.
struct Wedge {
    double alpha, radius;
};

/// The circle moves along T + s u for falling s. Returns by how much the edge is met before both faces: positive if it
/// is, negative if a face is met first or the edge is missed. Both faces are half-lines from the edge.
inline double lead_of_edge(const Wedge& wedge, double phi, const probing::Vec2& t) {
    using probing::Vec2;
    const Vec2 u(-std::sin(phi), std::cos(phi));
    const double r = wedge.radius, along = t.dot(u), square = along * along - t.squaredNorm() + r * r;
    if (square < 0) return -1;
    const double edge = -along + std::sqrt(square);
    double lead = std::numeric_limits<double>::infinity();
    for (const double side : {-1.0, 1.0}) {
        const double a = wedge.alpha / 2;
        const Vec2 face(side * std::sin(a), -std::cos(a)), normal(side * std::cos(a), std::sin(a));
        if (normal.dot(u) <= 0) continue;  // approached from behind, where the other face is in front of it
        const double s = (r - normal.dot(t)) / normal.dot(u);
        // Where the circle would touch the face, if that is on it: then the face is met at s >= edge.
        if (face.dot(t + s * u) > 0) lead = std::min(lead, edge - s);
    }
    return lead;
}

inline ProbePlannerParams probe_of(double radius, double error, double spacing) {
    ProbePlannerParams params;
    params.radius = radius;
    params.scanner_error = error;
    params.spacing = spacing;
    return params;
}

struct Planned : ProbePlannerResult {
    Metrics metrics;
    std::vector<std::string> warnings;
    std::vector<Doubt> doubts;
};

inline Planned planned(const FeatureGraph& features, const TriangleMesh& mesh, const ProbePlannerParams& params,
                       unsigned threads = 2) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    Planned result;
    static_cast<ProbePlannerResult&>(result) = probe_planner(features, mesh, params, context);
    result.metrics = context.metrics();
    result.warnings = context.warnings();
    result.doubts = context.doubts();
    return result;
}
inline Planned planned(const TriangleMesh& mesh, const ProbePlannerParams& params, unsigned threads = 2) {
    return planned(lines_of(mesh), mesh, params, threads);
}

}  // namespace scanmill::test
