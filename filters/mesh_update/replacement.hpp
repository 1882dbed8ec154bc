// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The vertices of the model that clouds replace.
///
/// The paper discards the vertices of the replaced groups and keeps those of overlap facets. Where the model's facets
/// are large, some of those lie under the cloud; they are discarded, too, and so are vertices right beside a point of
/// the cloud: two layers of points less than a third of a spacing apart have no surface.
///
/// Source: Woo, Dey 2005, section 3.4.

#include "mesh_update/groups.hpp"
#include "scanmill/data/point_tree.hpp"

namespace scanmill::updating {

/// By vertex, 1 for those of replaced groups. Vertices of overlap facets belong to no group. `replaced`: by group.
Array<u8> vertices_of_groups(const Model& model, const Groups& groups, const std::vector<bool>& replaced);

/// Marks further vertices by 1: those of the cloud's overlap facets whose nearest point on the cloud's surface is
/// farther than half a spacing from its loops; and of the others at the overlap facets and next to a marked vertex,
/// those nearer to a point of the cloud than `trim` times the local spacing there, the mean distance of the point to
/// its six nearest ones.
///
/// `before`: the marks of vertices_of_groups(). Pre: `overlap` are the cloud's overlap facets. Cost: one search in the
/// cloud for each vertex of the overlap facets.
void discard_under(const Model& model, std::span<const u32> overlap, const CloudSurface& surface,
                   const PointTree& cloud, double trim, std::span<const u8> before, std::span<u8> discarded,
                   Context& context);

}  // namespace scanmill::updating
