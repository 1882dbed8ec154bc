// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The candidate triangles of cocone, and the removal of those that dangle.

#include "cocone/facets.hpp"
#include "cocone/sampling.hpp"

namespace scanmill::cocones {

/// Whether a facet spans an opening: all its corners are boundary points, and an edge is longer than lid_factor local
/// spacings, of the corner where that is largest.
bool spans_opening(const TetMesh& tets, const Sampling& sampling, double lid_factor, const Triangle& corners);

/// The facets that the flat corners vote for, without those that span an opening: step 2 of cocone.hpp.
FacetSet candidates(const Diagram& diagram, const Sampling& sampling, double lid_factor, Context& context);

/// Removes dangling facets until there is none. A vertex owns an umbrella if some facets at it are such that each is
/// continued by another one at both its edges, as in a closed fan: the cosine between their normals, oriented across
/// their common edge, is at least that of prune_angle. A facet dangles if a corner of it owns an umbrella, and the
/// facet is not among them. In each round, all facets that dangle are removed, so the result does not depend on the
/// order. Returns whether each vertex owns an umbrella.
Array<u8> prune(const Diagram& diagram, FacetSet& set, double prune_angle, Context& context);

}  // namespace scanmill::cocones
