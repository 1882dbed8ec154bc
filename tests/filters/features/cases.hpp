// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Meshes with known feature lines, and properties of a feature graph.

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>
#include <random>
#include <tuple>

#include "features/features.hpp"
#include "scanmill/base/error.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {

inline FeatureLines features_of(const TriangleMesh& mesh, const FeatureParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return features(mesh, params, context);
}

inline std::string features_refusal(const TriangleMesh& mesh, const FeatureParams& params = {}) {
    return sentence_of([&] { features_of(mesh, params); });
}

inline TriangleMesh mesh_of(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
    TriangleMesh mesh;
    mesh.positions = Array<Vec3>(positions.begin(), positions.end());
    mesh.triangles = Array<Triangle>(triangles.begin(), triangles.end());
    return mesh;
}

/// Vertices at one position become one.
class MeshBuilder {
public:
    u32 vertex(const Vec3& p) {
        const auto [it, is_new] = number_.try_emplace({p.x(), p.y(), p.z()}, static_cast<u32>(positions_.size()));
        if (is_new) positions_.push_back(p);
        return it->second;
    }
    void triangle(const Vec3& a, const Vec3& b, const Vec3& c) {
        triangles_.push_back({vertex(a), vertex(b), vertex(c)});
    }
    void quad(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
        triangle(a, b, c);
        triangle(a, c, d);
    }
    TriangleMesh mesh() const { return mesh_of(positions_, triangles_); }

private:
    std::map<std::tuple<double, double, double>, u32> number_;
    std::vector<Vec3> positions_;
    std::vector<Triangle> triangles_;
};

inline Vec3 on_circle(double radius, u32 i, u32 sides, double z = 0) {
    const double angle = 2 * std::numbers::pi * (i % sides) / sides;
    return {radius * std::cos(angle), radius * std::sin(angle), z};
}

/// Radii `low` at z = 0 and `high` at z = height; open, or with caps. A radius of 0 is an apex.
inline TriangleMesh frustum(double low, double high, double height, u32 sides, bool caps) {
    MeshBuilder builder;
    for (u32 i = 0; i < sides; ++i) {
        const Vec3 a = on_circle(low, i, sides), b = on_circle(low, i + 1, sides);
        const Vec3 c = on_circle(high, i + 1, sides, height), d = on_circle(high, i, sides, height);
        if (high > 0)
            builder.quad(a, b, c, d);
        else
            builder.triangle(a, b, Vec3(0, 0, height));
        if (!caps) continue;
        builder.triangle(b, a, Vec3::Zero());
        if (high > 0) builder.triangle(d, c, Vec3(0, 0, height));
    }
    return builder.mesh();
}

inline constexpr double hole_radius = 5;
inline const std::vector<Vec3> hole_centres{{10, 10, 0}, {50, 10, 0}, {90, 10, 0}, {30, 50, 0}, {70, 50, 0}};

/// [0, 100] × [0, 60] at z = 0 with five round holes of 32 sides; 20 × 20 cells, holes in the middle of their cells.
inline TriangleMesh plate_with_holes() {
    MeshBuilder builder;
    for (int cell = 0; cell < 15; ++cell) {
        const Vec3 centre(20 * (cell % 5) + 10, 20 * (cell / 5) + 10, 0);
        const bool hole = std::ranges::find(hole_centres, centre) != hole_centres.end();
        const auto outline = [&](u32 i) {  // counter-clockwise around the square, from (10, -10) on
            const u32 side = i / 8 % 4;
            const double s = -10 + 2.5 * (i % 8);
            const Vec3 positions[4] = {{10, s, 0}, {-s, 10, 0}, {-10, -s, 0}, {s, -10, 0}};
            return Vec3(centre + positions[side]);
        };
        for (u32 i = 0; i < 32; ++i) {
            // Angles begin at -45 degrees, as the square does.
            const auto inner = [&](u32 k) { return Vec3(centre + on_circle(hole_radius, k % 32 + 28, 32)); };
            if (hole)
                builder.quad(inner(i), outline(i), outline(i + 1), inner(i + 1));
            else
                builder.triangle(centre, outline(i), outline(i + 1));
        }
    }
    return builder.mesh();
}

