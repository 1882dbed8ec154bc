// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The closed surface of an update, made anew as a whole or around the change only.

#include <vector>

#include "mesh_update/groups.hpp"
#include "tight_cocone/tight_cocone.hpp"

namespace scanmill::updating {

/// A closed mesh whose vertices are rows of a list of points: the model's vertices, then the points of the clouds.
struct Rebuilt {
    Array<u32> rows;  ///< by vertex, ascending
    Array<Triangle> triangles;  ///< corners are vertices
    std::size_t fixed = 0;  ///< the first triangles that are facets of the model
    Array<u32> replaced;  ///< facets of the model that are not among the first `fixed` triangles, ascending
    std::vector<std::string> warnings;
};

/// tight_cocone() of the points at these rows, with its warnings. Where it only joins vertices of the model in another
/// way, the facets of the model stay; see exchanged(). If the two surfaces have no seam, tight cocone's is the result.
/// Its doubts are left out, because they expect an even sampling of the whole surface. Reports progress from 0.4 to
/// 0.85. Throws Error as delaunay() and tight_cocone() do.
Rebuilt rebuild_whole(const Model& model, std::span<const Vec3> positions, std::span<const u32> rows,
                      std::span<const u32> discarded, const Groups& groups, const TightCoconeParams& params,
                      Context& context);

/// What one cloud, or several that count as one, replace.
struct CloudPart {
    std::span<const LoopOverlap> loops;
    std::span<const u32> points;  ///< rows of its points among those of all clouds
    double spacing;
};

/// rebuild_locally() around all clouds. `rows`: kept vertices and points that may be used, ascending; `discarded`:
/// vertices of the model, ascending. Facets that go and are connected belong to one change, and so do all that a cloud
/// replaces. Throws Error as rebuild_locally() does.
Rebuilt rebuild_around(const Model& model, std::span<const Vec3> positions, std::span<const u32> rows,
                       std::span<const u32> discarded, const Groups& groups, std::span<const CloudPart> clouds,
                       const CoconeParams& params, Context& context);

}  // namespace scanmill::updating
