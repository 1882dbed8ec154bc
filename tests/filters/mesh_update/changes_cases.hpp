// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Solids whose differences are known exactly, and their changed triangles.

#include <algorithm>
#include <array>
#include <map>
#include <set>
#include <tuple>
#include <vector>

#include "mesh_update/changes.hpp"
#include "support/mesh_operations.hpp"

namespace scanmill::test {

/// Compares positions exactly.
struct ByCoordinates {
    bool operator()(const Vec3& a, const Vec3& b) const {
        return std::tuple(a.x(), a.y(), a.z()) < std::tuple(b.x(), b.y(), b.z());
    }
};

/// What differs between two meshes; triangles are equal if they have the same positions in the same direction.
struct Difference {
    TriangleMesh before, after;
    std::vector<Triangle> old_triangles, new_triangles;
    std::vector<u32> common;

    Difference(TriangleMesh old_mesh, TriangleMesh new_mesh) : before(std::move(old_mesh)), after(std::move(new_mesh)) {
        std::map<Vec3, u32, ByCoordinates> old_vertices;
        for (u32 vertex = 0; vertex < before.positions.size(); ++vertex)
            old_vertices.try_emplace(before.positions[vertex], vertex);
        for (const Vec3& position : after.positions) {
            const auto found = old_vertices.find(position);
            common.push_back(found == old_vertices.end() ? updating::no_common_vertex : found->second);
        }
        using Key = std::array<u32, 3>;
        const auto key = [](Triangle t) -> Key {
            std::ranges::rotate(t, std::ranges::min_element(t));
            return t;
        };
        std::set<Key> old_keys, new_keys;
        for (const Triangle& t : before.triangles) old_keys.insert(key(t));
        for (const Triangle& t : after.triangles) {
            const Triangle as_old{common[t[0]], common[t[1]], common[t[2]]};
            const bool is_common = std::ranges::find(as_old, updating::no_common_vertex) == as_old.end();
            if (is_common) new_keys.insert(key(as_old));
            if (!is_common || !old_keys.contains(key(as_old))) new_triangles.push_back(t);
        }
        for (const Triangle& t : before.triangles)
            if (!new_keys.contains(key(t))) old_triangles.push_back(t);
    }

    std::vector<updating::Change> changes(Context& context) const {
        return updating::changes({before.positions.span(), old_triangles}, {after.positions.span(), new_triangles},
                                 common, context);
    }
    std::vector<updating::Change> changes() const {
        Context context;
        return changes(context);
    }
};

/// A set of unit cubes, given by their lowest corners.
using Cubes = std::set<std::array<int, 3>>;

inline Cubes block(std::array<int, 3> low, std::array<int, 3> high) {
    Cubes cubes;
    for (int x = low[0]; x < high[0]; ++x)
        for (int y = low[1]; y < high[1]; ++y)
            for (int z = low[2]; z < high[2]; ++z) cubes.insert({x, y, z});
    return cubes;
}
inline Cubes with(Cubes cubes, const Cubes& more) {
    cubes.insert(more.begin(), more.end());
    return cubes;
}
inline Cubes without(Cubes cubes, const Cubes& less) {
    for (const auto& cube : less) cubes.erase(cube);
    return cubes;
}

/// The surface of the cubes, in squares of two triangles, facing out. A vertex for each corner.
inline TriangleMesh surface_of(const Cubes& cubes) {
    std::map<std::array<int, 3>, u32> vertices;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    const auto vertex = [&](const std::array<int, 3>& corner) {
        const auto [found, is_new] = vertices.try_emplace(corner, static_cast<u32>(positions.size()));
        if (is_new) positions.emplace_back(corner[0], corner[1], corner[2]);
        return found->second;
    };
    for (const auto& cube : cubes)
        for (std::size_t axis = 0; axis < 3; ++axis)
            for (const int side : {0, 1}) {
                std::array<int, 3> neighbour = cube;
                neighbour[axis] += side ? 1 : -1;
                if (cubes.contains(neighbour)) continue;
                const auto corner = [&](int u, int v) {
                    std::array<int, 3> result = cube;
                    result[axis] += side;
                    result[(axis + 1) % 3] += u;
                    result[(axis + 2) % 3] += v;
                    return vertex(result);
                };
                const u32 a = corner(0, 0), b = side ? corner(1, 0) : corner(0, 1), c = corner(1, 1),
                          d = side ? corner(0, 1) : corner(1, 0);
                triangles.push_back({a, b, c});
                triangles.push_back({a, c, d});
            }
    return soup(std::move(positions), std::move(triangles));
}

/// The solid between z = -1 and z = height(x, y) over [-1, 1]², in cells × cells squares.
/// Pre: the height is above -1.
template <class Height>
TriangleMesh relief(u32 cells, Height&& height) {
    const u32 side = cells + 1;
    Array<Vec3> positions;
    Array<Triangle> triangles;
    for (const bool top : {false, true})
        for (u32 j = 0; j < side; ++j)
            for (u32 i = 0; i < side; ++i) {
                const double x = -1 + 2.0 * i / cells, y = -1 + 2.0 * j / cells;
                positions.emplace_back(x, y, top ? height(x, y) : -1.0);
            }
    const auto at = [&](u32 i, u32 j, bool top) { return (top ? side * side : 0) + j * side + i; };
    const auto square = [&](u32 a, u32 b, u32 c, u32 d) {
        triangles.push_back({a, b, c});
        triangles.push_back({a, c, d});
    };
    for (u32 j = 0; j < cells; ++j)
        for (u32 i = 0; i < cells; ++i) {
            square(at(i, j, true), at(i + 1, j, true), at(i + 1, j + 1, true), at(i, j + 1, true));
            square(at(i, j, false), at(i, j + 1, false), at(i + 1, j + 1, false), at(i + 1, j, false));
        }
    for (u32 i = 0; i < cells; ++i) {
        square(at(i, 0, false), at(i + 1, 0, false), at(i + 1, 0, true), at(i, 0, true));
        square(at(cells, i, false), at(cells, i + 1, false), at(cells, i + 1, true), at(cells, i, true));
        square(at(i + 1, cells, false), at(i, cells, false), at(i, cells, true), at(i + 1, cells, true));
        square(at(0, i + 1, false), at(0, i, false), at(0, i, true), at(0, i + 1, true));
    }
    return soup(std::move(positions), std::move(triangles));
}

}  // namespace scanmill::test