/// m × n unit squares at z = 0, two triangles each.
inline TriangleMesh grid(int m, int n) {
    MeshBuilder builder;
    for (int x = 0; x < m; ++x)
        for (int y = 0; y < n; ++y)
            builder.quad(Vec3(x, y, 0), Vec3(x + 1, y, 0), Vec3(x + 1, y + 1, 0), Vec3(x, y + 1, 0));
    return builder.mesh();
}

/// Two unit squares that meet in the edge from (0, 0, 0) to (0, 1, 0), normals `degrees` apart.
inline TriangleMesh hinge(double degrees) {
    const double angle = degrees * std::numbers::pi / 180;
    const Vec3 out(std::cos(angle), 0, -std::sin(angle));
    MeshBuilder builder;
    builder.quad(Vec3(-1, 0, 0), Vec3(0, 0, 0), Vec3(0, 1, 0), Vec3(-1, 1, 0));
    builder.quad(Vec3(0, 0, 0), out, out + Vec3(0, 1, 0), Vec3(0, 1, 0));
    return builder.mesh();
}

/// The same surface with vertices and triangles in another order, every triangle starting at a random corner.
inline TriangleMesh permuted(const TriangleMesh& mesh, unsigned seed) {
    std::mt19937 source(seed);
    std::vector<u32> new_number(mesh.positions.size());
    std::iota(new_number.begin(), new_number.end(), 0);
    std::ranges::shuffle(new_number, source);
    std::vector<Vec3> positions(mesh.positions.size());
    for (std::size_t v = 0; v < positions.size(); ++v) positions[new_number[v]] = mesh.positions[v];
    std::vector<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    std::ranges::shuffle(triangles, source);
    for (Triangle& triangle : triangles) {
        for (u32& vertex : triangle) vertex = new_number[vertex];
        std::ranges::rotate(triangle, triangle.begin() + static_cast<long>(source() % 3));
    }
    TriangleMesh result = mesh_of(positions, triangles);
    std::vector<Edge> sharp;
    for (const auto& [a, b] : mesh.sharp_edges) sharp.push_back(make_edge(new_number[a], new_number[b]));
    std::ranges::sort(sharp);
    result.sharp_edges = Array<Edge>(sharp.begin(), sharp.end());
    return result;
}

/// The positions of a polyline's vertices.
inline std::vector<Vec3> positions_of(const FeatureGraph& graph, const FeaturePolyline& polyline) {
    std::vector<Vec3> positions;
    for (u32 row = polyline.begin; row < polyline.end; ++row) positions.push_back(graph.positions[graph.vertices[row]]);
    return positions;
}

inline std::vector<FeaturePolyline> polylines_of(const FeatureGraph& graph, FeatureType type) {
    std::vector<FeaturePolyline> found;
    for (const FeaturePolyline& polyline : graph.polylines)
        if (polyline.type == type) found.push_back(polyline);
    return found;
}

inline double length_of(const FeatureGraph& graph, const FeaturePolyline& polyline) {
    const std::vector<Vec3> positions = positions_of(graph, polyline);
    double length = polyline.closed ? (positions.front() - positions.back()).norm() : 0;
    for (std::size_t i = 1; i < positions.size(); ++i) length += (positions[i] - positions[i - 1]).norm();
    return length;
}

template <class T>
bool same_bytes(const Buffer<T>& a, const Buffer<T>& b) {
    return a.size() == b.size() &&
           std::equal(reinterpret_cast<const u8*>(a.begin()), reinterpret_cast<const u8*>(a.end()),
                      reinterpret_cast<const u8*>(b.begin()));
}

inline bool same_graph(const FeatureGraph& a, const FeatureGraph& b) {
    const auto row = [](const FeaturePolyline& p) { return std::tuple(p.type, p.closed, p.begin, p.end); };
    return a.frame == b.frame && same_bytes(a.positions, b.positions) && same_bytes(a.vertices, b.vertices) &&
           std::ranges::equal(a.polylines, b.polylines, {}, row, row) && same_bytes(a.left_normals, b.left_normals) &&
           same_bytes(a.right_normals, b.right_normals) && same_bytes(a.corners, b.corners);
}

}  // namespace scanmill::test
