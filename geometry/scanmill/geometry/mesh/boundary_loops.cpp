// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/boundary_loops.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/half_edges.hpp"

namespace scanmill {

namespace {

constexpr double least_mean_normal = 0.1, least_area = 1e-3;
/// Least ratio at which one loop is longer than another. Two equal loops that are summed in opposite directions have
/// differently rounded lengths.
constexpr double longer_by = 1 + 1e-9;

/// The boundary half-edge that starts where this one ends, in the same fan of triangles.
u32 next_along_boundary(u32 half_edge, std::span<const u32> opposite) {
    u32 next = half_edges::after(half_edge);
    while (opposite[next] != half_edges::boundary) next = half_edges::after(opposite[next]);
    return next;
}

}  // namespace

std::vector<Array<u32>> boundary_loops(const TriangleMesh& mesh, std::span<const u32> opposite) {
    std::vector<Array<u32>> loops;
    std::vector<bool> visited(opposite.size(), false);
    for (u32 first = 0; first < 3 * mesh.triangles.size(); ++first) {
        if (opposite[first] != half_edges::boundary || visited[first]) continue;
        Array<u32>& loop = loops.emplace_back();
        for (u32 half_edge = first; !visited[half_edge]; half_edge = next_along_boundary(half_edge, opposite)) {
            visited[half_edge] = true;
            loop.push_back(half_edge);
        }
    }
    return loops;
}

LoopShape loop_shape(const TriangleMesh& mesh, std::span<const u32> loop, std::span<const Vec3> normals) {
    LoopShape shape;
    Vec3 twice_area = Vec3::Zero(), weighted_normals = Vec3::Zero();
    const Vec3& origin = mesh.positions[half_edges::start(mesh, loop[0])];
    for (const u32 half_edge : loop) {
        const Vec3& from = mesh.positions[half_edges::start(mesh, half_edge)];
        const Vec3& to = mesh.positions[half_edges::end(mesh, half_edge)];
        const double length = (to - from).norm();
        shape.length += length;
        weighted_normals += length * normals[half_edge / 3];
        twice_area += (from - origin).cross(to - origin);
    }
    const double coherent = weighted_normals.norm();
    if (coherent > 0) shape.area = twice_area.dot(weighted_normals / coherent) / 2;
    shape.clear = coherent > 0 && coherent >= least_mean_normal * shape.length &&
                  std::abs(shape.area) >= least_area * shape.length * shape.length;
    return shape;
}

std::vector<bool> outer_loops(std::span<const std::span<const u32>> loops, std::span<const LoopShape> shapes,
                              std::span<const u32> opposite) {
    std::vector<bool> outer(loops.size());
    for (std::size_t i = 0; i < loops.size(); ++i) outer[i] = shapes[i].clear && shapes[i].area > 0;
    if (std::ranges::all_of(shapes, &LoopShape::clear)) return outer;

    DisjointSets components(opposite.size() / 3);
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge)
        if (opposite[half_edge] < half_edges::no_half_edge) components.unite(half_edge / 3, opposite[half_edge] / 3);
    std::unordered_map<u32, std::size_t> longest;  // longest loop by component; never iterated over
    for (std::size_t i = 0; i < loops.size(); ++i) {
        const auto [best, is_new] = longest.try_emplace(components.find(loops[i][0] / 3), i);
        if (shapes[i].length > longer_by * shapes[best->second].length) best->second = i;
    }
    for (std::size_t i = 0; i < loops.size(); ++i)
        if (!shapes[i].clear) outer[i] = longest.at(components.find(loops[i][0] / 3)) == i;
    return outer;
}

}  // namespace scanmill
