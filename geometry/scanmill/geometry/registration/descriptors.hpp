// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fast point feature histograms (FPFH): 33 numbers per point that describe the shape of the surface around it and do
/// not change when the points are moved rigidly; and pairs of points with similar descriptors.
///
/// Source: Rusu, Blodow and Beetz 2009.

#include <array>
#include <span>

#include "scanmill/data/point_tree.hpp"

namespace scanmill {

inline constexpr int descriptor_size = 33;
using Descriptor = std::array<double, descriptor_size>;

/// The descriptor of every position of the tree, from at most `most_neighbours` other positions within `radius`.
///
/// A point's own histograms count three angles between its normal and the normals of its neighbours, 11 bins each, that
/// add up to 100. Its descriptor is the mean of the neighbours' histograms, weighted by 1 / squared distance and scaled
/// to 100 per angle, plus its own histograms. All zero without neighbours.
///
/// Pre:  one unit normal per position, all turned to the same side of the surface.
/// Ties: of equally near neighbours the lower index counts.
/// Cost: about 10 us per point with 100 neighbours.
Array<Descriptor> point_descriptors(const PointTree& tree, std::span<const Vec3> normals, double radius,
                                    std::size_t most_neighbours);

/// A point of the first set and a point of the second with similar descriptors.
struct Correspondence {
    u32 first, second;
    double squared;  ///< squared distance of the descriptors
};

/// For each point the `nearest` most similar points of the other set, in both directions, without repeats; of these at
/// most `most`, the most similar ones first.
///
/// Ties: the lower index of the first set, then of the second.
/// Cost: all distances are computed, about 15 ns each; a search tree is not faster in 33 dimensions.
Array<Correspondence> similar_points(std::span<const Descriptor> first, std::span<const Descriptor> second,
                                     std::size_t nearest, std::size_t most);

}  // namespace scanmill
