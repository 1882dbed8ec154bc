// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The surface that cocone takes from its candidates, as facets of the tetrahedralisation.

#include "cocone/facets.hpp"
#include "cocone/sampling.hpp"
#include "scanmill/geometry/tets/canonical_cells.hpp"

namespace scanmill::cocones {

struct Surface {
    /// The facets of the surface. At every edge there are one or two.
    FacetSet facets;
    /// By cell, bit i: whether the facet opposite to corner i is in the surface and the cell is on its inner side.
    Array<u8> inner;
    std::size_t candidates = 0;  ///< number of facets before pruning
};

/// The facets as triangles, counter-clockwise seen from their outer side; ordered by owner cell, then by corner.
struct SurfaceMesh {
    SurfaceMesh(const TetMesh& tets, const Surface& surface);

    TriangleMesh mesh;  ///< with all vertices of the tetrahedralisation
    Array<u32> opposite;  ///< half_edges::opposites(mesh)
};

/// Steps 2 to 4 of cocone.hpp. Each component of the candidates is oriented so that its lowest point (by x, y, z) is
/// seen from outside, and the orientations of the facets agree across edges. Cost: linear, and a sort of the vertices
/// at which the first walk left candidates.
Surface surface_of(const Diagram& diagram, const Sampling& sampling, const CoconeParams& params, Context& context);

/// Throws Error for a tetrahedralisation that cannot be used, and for parameters out of range.
void require_usable(const TetMesh& tets, const CoconeParams& params);

/// Throws the Error of a filter that made no surface; `reason` ends its sentence.
[[noreturn]] void refuse_empty(const TetMesh& tets, const Sampling& sampling, const Surface& surface,
                               const std::string& reason, bool suggests_noise_mode = true);

/// The vertex columns `pole-normal`, `flat` and `boundary` after the given ones, by given vertex. Given columns of
/// these names are renamed, with a warning. Pole normals get the direction of `outward`, by given vertex, where
/// that is not zero.
ColumnTable with_sampling(const ColumnTable& given, const SpatialTets& spatial, const Diagram& diagram,
                          const Sampling& sampling, std::span<const Vec3> outward, Context& context);

}  // namespace scanmill::cocones
