// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The alpha-solid: the part of a Delaunay tetrahedralisation that a ball of radius alpha cannot enter from outside,
/// with alpha chosen automatically.
///
/// A facet is a wall at alpha when it belongs to the alpha-shape: when its smallest circumscribed sphere, or, if that
/// contains an opposite vertex, the smaller of its cells' spheres, has a radius of at most alpha. The solid is every
/// cell that cannot be reached from outside without crossing a wall; what walls enclose is solid, so it has no
/// cavities. Growing alpha grows the solid.
///
/// A solid is valid when the requested share of the points is in or on it, its boundary is a closed 2-manifold (every
/// vertex's triangles form exactly one closed fan) and, for `single`, it is connected. From alpha_cover on, all larger
/// alphas have the first property, but may lose the second. So the scan starts at alpha_cover and adds the cells of one
/// value after the other, testing only the vertices that they touch, until the first valid solid.
///
/// Source: Bernardini, Bajaj, Chen, Schikore 1997, section 3; Edelsbrunner, Mücke 1994 for alpha-shapes.

#include <optional>

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

enum class AlphaSearch {
    scan,  ///< the least alpha with a valid solid
    binary  ///< the paper's bisection: a valid solid, not always the least
};

enum class AlphaComponents {
    single,  ///< one solid: alpha grows until all are joined; with coverage below 100 %, solids other than the one with
             ///< the most points are left out
    many  ///< any number of solids
};

struct AlphaSolidParams {
    /// The radius; absent: the least that gives a valid solid.
    std::optional<Length> alpha;
    AlphaSearch search = AlphaSearch::scan;
    AlphaComponents components = AlphaComponents::single;
    /// The share of the points that must be in or on the solid, in (0, 1].
    Ratio coverage = Ratio::percent(100);
};

/// How alpha and the solid were found.
enum class AlphaChoice {
    scan,  ///< a plain alpha-solid, the first valid one
    binary,  ///< a plain alpha-solid found by bisection
    repaired,  ///< cells were added round the non-manifold vertices of a plain alpha-solid
    hull,  ///< repaired, and the added cells made it the whole tetrahedralisation
    given  ///< alpha was given; its boundary may have any defect
};

/// Radii that all give the same alpha-solid, both ends included; `largest` is infinite for the whole
/// tetrahedralisation.
struct AlphaInterval {
    double least = 0, largest = 0;
};

/// Solids that are separate at an alpha smaller than the one that joins them.
struct SeparateSolids {
    std::size_t count = 0;
    double alpha = 0;
};

struct AlphaSolidResult {
    /// The solid's boundary over only its own vertices (in input order, columns carried), outward, closed. Triangles
    /// ascend by cell, then by facet.
    TriangleMesh mesh;
    /// The input with `inside` labelled.
    TetMesh tets;
    /// A radius in the scan's unit; giving it as the parameter gives the same alpha-solid (before any repair).
    double alpha = 0;
    /// The least alpha at which the requested share of the points is in or on the alpha-solid.
    double alpha_cover = 0;
    std::size_t cells_inside = 0;
    /// The number of different alpha-solids from alpha_cover (or a given alpha that is smaller) up to the whole
    /// tetrahedralisation, both included: the different values at which cells enter. Those below alpha_cover leave
    /// points out and are not counted.
    std::size_t spectrum = 0;
    /// Vertex indices of the input, ascending. Interior: inside the solid but not on its boundary. Uncovered: in no
    /// cell of the solid.
    Buffer<u32> interior_points, uncovered_points;
    /// Vertex indices of the input, ascending, of points in no cell at all, because weights hide them. Every other
    /// point is interior, uncovered or on the boundary. Coverage ignores hidden points.
    Buffer<u32> hidden_points;
    /// Components of the boundary that share no vertex; for a manifold boundary, the number of separate solids.
    std::size_t components = 0;
    /// Cells of smaller solids that `single` left out.
    std::size_t cells_left_out = 0;
    AlphaChoice choice = AlphaChoice::scan;
    /// Edges with more than two boundary triangles, and vertices whose boundary triangles are not exactly one closed
    /// fan. Above 0 for a given alpha only.
    std::size_t nonmanifold_edges = 0, nonmanifold_vertices = 0;
    /// Present when alpha was given and its solid is not valid: the radii nearest to it whose solid is.
    std::optional<AlphaInterval> nearest_valid;
    /// Present when alpha grew, for `single` with all points, to join solids that `many` keeps separate.
    std::optional<SeparateSolids> separate;
};

/// Finds the smallest alpha whose solid is valid. When no alpha up to four times alpha_cover has one, the solid at
/// alpha_cover (for `single` the first connected one above) is repaired: round every non-manifold vertex the cells with
/// the least value are added until none is left; cavities that this seals become solid.
///
/// With `search: scan` alpha does not fall when coverage rises: a valid solid for one share is valid for every smaller
/// one, and where a repair for all points starts at a smaller alpha, from components that merely touch, the scan takes
/// that. Bisection gives no such guarantee.
///
/// A given alpha is used unchanged. When its solid is not valid, the nearest alpha that is valid is searched by the
/// same scan, from alpha_cover past the given alpha.
///
/// With weights (TetMesh::weights) the radii are those of spheres orthogonal to weighted points, with all weights
/// lowered by the largest: alpha is the ball's radius where the weight is largest, and at a point of weight w the ball
/// acts with the radius sqrt(alpha² - (largest - w)), or not at all when that is not a number. With `weights: spacing`
/// and factor 1 alpha is about one spacing where the sampling is coarsest; smaller factors allow a smaller alpha, and
/// the ball then shrinks less. Equal weights change no byte.
///
/// Pre:  a tetrahedralisation made by delaunay(), its weights finite and 0 or more; alpha above 0; coverage in (0, 1].
///       Throws Error with numbers, also when the given alpha leaves no cell inside.
/// Post: see AlphaSolidResult. Facet values are computed from corners sorted by coordinates and compared exactly; equal
///       values enter together. Facets that are congruent but oriented differently may differ in the last bits, and
///       then enter one after the other. So the solid depends neither on the order of the points nor on the number of
///       threads. A point exactly on a facet's smallest circumsphere does not attach the facet.
/// Cost: O(n log n) in the worst case, about linear in the cells outside the solid for surface scans; about 80 bytes
///       per cell beside the result, and 50 more for `single` with coverage below 100 %.
/// Metrics: alpha, alpha-cover, spectrum, cells, interior-points, uncovered-points, hidden-points, triangles.
/// Warnings, one sentence each: a given alpha whose solid is not valid, with the nearest valid alpha; points and cells
/// left out; separate solids that were joined; a repaired or hull solid; and an ambiguous choice: points inside, or a
/// chosen alpha far above alpha_cover or the boundary's edges.
/// Doubts: a chosen alpha of at least seven of the boundary's edges. About the mesh only, because sculpt may still
/// improve the solid: more than half of the points inside, and doubts_about_surface().
AlphaSolidResult alpha_solid(const TetMesh& tets, const AlphaSolidParams& params, Context& context);

}  // namespace scanmill
