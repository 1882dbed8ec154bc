// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Sculpting: taking single cells off a solid until every point lies on its boundary and the boundary bends less.
///
/// The alpha-solid fills what is narrower than its ball: concave edges and grooves are bridged by cells, and points
/// there lie inside. Every step removes one cell so that the boundary stays a closed 2-manifold of the same genus:
///
/// - exposing: a cell with one facet on the boundary whose opposite corner lies inside; the corner comes up;
/// - smoothing: a cell with two facets on the boundary, when it lessens the bending, alone or in a chain of up to three
///   such cells; an edge of the surface is flipped;
/// - opening: the same whatever the bending, to get at a point that no exposing cell is left for.
///
/// Bending is the sum, over the edges of the boundary, of the angle between the normals of the two triangles there: 0
/// where they are coplanar. The paper asks for the largest sum of |π − γ|, which is this when γ is the angle between
/// the normals.

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

enum class SculptWeight {
    none,  ///< the paper: every edge counts its angle
    length  ///< an edge counts its angle times its length
};

struct SculptParams {
    SculptWeight weight = SculptWeight::none;
    /// A smoothing step must lessen the bending by more than this; for `length`, this times the edge it takes away. A
    /// chain must by more than its steps must together.
    Angle min_gain = Angle::radians(1e-9);
    /// Whether an exposing step is judged together with the best smoothing step that it makes possible.
    bool lookahead = true;
};

enum class SculptStep : u8 { exposing, smoothing, opening };

struct SculptRemoval {
    u32 cell;
    SculptStep step;
    /// Bending before less bending after, in radians; for `length` times lengths in the scan's unit.
    double gain;
    /// The next removal belongs to the same chain: the gains of a chain count together.
    bool chained = false;
};

struct SculptResult {
    /// The boundary over only its own vertices (in input order, columns carried), outward, closed.
    TriangleMesh mesh;
    /// The input with the removed cells outside.
    TetMesh tets;
    /// What was done, in order.
    Array<SculptRemoval> removals;
    std::size_t exposing = 0, smoothing = 0, opening = 0;
    double volume_removed = 0;
    /// Unweighted, in radians.
    double bending_before = 0, bending_after = 0;
    /// Vertex indices, ascending, of points that stay inside the solid. Blocked: a cell that bounds the solid lies over
    /// the cells round the point, but removing it would make the boundary touch itself or leave a point outside. Deep:
    /// all cells over them are inside themselves.
    Array<u32> blocked_points, deep_points;
    /// Vertices in no cell of the solid, as in the input.
    std::size_t outside_points = 0;
};

/// Sculpts the labelled cells.
///
/// Pre:  cells of delaunay(), labelled, at least one inside; the boundary a 2-manifold (every vertex's triangles form
///       one closed fan), of any number of pieces. Throws Error with numbers otherwise. Vertices that no cell uses are
///       allowed.
/// Post: no cell was added; the boundary is a 2-manifold with the components and the genus of the input's, and
///       2 (exposing) more triangles. No smoothing step with enough gain is left within two cells of an exposing step,
///       or at an edge that bends by more than 45°; nor a chain of up to three such steps of which one is there, each
///       but the first at a triangle that an earlier one bared. None was made elsewhere, and none makes a triangle with
///       an angle below 0.1°. No flip, smoothing or opening, makes a triangle whose circumradius is larger than all
///       were before, and exposing steps that do come last. Points still inside have a reason, see SculptResult.
/// Ties: of equal gains that of the larger boundary triangle (by circumradius) for exposing steps, then the cell whose
///       corners are lower by x, y, z; for chains the first cell that differs. Gains are computed from corners sorted
///       by place, so the solid depends neither on the order of the points nor on the number of threads.
/// Cost: linear in the cells to find what bounds the solid; O(r log r) for r removals. About 12 bytes per cell and 40
///       per boundary triangle beside the result.
/// Metrics: see plugin.cpp. Warns about points that stay inside, and when so much was removed that the sampling cannot
/// have been dense enough.
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 3; Boissonnat 1984 for the admissible steps.
SculptResult sculpt(const TetMesh& tets, const SculptParams& params, Context& context);

}  // namespace scanmill
