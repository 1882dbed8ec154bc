// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/sharp_edges.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

std::vector<bool> declared_sharp_half_edges(const TriangleMesh& mesh, std::span<const u32> opposite) {
    std::vector<bool> sharp(opposite.size(), false);
    if (mesh.sharp_edges.empty()) return sharp;
    struct Declared {
        Edge edge;
        bool found;
    };
    std::vector<Declared> declared;
    for (const Edge& edge : mesh.sharp_edges) declared.push_back({make_edge(edge[0], edge[1]), false});
    std::ranges::sort(declared, {}, &Declared::edge);
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
        if (opposite[half_edge] == half_edges::no_half_edge) continue;
        const Edge edge = make_edge(half_edges::start(mesh, half_edge), half_edges::end(mesh, half_edge));
        for (Declared& same : std::ranges::equal_range(declared, edge, {}, &Declared::edge)) {
            same.found = true;
            sharp[half_edge] = opposite[half_edge] != half_edges::boundary;
        }
    }
    const auto missing = std::ranges::count(declared, false, &Declared::found);
    if (missing == 0) return sharp;
    const Edge& first = std::ranges::find(declared, false, &Declared::found)->edge;
    throw Error("{} of the mesh's {} {} of no triangle; the first is between vertices {} and {}", missing,
                count_text(declared.size(), "sharp edge", "sharp edges"),
                by_count(static_cast<std::size_t>(missing), "is an edge", "are edges"), first[0], first[1])
        .hint("write the mesh again without sharp edges, or only with sharp edges that are edges of its triangles");
}

std::vector<bool> sharp_half_edges(const TriangleMesh& mesh, std::span<const u32> opposite,
                                   std::span<const Vec3> normals, double sharp_angle, unsigned threads) {
    std::vector<bool> sharp = declared_sharp_half_edges(mesh, opposite);
    Array<u8> is_sharp(opposite.size());  // bytes, unlike std::vector<bool>, can be written in parallel
    constexpr std::size_t chunk = 3 << 13;
    for_each_chunk(threads, opposite.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t half_edge = begin; half_edge < end; ++half_edge) {
            const u32 other = opposite[half_edge];
            is_sharp[half_edge] = other < half_edges::no_half_edge &&
                                  angle_between(normals[half_edge / 3], normals[other / 3]) > sharp_angle;
        }
    });
    for (std::size_t half_edge = 0; half_edge < sharp.size(); ++half_edge)
        if (is_sharp[half_edge]) sharp[half_edge] = true;
    return sharp;
}

}  // namespace scanmill
