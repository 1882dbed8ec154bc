// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Cocone: the triangles of a Delaunay tetrahedralisation that lie along the scanned surface, as a manifold that stays
/// open where the scan is.
///
/// Terms (pole, cocone, cocone neighbour) are those of geometry/tets/voronoi.hpp.
///
/// 1. A point is *flat* if the surface is well sampled there. In its tangent plane, its Voronoi cell must not reach
///    farther than 1 / `ratio` of the distance to the nearer pole, and the pole directions of its cocone neighbours
///    must differ from its own by at most `normal_angle`. A point that passes the first test only is flat, too, if it
///    has a flat cocone neighbour whose direction agrees. All other points are boundary points. So are points whose 16
///    nearest neighbours, seen in the tangent plane, leave a gap wider than `gap_angle`: the test with poles alone
///    finds a third of a gently curved rim.
/// 2. A triangle is a candidate if its dual Voronoi edge meets the cocones of all its flat corners, or of all corners
///    if none is flat. Triangles between boundary points alone with an edge longer than `lid_factor` local spacings
///    span an opening and are not candidates. The local spacing is the mean distance to the six nearest neighbours.
/// 3. A point owns an umbrella if candidates at it form a closed fan. Candidates at it outside of such fans are
/// removed.
/// 4. A walk from triangle to triangle takes, at each edge, the first candidate seen from outside, and drops the
///    others. It crosses edges with one choice first, and stops at edges with several if no end owns an umbrella.
///    Triangles at edges that stay unclear are removed. Components without an umbrella are left out, and those with few
///    flat points, which outliers make among themselves, unless most points are in such components.
/// 5. The solid behind the surface (see peeling.hpp) decides its outer side. Gaps are closed where the solid closes
///    them by facets of which none spans an opening.
///
/// Source: Amenta, Choi, Dey, Leekha 2000; Dey, Giesen 2001 for the boundary points; Woo, Dey 2005, section 2. The
/// tests for gaps and for spanning triangles, the vote where no corner is flat, the removal in step 3, the order of the
/// walk, the rule for outliers and step 5 are our own, and so are the ranges of the parameters.

#include "scanmill/data/features.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct CoconeParams {
    /// The cocone's half-opening about the tangent plane; 5 to 40 degrees.
    Angle cone_angle = Angle::degrees(22.5);
    /// The largest angle between the normals of two triangles that continue each other; 90 to 170 degrees.
    Angle prune_angle = Angle::degrees(120);
    /// 10 to 90 degrees.
    Angle normal_angle = Angle::degrees(60);
    /// At least 1.
    double ratio = 1.2;
    /// 60 to 180 degrees.
    Angle gap_angle = Angle::degrees(100);
    /// Above 0, in local spacings.
    double lid_factor = 2.5;
};

struct CoconeResult {
    /// The surface. Each edge has one or two triangles, and their orientations agree; a vertex may have several fans.
    /// Its vertices are those of its triangles, in input order, with their columns and three more: `pole-normal` (3 ×
    /// float64, outwards), `flat` and `boundary` (uint8).
    TriangleMesh mesh;
    /// The boundary loops of the mesh.
    FeatureGraph features;
    /// Points of the input in no triangle.
    std::size_t unused = 0;
    std::size_t boundary_points = 0;
    /// Points that are flat by the test with poles.
    std::size_t pole_flat = 0;
    std::size_t loops = 0;
};

/// Pre:  a tetrahedralisation made by delaunay() without weights; parameters in their ranges. Throws Error otherwise,
///       and if no triangle is found.
/// Post: see CoconeResult. Closed components face outwards, and cavities inwards. An open component faces away from the
///       solid behind it. The bytes do not depend on the number of threads. The
///       surface does not depend on the order of the points, unless several lie within a 2^-21 of the cloud's extent.
/// Ties: a direction exactly on a limit of a cocone is inside.
/// Cost: linear in the cells, and a search for 16 neighbours of each point; about 120 bytes per cell.
/// Metrics: see plugin.cpp. Warns of unused points. Doubts the result if they are more than 2 %, or if it has more
/// than three short loops and more than one per 1,000 vertices; a loop is short below 12 median edges.
CoconeResult cocone(const TetMesh& tets, const CoconeParams& params, Context& context);

}  // namespace scanmill
