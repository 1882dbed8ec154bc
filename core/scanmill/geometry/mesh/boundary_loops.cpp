// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/boundary_loops.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <unordered_map>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"

namespace scanmill {

namespace {

constexpr double least_mean_normal = 0.1, least_area = 1e-3;
/// Two equal rims are passed in opposite directions, so their lengths are rounded differently.
constexpr double longer_by = 1 + 1e-9;

/// The boundary side that leaves the vertex where this one arrives, in the same fan of triangles.
u32 next_along_boundary(u32 side, std::span<const u32> twins) {
    u32 next = sides::after(side);
    while (twins[next] != sides::boundary) next = sides::after(twins[next]);
    return next;
}

}  // namespace

std::vector<Array<u32>> boundary_loops(const TriangleMesh& mesh, std::span<const u32> twins) {
    std::vector<Array<u32>> loops;
    std::vector<bool> seen(twins.size(), false);
    for (u32 first = 0; first < 3 * mesh.triangles.size(); ++first) {
        if (twins[first] != sides::boundary || seen[first]) continue;
        Array<u32>& loop = loops.emplace_back();
        for (u32 side = first; !seen[side]; side = next_along_boundary(side, twins)) {
            seen[side] = true;
            loop.push_back(side);
        }
    }
    return loops;
}

LoopShape loop_shape(const TriangleMesh& mesh, std::span<const u32> loop, std::span<const Vec3> normals) {
    LoopShape shape;
    Vec3 twice_area = Vec3::Zero(), weighted_normals = Vec3::Zero();
    const Vec3& origin = mesh.positions[sides::start(mesh, loop[0])];
    for (const u32 side : loop) {
        const Vec3& from = mesh.positions[sides::start(mesh, side)];
        const Vec3& to = mesh.positions[sides::end(mesh, side)];
        const double length = (to - from).norm();
        shape.length += length;
        weighted_normals += length * normals[side / 3];
        twice_area += (from - origin).cross(to - origin);
    }
    const double coherent = weighted_normals.norm();
    if (coherent > 0) shape.area = twice_area.dot(weighted_normals / coherent) / 2;
    shape.clear = coherent > 0 && coherent >= least_mean_normal * shape.length &&
                  std::abs(shape.area) >= least_area * shape.length * shape.length;
    return shape;
}

std::vector<bool> outer_loops(std::span<const std::span<const u32>> loops, std::span<const LoopShape> shapes,
                              std::span<const u32> twins) {
    std::vector<bool> outer(loops.size());
    for (std::size_t i = 0; i < loops.size(); ++i) outer[i] = shapes[i].clear && shapes[i].area > 0;
    if (std::ranges::all_of(shapes, &LoopShape::clear)) return outer;

    DisjointSets pieces(twins.size() / 3);
    for (u32 side = 0; side < twins.size(); ++side)
        if (twins[side] < sides::no_side) pieces.unite(side / 3, twins[side] / 3);
    std::unordered_map<u32, std::size_t> longest;  // loop of every piece; looked up only
    for (std::size_t i = 0; i < loops.size(); ++i) {
        const auto [best, is_new] = longest.try_emplace(pieces.find(loops[i][0] / 3), i);
        if (shapes[i].length > longer_by * shapes[best->second].length) best->second = i;
    }
    for (std::size_t i = 0; i < loops.size(); ++i)
        if (!shapes[i].clear) outer[i] = longest.at(pieces.find(loops[i][0] / 3)) == i;
    return outer;
}

}  // namespace scanmill
