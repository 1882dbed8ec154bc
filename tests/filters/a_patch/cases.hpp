// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Meshes for a-patch, and what holds for every complex of patches, computed anew.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>

#include "a_patch/a_patch.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"
#include "support/mesh_operations.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {

using a_patches::Curvature;
using a_patches::Split;
using PatchNormals = APatchParams::Normals;

/// The mesh with corner-normals from one normal per vertex.
inline TriangleMesh with_normals(TriangleMesh mesh, const std::vector<Vec3>& normals) {
    Array<double> values;
    for (const Triangle& t : mesh.triangles)
        for (const u32 v : t) values.insert(values.end(), normals[v].data(), normals[v].data() + 3);
    mesh.face_columns = {};
    mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(values))));
    return mesh;
}

/// Inscribed in the unit sphere, with the sphere's normals.
inline TriangleMesh exact_sphere(u32 frequency) {
    const TriangleMesh mesh = geodesic_sphere(1, frequency);
    return with_normals(mesh, std::vector<Vec3>(mesh.positions.begin(), mesh.positions.end()));
}
inline double sphere_distance(const Vec3& p) { return p.norm() - 1; }

/// Radii 1 and 0.4, with the torus's normals; diagonals all in one direction.
inline TriangleMesh exact_torus(u32 around, u32 along) {
    std::vector<Vec3> positions, normals;
    std::vector<Triangle> triangles;
    for (u32 i = 0; i < around; ++i)
        for (u32 j = 0; j < along; ++j) {
            const double u = 2 * std::numbers::pi * i / around, v = 2 * std::numbers::pi * j / along;
            const Vec3 out(std::cos(u), std::sin(u), 0);
            normals.push_back(std::cos(v) * out + std::sin(v) * Vec3::UnitZ());
            positions.push_back(out + 0.4 * normals.back());
        }
    const auto id = [&](u32 i, u32 j) { return i % around * along + j % along; };
    for (u32 i = 0; i < around; ++i)
        for (u32 j = 0; j < along; ++j) {
            triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
            triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
        }
    return with_normals(soup({positions.begin(), positions.end()}, {triangles.begin(), triangles.end()}), normals);
}
inline double torus_distance(const Vec3& p) { return std::hypot(std::hypot(p.x(), p.y()) - 1, p.z()) - 0.4; }

struct PatchRun {
    APatchResult result;
    std::vector<std::string> warnings;
    Metrics metrics;
};

inline PatchRun patched(const TriangleMesh& mesh, const APatchParams& params = {}, const PointCloud* points = nullptr,
                        unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    PatchRun run{a_patch(mesh, points, params, context), {}, {}};
    run.warnings = context.warnings();
    for (const Doubt& doubt : context.doubts()) run.warnings.push_back(doubt.text);
    run.metrics = context.metrics();
    return run;
}
inline PatchRun patched(const TriangleMesh& mesh, Curvature curvature, Split split = Split::always) {
    APatchParams params;
    params.curvature = curvature;
    params.split = split;
    return patched(mesh, params);
}

/// Faces that two tetrahedra share; the largest differences of values and (relative) of gradients at random points.
/// At sharp edges only functions of one triangle join.
struct Joints {
    std::size_t shared = 0;
    double value = 0, gradient = 0;
};

inline Joints joints_of(const PatchComplex& patches) {
    std::map<std::array<u32, 3>, std::vector<u32>> tets_of;
    for (u32 tet = 0; tet < patches.tets.size(); ++tet)
        for (std::size_t without = 0; without < 4; ++without) {
            if (patches.kinds[tet] == PatchKind::continuation) continue;
            std::array<u32, 3> face;
            for (std::size_t i = 0, n = 0; i < 4; ++i)
                if (i != without) face[n++] = patches.tets[tet][i];
            std::ranges::sort(face);
            tets_of[face].push_back(tet);
        }
    Random random(7);
    Joints joints;
    for (const auto& [face, tets] : tets_of)
        for (std::size_t m = 0; m < tets.size(); ++m)
            for (std::size_t n = 0; n < m; ++n) {
                const bool is_sharp =
                    patches.kinds[tets[m]] == PatchKind::sharp || patches.kinds[tets[n]] == PatchKind::sharp;
                if (is_sharp && patches.triangles[tets[m]] != patches.triangles[tets[n]]) continue;
                ++joints.shared;
                const PatchCell one(patches, tets[m]), other(patches, tets[n]);
                for (int i = 0; i < 3; ++i) {
                    double a = random.uniform(0, 1), b = random.uniform(0, 1);
                    if (a + b > 1) a = 1 - a, b = 1 - b;
                    const Vec3 p = a * patches.positions[face[0]] + b * patches.positions[face[1]] +
                                   (1 - a - b) * patches.positions[face[2]];
                    const Vec3 g = one.gradient(p), h = other.gradient(p);
                    joints.value = std::max(joints.value, std::abs(one.value(p) - other.value(p)));
                    joints.gradient = std::max(joints.gradient, (g - h).norm() / std::max(g.norm(), h.norm()));
                }
            }
    return joints;
}

/// The normal at a triangle's corner.
inline Vec3 corner_normal(const APatchResult& result, std::size_t triangle, u32 vertex) {
    const Column* normals = result.mesh.face_columns.find("corner-normals");
    for (u32 i = 0; i < 3; ++i)
        if (result.mesh.triangles[triangle][i] == vertex)
            return {normals->number(triangle, 3 * i), normals->number(triangle, 3 * i + 1),
                    normals->number(triangle, 3 * i + 2)};
    ADD_FAILURE() << "vertex " << vertex << " is not a corner of triangle " << triangle;
    return Vec3::Zero();
}

