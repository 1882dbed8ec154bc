// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Meshes for edge-flip, and its rules a second time, in another form: with angles of the C library, edge by edge.

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <set>
#include <vector>

#include "edge_flip/edge_flip.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/mesh/editable_mesh.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {

using Criterion = EdgeFlipParams::Criterion;
inline constexpr Criterion all_criteria[] = {Criterion::delaunay, Criterion::shorter, Criterion::paper};
inline constexpr double degree = std::numbers::pi / 180;

inline TriangleMesh mesh_of(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
    TriangleMesh mesh;
    mesh.positions = Array<Vec3>(positions.begin(), positions.end());
    mesh.triangles = Array<Triangle>(triangles.begin(), triangles.end());
    return mesh;
}

inline EdgeFlipResult flipped(const TriangleMesh& mesh, const EdgeFlipParams& params = {}) {
    Context context;
    return edge_flip(mesh, params, context);
}
inline EdgeFlipResult flipped(const TriangleMesh& mesh, Criterion criterion) {
    EdgeFlipParams params;
    params.criterion = criterion;
    return flipped(mesh, params);
}

/// Kite with corners 0 and 1 two units apart and 2 and 3 at ±0.2 beside the middle, bent by `bend` degrees along the
/// long diagonal, which is an edge.
inline TriangleMesh kite(double bend = 0) {
    const double half = bend / 2 * degree, y = 0.2 * std::cos(half), z = 0.2 * std::sin(half);
    return mesh_of({{0, 0, 0}, {2, 0, 0}, {1, y, z}, {1, -y, z}}, {{0, 1, 2}, {1, 0, 3}});
}

/// `width` × `height` unit squares in two triangles each; inner vertices moved by up to `noise` along every axis.
inline TriangleMesh noisy_grid(u32 width, u32 height, double noise, std::uint64_t seed) {
    Random random(seed);
    std::vector<Vec3> positions;
    std::vector<Triangle> triangles;
    for (u32 y = 0; y <= height; ++y)
        for (u32 x = 0; x <= width; ++x) {
            const bool inner = x > 0 && y > 0 && x < width && y < height;
            const auto moved = [&] { return inner ? random.uniform(-noise, noise) : 0; };
            positions.emplace_back(x + moved(), y + moved(), moved());
        }
    for (u32 y = 0; y < height; ++y)
        for (u32 x = 0; x < width; ++x) {
            const u32 a = y * (width + 1) + x, b = a + 1, c = b + width + 1, d = c - 1;
            triangles.push_back({a, b, c});
            triangles.push_back({a, c, d});
        }
    return mesh_of(positions, triangles);
}

/// Every vertex moved by up to `noise` along every axis.
inline TriangleMesh shaken(TriangleMesh mesh, double noise, std::uint64_t seed) {
    Random random(seed);
    Array<Vec3> positions(mesh.positions.begin(), mesh.positions.end());
    for (Vec3& position : positions)
        for (int axis = 0; axis < 3; ++axis) position[axis] += random.uniform(-noise, noise);
    mesh.positions = std::move(positions);
    return mesh;
}

/// A triangulation of the points' hull with bad angles: points by x, each joined to the hull of those before it that it
/// sees. Pre: no three collinear.
inline TriangleMesh swept(const std::vector<Vec3>& points) {
    std::vector<u32> order(points.size());
    for (u32 i = 0; i < order.size(); ++i) order[i] = i;
    std::ranges::sort(order, {}, [&](u32 i) { return points[i].x(); });
    const auto is_left = [&](u32 a, u32 b, u32 c) {
        return (points[b] - points[a]).cross(points[c] - points[a]).z() > 0;
    };
    std::vector<Triangle> triangles;
    std::vector<u32> lower{order[0], order[1]}, upper{order[0], order[1]};
    for (std::size_t i = 2; i < order.size(); ++i) {
        const u32 p = order[i];
        for (; lower.size() > 1 && !is_left(lower[lower.size() - 2], lower.back(), p); lower.pop_back())
            triangles.push_back({lower.back(), lower[lower.size() - 2], p});
        for (; upper.size() > 1 && is_left(upper[upper.size() - 2], upper.back(), p); upper.pop_back())
            triangles.push_back({upper[upper.size() - 2], upper.back(), p});
        lower.push_back(p);
        upper.push_back(p);
    }
    return mesh_of(points, triangles);
}

inline std::vector<Vec3> random_plane(std::size_t count, std::uint64_t seed) {
    Random random(seed);
    std::vector<Vec3> points;
    for (std::size_t i = 0; i < count; ++i) points.emplace_back(random.uniform(), random.uniform(), 0);
    return points;
}

inline std::set<Edge> edges_of(const TriangleMesh& mesh) {
    std::set<Edge> edges;
    for (const auto& [a, b, c] : mesh.triangles) edges.insert({make_edge(a, b), make_edge(b, c), make_edge(c, a)});
    return edges;
}

