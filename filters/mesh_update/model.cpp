// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/model.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/topology.hpp"

namespace scanmill::updating {

namespace {

Array<u32> closed_opposites(const TriangleMesh& mesh) {
    Array<u32> opposite = half_edges::opposites(mesh);
    const auto is_open = [](u32 other) { return other >= half_edges::no_half_edge; };
    const std::ptrdiff_t open = std::ranges::count_if(opposite, is_open);
    if (open == 0) return opposite;
    const u32 first = static_cast<u32>(std::ranges::find_if(opposite, is_open) - opposite.begin());
    throw Error("the model is open: {}, the first at {}; only a closed model can be updated",
                count_text(static_cast<std::uint64_t>(open), "boundary edge", "boundary edges"),
                position_text(mesh.positions[half_edges::start(mesh, first)], mesh.frame))
        .hint("fill-holes or repair closes the model; tight-cocone makes a closed one from its points");
}

}  // namespace

std::string position_text(const Vec3& position, const Frame& frame) {
    const Vec3 world = frame.origin + position;
    return fmt::format("({:.6g}, {:.6g}, {:.6g})", world.x(), world.y(), world.z());
}

Model::Model(const TriangleMesh& given, Context& context)
    : mesh(given),
      opposite(closed_opposites(given)),
      tree(given.positions.span(), given.triangles.span(), context.threads()) {
    context.check_cancelled();
    // A vertex with several fans has more corners than one walk around it visits.
    std::vector<bool> is_seen(opposite.size()), has_fan(mesh.positions.size());
    for (u32 corner = 0; corner < opposite.size(); ++corner) {
        if (is_seen[corner]) continue;
        const u32 vertex = start(corner);
        if (has_fan[vertex])
            throw Error("the model is not a manifold: the triangles at vertex {} {} form several fans", vertex,
                        position_text(mesh.positions[vertex], mesh.frame))
                .hint("repair separates them");
        has_fan[vertex] = true;
        for_each_around(corner, [&](u32 h) { is_seen[h] = true; });
    }
    if (is_inside_out(mesh))
        throw Error("the model is inside out: its triangles face inwards").hint("repair turns them");
}

}  // namespace scanmill::updating