/// The normal at a smooth vertex.
inline Vec3 vertex_normal(const APatchResult& result, u32 vertex) {
    for (std::size_t f = 0; f < result.mesh.triangles.size(); ++f)
        if (std::ranges::find(result.mesh.triangles[f], vertex) != result.mesh.triangles[f].end())
            return corner_normal(result, f, vertex);
    return Vec3::Zero();
}

/// Largest |F| and difference of the gradient from the normal at the mesh's vertices, of each triangle's function.
inline std::pair<double, double> errors_at_vertices(const APatchResult& result) {
    const PatchComplex& patches = result.patches;
    double value = 0, gradient = 0;
    for (u32 tet = 0; tet < patches.tets.size(); ++tet)
        for (const u32 v : patches.tets[tet]) {
            if (v >= result.mesh.positions.size() || patches.kinds[tet] == PatchKind::continuation) continue;
            const PatchCell cell(patches, tet);
            const Vec3 n = corner_normal(result, patches.triangles[tet], v);
            value = std::max(value, std::abs(cell.value(patches.positions[v])));
            gradient = std::max(gradient, (cell.gradient(patches.positions[v]) - n).norm());
        }
    return {value, gradient};
}

/// F in a tetrahedron, of one function or two, at coordinates of its first row.
inline double combined_value(const PatchComplex& patches, u32 tet, const Barycentric& at) {
    const double own = patch_value(patches.weights[tet], at);
    const u32 partner = patches.partners[tet];
    if (partner == PatchComplex::no_partner) return own;
    Barycentric there = Barycentric::Zero();
    for (int i = 0; i < 4; ++i)
        for (int j = 0; j < 4; ++j)
            if (patches.tets[partner][static_cast<std::size_t>(j)] == patches.tets[tet][static_cast<std::size_t>(i)])
                there[j] = at[i];
    const double other = patch_value(patches.weights[partner], there);
    return patches.combine[tet] == Combine::max ? std::max(own, other) : std::min(own, other);
}

/// The point of the surface on a line from the mesh away from it; exactly one, found by sampling. Nothing if the
/// surface is on the other side of the mesh.
inline std::optional<Vec3> point_on_ray(const PatchComplex& patches, u32 tet, const Barycentric& from,
                                        const Barycentric& to) {
    const double sign = patches.sides[tet] == 1 ? 1 : -1;
    const auto value = [&](double t) { return sign * combined_value(patches, tet, (1 - t) * from + t * to); };
    if (value(0) > 1e-15) return std::nullopt;
    int changes = 0;
    bool before = false;
    for (int step = 1; step <= 16; ++step) {
        const bool above = value(step / 16.0) > 0;
        changes += above != before;
        before = above;
    }
    EXPECT_EQ(changes, 1) << "tetrahedron " << tet << " of kind " << static_cast<int>(patches.kinds[tet]) << " from "
                          << from.transpose() << " to " << to.transpose();
    double low = 0, high = 1;
    while (true) {
        const double middle = (low + high) / 2;
        if (!(middle > low && middle < high)) break;
        (value(middle) > 0 ? high : low) = middle;
    }
    return PatchCell(patches, tet).point((1 - low) * from + low * to);
}

/// Points of the surface above random points of the triangles, on the lines to the apexes, and beside edges on the
/// lines to the segment between two apexes.
template <class Action>
std::size_t for_each_ray(const PatchComplex& patches, int per_tet, Action&& action, bool beside_all_edges = false) {
    Random random(3);
    std::size_t rays = 0;
    for (u32 tet = 0; tet < patches.tets.size(); ++tet) {
        const bool is_gap = (beside_all_edges && patches.kinds[tet] == PatchKind::edge) ||
                            (patches.kinds[tet] == PatchKind::sharp && patches.partners[tet] > tet);
        if (patches.kinds[tet] != PatchKind::face && !is_gap) continue;
        for (int i = 0; i < per_tet; ++i) {
            double a = random.uniform(0, 1), b = random.uniform(0, 1);
            if (!is_gap && a + b > 1) a = 1 - a, b = 1 - b;
            const Barycentric from = is_gap ? Barycentric(0, a, 1 - a, 0) : Barycentric(a, b, 1 - a - b, 0),
                              to = is_gap ? Barycentric(b, 0, 0, 1 - b) : Barycentric(0, 0, 0, 1);
            const auto point = point_on_ray(patches, tet, from, to);
            if (!point) continue;
            ++rays;
            action(tet, *point);
        }
    }
    return rays;
}

template <class Distance>
double worst_distance(const PatchComplex& patches, Distance&& distance, int per_tet = 20) {
    double worst = 0;
    for_each_ray(patches, per_tet, [&](u32, const Vec3& p) { worst = std::max(worst, std::abs(distance(p))); });
    return worst;
}

inline double metric_of(const PatchRun& run, std::string_view name) {
    for (const Metric& metric : run.metrics.values)
        if (metric.name == name) return metric.value;
    return std::nan("");
}

/// Interpolates, joins with equal gradients, has no tetrahedron inside out and no weight of a wrong sign.
inline void expect_sound(const PatchRun& run, double jump = 1e-11) {
    const APatchResult& result = run.result;
    const auto [value, gradient] = errors_at_vertices(result);
    EXPECT_LT(value, 1e-13);
    EXPECT_LT(gradient, 1e-12);
    const Joints joints = joints_of(result.patches);
    EXPECT_LT(joints.gradient, jump);
    EXPECT_LT(joints.value, 1e-13);
    EXPECT_LT(result.c1_jump, jump);
    EXPECT_EQ(result.inverted, 0u);
    EXPECT_EQ(result.sign_violations, 0u);
}

}  // namespace scanmill::test