inline double angle_at(const Vec3& apex, const Vec3& one, const Vec3& two) {
    const Vec3 u = one - apex, v = two - apex;
    return std::atan2(u.cross(v).norm(), u.dot(v));
}
inline double least_angle_of(const Vec3& a, const Vec3& b, const Vec3& c) {
    return std::min({angle_at(a, b, c), angle_at(b, c, a), angle_at(c, a, b)});
}
inline std::vector<double> sorted_angles(const TriangleMesh& mesh) {
    std::vector<double> angles;
    for (const auto& [i, j, k] : mesh.triangles) {
        const Vec3 &a = mesh.positions[i], &b = mesh.positions[j], &c = mesh.positions[k];
        angles.insert(angles.end(), {angle_at(a, b, c), angle_at(b, c, a), angle_at(c, a, b)});
    }
    std::ranges::sort(angles);
    return angles;
}
inline double total_length(const TriangleMesh& mesh) {
    double length = 0;
    for (const auto& [a, b] : edges_of(mesh)) length += (mesh.positions[a] - mesh.positions[b]).norm();
    return length;
}

/// By the least of the distances between the ends and the other segments, and of the crossing of the two lines.
inline double segment_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto to_segment = [](const Vec3& p, const Vec3& from, const Vec3& to) {
        const Vec3 along = to - from;
        return (from + std::clamp(along.dot(p - from) / along.squaredNorm(), 0.0, 1.0) * along - p).norm();
    };
    double distance = std::min({to_segment(a, c, d), to_segment(b, c, d), to_segment(c, a, b), to_segment(d, a, b)});
    Eigen::Matrix<double, 3, 2> directions;
    directions << b - a, c - d;
    const Eigen::Vector2d at = directions.colPivHouseholderQr().solve(c - a);
    if (at.minCoeff() >= 0 && at.maxCoeff() <= 1)
        distance = std::min(distance, (a + at[0] * (b - a) - c - at[1] * (d - c)).norm());
    return distance;
}

/// What the rules say of one edge.
enum class Rule { none, not_convex, criterion, sharp, connected, folding, deviating, too_long };

class Rules {
public:
    Rules(const TriangleMesh& mesh, const EdgeFlipParams& params) : half_edges(mesh), mesh_(mesh), params_(params) {}

    /// The first rule that forbids the flip; none: it is allowed. Pre: the edge has two triangles.
    Rule forbids(u32 h) const {
        const u32 other = half_edges.opposite(h);
        const u32 ia = half_edges.start(h), ib = half_edges.end(h), ic = half_edges.apex(h),
                  id = half_edges.apex(other);
        const Vec3 &a = at(ia), &b = at(ib), &c = at(ic), &d = at(id);
        if (params_.criterion != Criterion::paper)
            for (const double sum : {angle_at(a, c, b) + angle_at(a, b, d), angle_at(b, c, a) + angle_at(b, a, d)})
                if (sum >= std::numbers::pi - 1e-6) return Rule::not_convex;
        if (!criterion(a, b, c, d)) return Rule::criterion;
        if (std::ranges::count(mesh_.sharp_edges, make_edge(ia, ib)) > 0) return Rule::sharp;
        if (half_edges.has_edge(ic, id)) return Rule::connected;
        if (params_.criterion != Criterion::paper) {
            if (folds(h)) return Rule::folding;
            const double shorter = std::min((b - a).norm(), (d - c).norm());
            if (segment_distance(a, b, c, d) > (params_.deviation.value() + 1e-9) * shorter) return Rule::deviating;
        }
        if (params_.max_edge && (d - c).norm() >= params_.max_edge->value()) return Rule::too_long;
        return Rule::none;
    }

    /// Bends at the five edges of the two triangles, in radians, before and after a flip.
    std::pair<double, double> largest_bends(u32 h) const {
        const u32 other = half_edges.opposite(h);
        const Vec3 &a = at(half_edges.start(h)), &b = at(half_edges.end(h)), &c = at(half_edges.apex(h)),
                   &d = at(half_edges.apex(other));
        const Vec3 abc = normal(a, b, c), bad = normal(b, a, d), cad = normal(c, a, d), dbc = normal(d, b, c);
        double before = angle_at(Vec3::Zero(), abc, bad), after = angle_at(Vec3::Zero(), cad, dbc);
        const auto outer = [&](u32 edge, const Vec3& old_normal, const Vec3& new_normal) {
            if (half_edges.is_boundary(edge)) return;
            const auto [i, j, k] = half_edges.triangle(half_edges.opposite(edge) / 3);
            const Vec3 beyond = normal(at(i), at(j), at(k));
            before = std::max(before, angle_at(Vec3::Zero(), beyond, old_normal));
            after = std::max(after, angle_at(Vec3::Zero(), beyond, new_normal));
        };
        outer(EditableMesh::after(h), abc, dbc);
        outer(EditableMesh::before(h), abc, cad);
        outer(EditableMesh::after(other), bad, cad);
        outer(EditableMesh::before(other), bad, dbc);
        return {before, after};
    }

