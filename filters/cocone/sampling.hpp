// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Judges at which points the surface is sampled densely enough to be reconstructed: flat points and boundary points.

#include "cocone/cocone.hpp"
#include "scanmill/geometry/tets/voronoi.hpp"

namespace scanmill::cocones {

/// The Voronoi diagram of the points, with what all steps need of it.
struct Diagram {
    Diagram(const TetMesh& tets, double cone_angle, Context& context);

    const TetMesh& tets;
    VertexCells cells_at;
    Array<Vec3> centres;
    Poles poles;
    Array<std::uint16_t> hits;  ///< see cocone_hits()
};

struct Sampling {
    Array<u8> flat, boundary;
    /// Mean distance to the six nearest other points.
    Array<double> spacing;
    std::size_t pole_flat = 0, boundary_points = 0;
};

/// Cost: linear, and a search for 16 neighbours of each point.
Sampling sampling(const Diagram& diagram, const CoconeParams& params, Context& context);

}  // namespace scanmill::cocones
