// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The points on the outer side of a noisy sample.
///
/// A cell is big if its circumradius is larger than `factor` times the largest distance from one of its corners to that
/// corner's k-th nearest other point. Big cells lie outside the object or inside, not in the layer of noise between.
/// Two big cells that share a facet are connected if their circumspheres intersect deeply, with less than 90° between
/// their radii; a big cell at the hull is connected to the outside if its circumcentre lies beyond the hull. The points
/// of the cells that are connected to the outside, and those of the hull, are kept.
///
/// With Gaussian noise of 0.3, 0.5 and 1 spacings on a sphere or a torus, 73, 55 and 35 % of the points are kept. They
/// lie 0.4, 0.65 and 1.05 standard deviations outside of the surface on average and scatter by 0.8, 0.73 and 0.66: the
/// result is smoother, and too large by that much. The spacing is here the least distance in a Poisson-disc sample of
/// as many points, which is 0.76 times the square root of the area per point.
///
/// The scan must be complete: through a hole that is wider than the balls beside it, the outside enters the object.
///
/// Source: Dey, Goswami 2004.

#include "scanmill/data/tets.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::cocones {

/// Vertices, ascending. Throws Error if no cell is big, and if fewer than 1 % of the big cells are left inside: the
/// walk has then entered the object. Pre: no weights; neighbours at least 1; factor above 0. Cost: linear, and a search
/// for the neighbours.
Array<u32> outer_points(const TetMesh& tets, u32 neighbours, double factor, Context& context);

/// The Delaunay tetrahedralisation of these vertices, with their columns.
TetMesh tets_of(const TetMesh& tets, std::span<const u32> vertices, Context& context);

}  // namespace scanmill::cocones