    EditableMesh half_edges;

private:
    const Vec3& at(u32 vertex) const { return mesh_.positions[vertex]; }
    static Vec3 normal(const Vec3& a, const Vec3& b, const Vec3& c) { return (b - a).cross(c - a); }

    bool criterion(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) const {
        const Vec3 cad = normal(c, a, d), dbc = normal(d, b, c);
        if (params_.criterion == Criterion::delaunay)
            return std::min(least_angle_of(c, a, d), least_angle_of(d, b, c)) >
                   std::min(least_angle_of(a, b, c), least_angle_of(b, a, d)) + 1e-9;
        if ((d - c).norm() >= (b - a).norm() * (1 - 1e-9)) return false;
        return params_.criterion == Criterion::shorter || angle_at(Vec3::Zero(), cad, dbc) > std::numbers::pi / 2;
    }
    bool folds(u32 h) const {
        const u32 other = half_edges.opposite(h);
        const Vec3 &a = at(half_edges.start(h)), &b = at(half_edges.end(h)), &c = at(half_edges.apex(h)),
                   &d = at(half_edges.apex(other));
        const Vec3 old_normal = normal(a, b, c) + normal(b, a, d), cad = normal(c, a, d), dbc = normal(d, b, c);
        if (cad.dot(dbc) <= 0 || cad.dot(old_normal) <= 0 || dbc.dot(old_normal) <= 0) return true;
        const auto [before, after] = largest_bends(h);
        return after > std::max(before, params_.keep_angle.in_radians()) + 1e-7;
    }

    TriangleMesh mesh_;
    EdgeFlipParams params_;
};

/// The half-edge from a to b; EditableMesh::none if there is none.
inline u32 half_edge_between(const EditableMesh& mesh, u32 a, u32 b) {
    u32 found = EditableMesh::none;
    mesh.for_each_around(a, [&](u32 h) {
        if (mesh.end(h) == b) found = h;
    });
    return found;
}

/// Edges that fulfil the criterion, and how many of them each rule forbids. `flippable`: no rule does.
struct Census {
    BlockedEdges blocked;
    std::size_t flippable = 0;
};
inline Census census(const TriangleMesh& mesh, const EdgeFlipParams& params) {
    const Rules rules(mesh, params);
    Census result;
    for (u32 h = 0; h < 3 * rules.half_edges.rows(); ++h) {
        if (rules.half_edges.is_boundary(h) || rules.half_edges.opposite(h) < h) continue;
        switch (rules.forbids(h)) {
            case Rule::none: ++result.flippable; break;
            case Rule::not_convex:
            case Rule::criterion: break;
            case Rule::sharp: ++result.blocked.sharp; break;
            case Rule::connected: ++result.blocked.connected; break;
            case Rule::folding: ++result.blocked.folding; break;
            case Rule::deviating: ++result.blocked.deviating; break;
            case Rule::too_long: ++result.blocked.too_long; break;
        }
    }
    return result;
}

inline void PrintTo(const BlockedEdges& blocked, std::ostream* stream) {
    *stream << "sharp " << blocked.sharp << ", connected " << blocked.connected << ", folding " << blocked.folding
            << ", deviating " << blocked.deviating << ", too long " << blocked.too_long;
}

/// Same topology, and a second run with nothing to do.
inline void expect_laws(const TriangleMesh& mesh, const EdgeFlipResult& result, const EdgeFlipParams& params) {
    const MeshTopology before = topology(mesh), after = topology(result.mesh);
    EXPECT_EQ(after.vertices, before.vertices);
    EXPECT_EQ(after.unused_vertices, before.unused_vertices);
    EXPECT_EQ(after.edges, before.edges);
    EXPECT_EQ(after.triangles, before.triangles);
    EXPECT_EQ(after.euler, before.euler);
    EXPECT_EQ(after.components, before.components);
    EXPECT_EQ(after.boundary_edges, before.boundary_edges);
    EXPECT_EQ(after.boundary_loops, before.boundary_loops);
    EXPECT_EQ(after.nonmanifold_edges + after.nonmanifold_vertices + after.misoriented_edges, 0u);
    EXPECT_TRUE(std::ranges::equal(result.mesh.positions, mesh.positions));
    const EdgeFlipResult again = flipped(result.mesh, params);
    EXPECT_EQ(again.flips.size(), 0u) << "a second run";
    EXPECT_TRUE(std::ranges::equal(again.mesh.triangles, result.mesh.triangles));
    EXPECT_EQ(again.left, result.left);
}

}  // namespace scanmill::test
