// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Sculpting: removes single cells of a solid until every point is on its boundary and the boundary is smoother.
///
/// The alpha-solid fills everything narrower than its ball: cells bridge concave edges and grooves, and the points
/// there are in the interior. Every step removes one cell so that the boundary stays a closed 2-manifold of the same
/// genus:
///
/// - An exposing step removes a cell with one facet on the boundary and the opposite corner in the interior. The corner
///   comes to the boundary.
/// - A smoothing step removes a cell with two facets on the boundary, which flips an edge of the boundary. The step
///   must decrease the bending, alone or in a chain of up to three such steps.
/// - An opening step flips an edge in the same way, whatever the bending, to reach a point that no exposing step can
///   reach.
///
/// Bending is the sum, over the edges of the boundary, of the angle between the normals of the two triangles there: 0
/// if they are coplanar. The paper maximises the sum of |π − γ|. That smooths only if γ is the angle between the
/// normals; the sum is then π times the number of edges, minus the bending.

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
    /// A smoothing step must decrease the bending by more than this; for `length`, by this times the length of the edge
    /// that it removes. A chain must decrease it by more than the sum for its steps.
    Angle min_gain = Angle::radians(1e-9);
    /// Whether the gain of an exposing step includes the best smoothing step that it makes possible.
    bool lookahead = true;
};

enum class SculptStep : u8 { exposing, smoothing, opening };

struct SculptRemoval {
    u32 cell;
    SculptStep step;
    /// Bending before minus bending after, in radians; for `length` times lengths in the scan's unit.
    double gain;
    /// Whether the next removal belongs to the same chain. The gains of a chain count together.
    bool chained = false;
};

struct SculptResult {
    /// The boundary with its own vertices only (in input order, with their columns), outward, closed.
    TriangleMesh mesh;
    /// The input, with the removed cells labelled outside.
    TetMesh tets;
    /// The removals in order.
    Array<SculptRemoval> removals;
    std::size_t exposing = 0, smoothing = 0, opening = 0;
    double volume_removed = 0;
    /// Unweighted bending of the boundary, in radians.
    double bending_before = 0, bending_after = 0;
    /// Indices, ascending, of points that stay in the interior. Blocked: next to the cells at the point there is a cell
    /// on the boundary, but without it the boundary would touch itself or a point would be outside. Deep: no cell next
    /// to the cells at the point is on the boundary.
    Array<u32> blocked_points, deep_points;
    /// Vertices in no cell of the solid, as in the input.
    std::size_t outside_points = 0;
    double noise = 0;  ///< noise of the boundary, by vertex_noise()
};

/// Sculpts the labelled cells.
///
/// Pre:  cells of delaunay(), labelled, at least one inside. The boundary is a 2-manifold (the triangles of every
///       vertex form one closed fan) of any number of components. Throws Error with numbers otherwise. Vertices that no
///       cell uses are allowed.
/// Post: no cell is added. The boundary is a 2-manifold with the components and the genus of the input's, and with two
///       triangles more per exposing step. Smoothing steps and chains are taken only within two cells of an exposing
///       step or at an edge with a bending above 45° (for a chain: at one of its cells). No such step with enough gain
///       is left there. Chains have up to three steps. Each except the first is at a triangle that an earlier one
///       uncovered. No smoothing step makes a triangle with an angle below 0.1°. No flip, smoothing or opening, makes a
///       triangle whose circumradius is larger than all were before. Exposing steps that do so come last. Points still
///       in the interior have a reason, see SculptResult.
/// Ties: among exposing steps of equal gain, the one at the larger boundary triangle (by circumradius) comes first.
///       Then the cell with the lower corners (by x, y, z) comes first; among chains, the first cell that differs
///       decides. Gains are computed from corners sorted by position. So the solid depends neither on the order of the
///       points nor on the number of threads, nor on the processor.
/// Cost: linear in the cells to find the boundary; O(r log r) for r removals. About 12 bytes per cell and 40 per
///       boundary triangle in addition to the result.
/// Metrics: see plugin.cpp. Warns about points that stay in the interior. Doubts the result if more than half of the
/// cells are removed, and passes on doubts_about_surface() and doubts_about_handles().
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 3; Boissonnat 1984 for the admissible steps.
SculptResult sculpt(const TetMesh& tets, const SculptParams& params, Context& context);

}  // namespace scanmill
