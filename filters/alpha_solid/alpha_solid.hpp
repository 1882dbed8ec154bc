// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The alpha-solid: the part of a Delaunay tetrahedralisation that a ball of radius alpha cannot enter from outside,
/// with alpha chosen automatically.
///
/// A facet is a wall at alpha if it belongs to the alpha-shape: if the radius of its sphere is at most alpha. The
/// sphere of a facet is its smallest circumscribed sphere. If that contains an opposite vertex, the smaller of the
/// circumscribed spheres of the facet's cells takes its place. The solid is every cell that cannot be reached from
/// outside without crossing a wall. Therefore it has no cavities. A larger alpha gives a larger solid.
///
/// A solid is valid if it meets these conditions:
/// - The requested share of the points is in or on it.
/// - Its boundary is a closed 2-manifold: the triangles of every vertex form exactly one closed fan.
/// - For `single`, it is connected.
/// From alpha_cover on, every alpha meets the first condition, but a larger alpha may not meet the second one.
/// Therefore the scan starts at alpha_cover and adds the cells of one value after the other until the solid is valid.
/// It tests only the vertices of the added cells.
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
    /// One solid. With full coverage, alpha grows until all solids are joined. With less, only the solid with the most
    /// points is kept.
    single,
    many  ///< any number of solids
};

struct AlphaSolidParams {
    /// The radius. If absent, the smallest radius that gives a valid solid.
    std::optional<Length> alpha;
    AlphaSearch search = AlphaSearch::scan;
    AlphaComponents components = AlphaComponents::single;
    /// The share of the points that must be in or on the solid, in (0, 1].
    Ratio coverage = Ratio::percent(100);
};

/// Describes how alpha and the solid were found.
enum class AlphaChoice {
    scan,  ///< a plain alpha-solid, the first valid one
    binary,  ///< a plain alpha-solid found by bisection
    repaired,  ///< cells were added around the non-manifold vertices of a plain alpha-solid
    hull,  ///< repaired, and with the added cells the solid is the whole tetrahedralisation
    given  ///< alpha was given; the solid's boundary may have any defect
};

/// An interval of radii, both ends included, that all give the same alpha-solid. `largest` is infinite for the whole
/// tetrahedralisation.
struct AlphaInterval {
    double least = 0, largest = 0;
};

/// The number of solids that are separate at `alpha`, and joined at a larger alpha.
struct SeparateSolids {
    std::size_t count = 0;
    double alpha = 0;
};

struct AlphaSolidResult {
    /// The solid's boundary, closed and outward. Its vertices are those on the boundary, in input order and with their
    /// columns. Triangles ascend by cell, then by facet.
    TriangleMesh mesh;
    /// The input, with `inside` set for the cells of the solid.
    TetMesh tets;
    /// The radius in the scan's unit. If it is given as a parameter, the alpha-solid is the same, before any repair.
    double alpha = 0;
    /// The least alpha at which the requested share of the points is in or on the alpha-solid.
    double alpha_cover = 0;
    std::size_t cells_inside = 0;
    /// The number of different alpha-solids from alpha_cover, or from a smaller given alpha, up to the whole
    /// tetrahedralisation, both included. It is the number of different values at which cells enter.
    std::size_t spectrum = 0;
    /// Vertex indices of the input, ascending. Interior points are inside the solid but not on its boundary. Uncovered
    /// points are in no cell of the solid.
    Buffer<u32> interior_points, uncovered_points;
    /// Vertex indices of the input, ascending. Hidden points are in no cell at all, because of their weights. Every
    /// other point is interior, uncovered or on the boundary. Coverage ignores hidden points.
    Buffer<u32> hidden_points;
    /// Number of components of the boundary that share no vertex. For a manifold boundary, it is the number of separate
    /// solids.
    std::size_t components = 0;
    /// Number of cells in smaller solids that `single` left out.
    std::size_t cells_left_out = 0;
    AlphaChoice choice = AlphaChoice::scan;
    /// Number of edges with more than two boundary triangles, and of vertices whose boundary triangles do not form
    /// exactly one closed fan. They can be above 0 only for a given alpha.
    std::size_t nonmanifold_edges = 0, nonmanifold_vertices = 0;
    /// The radii nearest to the given alpha that give a valid solid; present if the given alpha does not.
    std::optional<AlphaInterval> nearest_valid;
    /// The solids that `many` would keep separate; present if alpha grew, for `single` with full coverage, to join
    /// them.
    std::optional<SeparateSolids> separate;
};

/// Finds the smallest alpha whose solid is valid. If no alpha up to four times alpha_cover gives a valid solid, the
/// solid at alpha_cover is repaired; for `single`, the first connected solid from alpha_cover on. The repair adds,
/// around every non-manifold vertex, the cells with the smallest value, until no such vertex is left. Cavities that the
/// added cells enclose become solid.
///
/// With `search: scan`, alpha does not fall when coverage rises, because a valid solid for one share is valid for every
/// smaller share. A repair for all points may start at a smaller alpha, from components that merely touch; then the
/// scan takes that repair. Bisection gives no such guarantee.
///
/// A given alpha is used unchanged. If its solid is not valid, the same scan searches for the nearest valid alpha, from
/// alpha_cover past the given alpha.
///
/// With weights (TetMesh::weights), radii are those of spheres orthogonal to weighted points, after the largest weight
/// is subtracted from all. alpha is the ball's radius where the weight is largest. At a point of weight w, the ball has
/// the radius sqrt(alpha² - (largest - w)); where that is not a number, the ball does not act. With `weights: spacing`
/// and factor 1, alpha is about one spacing where the sampling is coarsest. Smaller factors allow a smaller alpha, and
/// the ball then shrinks less. Equal weights change no byte.
///
/// Pre:  a tetrahedralisation made by delaunay(); weights are finite and 0 or more; alpha is above 0; coverage is in
///       (0, 1]. Otherwise throws Error with numbers. Also throws Error if a given alpha leaves no cell inside.
/// Post: see AlphaSolidResult. The solid depends neither on the order of the points nor on the number of threads. Facet
///       values are computed from corners sorted by coordinates, and compared exactly. Facets of equal value enter
///       together. The values of congruent facets with different orientations may differ in the last bits; then these
///       facets enter one after the other. A point exactly on a facet's smallest circumsphere does not attach the
///       facet.
/// Cost: O(n log n) time in the worst case; for surface scans about linear in the number of cells outside the solid.
///       About 80 bytes per cell beside the result, and 50 more for `single` with coverage below 100 %.
/// Metrics: alpha, alpha-cover, spectrum, cells, interior-points, uncovered-points, hidden-points, triangles.
/// Warnings, one sentence each: a given alpha whose solid is not valid, with the nearest valid alpha; points and cells
/// left out; separate solids that were joined; a repaired or hull solid; points inside; and a chosen alpha far above
/// alpha_cover or above the length of the boundary's edges.
/// Doubts: a chosen alpha of at least seven times the boundary's median edge. The other doubts concern the mesh only,
/// because sculpt may still improve the solid: more than half of the points inside, and doubts_about_surface().
AlphaSolidResult alpha_solid(const TetMesh& tets, const AlphaSolidParams& params, Context& context);

}  // namespace scanmill
