// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/structure.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"

namespace scanmill::tessellation {

namespace {

constexpr double equal_gradients = 1e-6;

struct HalfEdge {
    Edge edge;
    u32 triangle, corner;
    auto operator<=>(const HalfEdge&) const = default;
};

[[noreturn]] void throw_incomplete(u32 triangle) {
    throw Error("the patches are not complete: tetrahedra of triangle {} are missing or too many", triangle)
        .hint("'a-patch' makes complete ones");
}

std::vector<TriangleTets> triangles_of(const PatchComplex& patches) {
    const std::size_t rows = patches.tets.size();
    u32 count = 0;
    for (const u32 triangle : patches.triangles) {
        if (triangle >= rows) throw_incomplete(triangle);
        count = std::max(count, triangle + 1);
    }
    std::vector<TriangleTets> triangles(count);
    for (u32 row = 0; row < rows; ++row) {
        if (patches.kinds[row] != PatchKind::face) continue;
        auto& of_side = triangles[patches.triangles[row]].rows[patches.sides[row]];
        const auto free = std::ranges::find(of_side, none);
        if (free == of_side.end()) throw_incomplete(patches.triangles[row]);
        *free = row;
    }
    for (u32 f = 0; f < triangles.size(); ++f) {
        TriangleTets& t = triangles[f];
        t.count = t.rows[1][1] == none ? 1 : 3;
        for (const auto& of_side : t.rows)
            if (std::ranges::count(of_side, none) != 3 - t.count) throw_incomplete(f);
        // Only thirds of a triangle may have a second function, not a whole triangle.
        if (t.count == 1)
            for (const auto& of_side : t.rows)
                if (patches.partners[of_side[0]] != PatchComplex::no_partner) throw_incomplete(f);
        for (std::size_t i = 0; i < 3; ++i)
            t.corners[i] = t.count == 3 ? patches.tets[t.rows[1][i]][1] : patches.tets[t.rows[1][0]][i];
    }
    return triangles;
}

/// Returns the edges of the triangles. Also sets TriangleTets::edges.
std::vector<EdgeTets> edges_of(std::vector<TriangleTets>& triangles) {
    std::vector<HalfEdge> halves;
    for (u32 f = 0; f < triangles.size(); ++f)
        for (u32 i = 0; i < 3; ++i)
            halves.push_back({make_edge(triangles[f].corners[i], triangles[f].corners[(i + 1) % 3]), f, i});
    std::ranges::sort(halves);
    std::vector<EdgeTets> edges;
    for (std::size_t h = 0; h < halves.size(); ++h) {
        const bool is_second = h > 0 && halves[h - 1].edge == halves[h].edge;
        if (h > 1 && halves[h - 2].edge == halves[h].edge) throw_incomplete(halves[h].triangle);
        if (!is_second) edges.emplace_back();
        EdgeTets& edge = edges.back();
        TriangleTets& triangle = triangles[halves[h].triangle];
        edge.triangles[is_second] = halves[h].triangle;
        edge.numbers[is_second] = halves[h].corner;
        triangle.edges[halves[h].corner] = static_cast<u32>(edges.size() - 1);
        if (is_second) continue;
        edge.a = triangle.corners[halves[h].corner];
        edge.b = triangle.corners[(halves[h].corner + 1) % 3];
    }
    return edges;
}

/// Whether the two triangles' functions have different gradients at an end of the edge.
bool gradients_differ(const PatchComplex& patches, const PatchStructure& structure, const EdgeTets& edge) {
    const auto gradient = [&](std::size_t of, u32 vertex) {
        const TriangleTets& t = structure.triangles[edge.triangles[of]];
        return PatchCell(patches, t.rows[1][t.count == 3 ? edge.numbers[of] : 0]).gradient(patches.positions[vertex]);
    };
    return std::ranges::any_of(std::array{edge.a, edge.b}, [&](u32 v) {
        const Vec3 one = gradient(0, v), other = gradient(1, v);
        return (one - other).norm() > equal_gradients * std::max(one.norm(), other.norm());
    });
}

}  // namespace

PatchStructure structure_of(const PatchComplex& patches) {
    if (patches.tets.empty()) throw Error("the patches have no tetrahedra").hint("'a-patch' makes patches of a mesh");
    PatchStructure structure;
    structure.triangles = triangles_of(patches);
    structure.edges = edges_of(structure.triangles);
    for (u32 row = 0; row < patches.tets.size(); ++row) {
        if (patches.kinds[row] != PatchKind::edge && patches.kinds[row] != PatchKind::sharp) continue;
        const u32 f = patches.triangles[row];
        const TriangleTets& t = structure.triangles[f];
        const auto i = static_cast<std::size_t>(std::ranges::find(t.corners, patches.tets[row][1]) - t.corners.begin());
        if (i == t.corners.size()) throw_incomplete(f);
        EdgeTets& edge = structure.edges[t.edges[i]];
        u32& of = edge.rows[patches.sides[row]][edge.triangles[1] == f];
        if (of != none || edge.is_border()) throw_incomplete(f);
        of = row;
        edge.is_sharp = patches.kinds[row] == PatchKind::sharp;
        edge.combine = patches.combine[row];
    }
    for (EdgeTets& edge : structure.edges) {
        if (edge.is_border()) continue;
        std::size_t sharp = 0, smooth = 0, sides = 0;
        for (const auto& of_side : edge.rows) {
            for (const u32 row : of_side)
                if (row != none) ++(patches.kinds[row] == PatchKind::sharp ? sharp : smooth);
            sides += of_side[0] != none && of_side[1] != none;
        }
        if ((smooth > 0 && sharp > 0) || smooth + sharp != 2 * sides) throw_incomplete(edge.triangles[0]);
        edge.is_sharp = sharp > 0 || (smooth == 0 && gradients_differ(patches, structure, edge));
    }
    return structure;
}

}  // namespace scanmill::tessellation
