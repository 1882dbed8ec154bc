// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/model.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/topology.hpp"

namespace scanmill::updating {

std::string position_text(const Vec3& position, const Frame& frame) {
    const Vec3 world = frame.origin + position;
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", world.x(), world.y(), world.z());
}

namespace {

void require_no_boundary(const TriangleMesh& mesh, std::span<const u32> opposite) {
    const auto is_open = [](u32 other) { return other >= half_edges::no_half_edge; };
    const std::ptrdiff_t open = std::ranges::count_if(opposite, is_open);
    if (open == 0) return;
    const u32 first = static_cast<u32>(std::ranges::find_if(opposite, is_open) - opposite.begin());
    throw Error("the model is open: {}, the first at {}; only a closed model can be updated",
                count_text(static_cast<std::uint64_t>(open), "boundary edge", "boundary edges"),
                position_text(mesh.positions[half_edges::start(mesh, first)], mesh.frame))
        .hint("fill-holes or repair closes the model; tight-cocone makes a closed one from its points");
}

/// A vertex with several fans has more corners than one walk around it visits.
void require_single_fans(const TriangleMesh& mesh, std::span<const u32> opposite) {
    std::vector<bool> is_seen(opposite.size()), has_fan(mesh.positions.size());
    for (u32 corner = 0; corner < opposite.size(); ++corner) {
        if (is_seen[corner]) continue;
        const u32 vertex = half_edges::start(mesh, corner);
        if (has_fan[vertex])
            throw Error("the model is not a manifold: the triangles at vertex {} {} form several fans", vertex,
                        position_text(mesh.positions[vertex], mesh.frame))
                .hint("repair separates them");
        has_fan[vertex] = true;
        u32 h = corner;
        do {
            is_seen[h] = true;
            h = opposite[half_edges::before(h)];
        } while (h != corner);
    }
}

}  // namespace

Array<u32> closed_opposites(const TriangleMesh& mesh) {
    Array<u32> opposite = half_edges::opposites(mesh);
    require_no_boundary(mesh, opposite);
    require_single_fans(mesh, opposite);
    if (is_inside_out(mesh))
        throw Error("the model is inside out: its triangles face inwards").hint("repair turns them");
    return opposite;
}

namespace {

Array<Triangle> gathered(std::span<const Triangle> triangles, std::span<const u32> rows) {
    Array<Triangle> found;
    found.reserve(rows.size());
    for (const u32 row : rows) found.push_back(triangles[row]);
    return found;
}

}  // namespace

FacetTree::FacetTree(const TriangleMesh& mesh, Array<u32> facets, unsigned threads)
    : facets_(std::move(facets)),
      tree_(mesh.positions.span(), gathered(mesh.triangles.span(), facets_), threads) {}

void FacetTree::meeting(const BoundingBox& box, Array<u32>& rows) const {
    const std::size_t before = rows.size();
    tree_.meeting(box, rows);
    if (facets_.empty()) return;
    for (std::size_t i = before; i < rows.size(); ++i) rows[i] = facets_[rows[i]];
}

}  // namespace scanmill::updating
