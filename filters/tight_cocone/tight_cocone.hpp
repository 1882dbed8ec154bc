// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Tight Cocone: a closed surface through the points, whatever is missing in the scan.
///
/// The surface of cocone divides the cells around most points into an outer and an inner part. Cells around such *good*
/// points are labelled by it, beginning at the hull. Then the outside spreads from the hull from cell to cell. It stops
/// at cells labelled inside, and enters a cell whose four points are all *poor* unless it comes through the cell's
/// smallest facet (by circumradius). What is left is the solid: a union of cells, so its boundary is closed wherever
/// cocone's surface has holes. Parts of it without a good point are dropped, unless no point is good.
///
/// Source: Dey, Goswami 2003; Woo, Dey 2005, section 2; Dey, Goswami 2004 for the noise mode. A second pass over good
/// points that were not reached, as in the published program, would change nothing here: no cell at them is outside.

#include "cocone/cocone.hpp"

namespace scanmill {

struct TightCoconeParams : CoconeParams {
    enum class Noise {
        none,
        big_balls  ///< keeps the points on the outer side of a noisy sample only, see big_balls.hpp
    };
    Noise noise = Noise::none;
    /// At least 1.
    u32 noise_neighbours = 12;
    /// Above 0.
    double noise_factor = 1;
};

struct TightCoconeResult {
    /// The solid's boundary, closed and outward. Its vertices are those on the boundary, in input order and with their
    /// columns and those of cocone (see CoconeResult).
    TriangleMesh mesh;
    /// The input with those columns, and labelled cells. With big_balls, a tetrahedralisation of the kept points.
    TetMesh tets;
    std::size_t good = 0, poor = 0, boundary_points = 0;
    /// Points of the input that are not on the boundary.
    std::size_t unused = 0;
    /// Loops of cocone's surface whose edges are all edges of the result.
    std::size_t holes_filled = 0;
    /// Area of the triangles that are not in cocone's surface, and of all.
    double invented_area = 0, area = 0;
    /// Connected sets of good points inside the solid, such as the surface of a cavity: the outside does not reach
    /// them.
    std::size_t removed_blobs = 0;
    /// Number of vertices where the boundary was not a manifold, and cells were added.
    std::size_t mended_vertices = 0;
};

/// Pre:  as for cocone(). Throws Error as cocone() does, if the outside spreads everywhere, and if the noise mode's
/// walk
///       has entered the object.
/// Post: see TightCoconeResult. The boundary is a closed 2-manifold, oriented outwards, through a subset of the points.
///       It has no cavities. The bytes do not depend on the number of threads. The surface does not depend on the order
///       of the points, unless several lie within 2^-21 of the cloud's extent.
/// Ties: a cell whose good points disagree follows most of them; on a tie it is inside. Of equally small facets, the
///       one opposite to the first corner counts.
/// Cost: linear in the cells, and a search for 16 neighbours of each point; about 130 bytes per cell. The noise mode
///       adds a tetrahedralisation of the kept points.
/// Metrics: see plugin.cpp. Warns of an area that no point shows. Doubts the result if that is more than a tenth of the
/// surface, or if more than 2 % of the points are not used without the noise mode. Passes on doubts_about_surface(),
/// and doubts_about_handles() if a point is poor.
TightCoconeResult tight_cocone(const TetMesh& tets, const TightCoconeParams& params, Context& context);

}  // namespace scanmill
