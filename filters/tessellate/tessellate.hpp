// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Triangles on the zero set of a patch complex, after Bernardini et al. 1997, section 5: watertight, without
/// T-junctions, with the exact normals.

#include <optional>

#include "scanmill/base/execution.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/patches.hpp"
#include "scanmill/data/quantity.hpp"

namespace scanmill {

struct TessellateParams {
    /// Segments per edge of the mesh; with max_error the most.
    u32 subdivision = 8;
    /// Largest distance between the triangles and the surface, above 0; nothing: uniform.
    std::optional<Length> max_error;
};

/// A grid over every triangle of the mesh is lifted to the surface along lines to the apex on its side; the gap beside
/// an edge is spanned by fans of lines between the two apexes. The samples on an edge depend on the edge alone, so
/// neighbours fit.
///
/// Vertices: those of the mesh that are used, then edge by edge, then triangle by triangle. Columns: vertex `normal`
/// (unit, of the gradient); face `patch` (u32, the row of the mesh's triangle) and `side` (u8, 1 where the surface is
/// outside the mesh or on it).
///
/// With max_error edges get 1, 2, 4, … segments, until the surface in the middle of every segment is as near as that;
/// the distance is measured there, not bounded: on spheres and tori random points reached 1.06 max_error, beside
/// undivided triangles 3.1. Where the surface crosses an edge of the mesh, the distance falls with the segments,
/// elsewhere with their square: there a small max_error needs many triangles. Throws Error if `subdivision` does not
/// suffice, with the distance left; for patches without tetrahedra or with some missing, and for parameters out of
/// range. Cost: linear in the triangles made, about 1 us each.
TriangleMesh tessellate(const PatchComplex& patches, const TessellateParams& params, Execution& execution);

}  // namespace scanmill
