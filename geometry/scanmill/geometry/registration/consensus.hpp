// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds rigid motions that many correspondences agree with, without random steps.
///
/// Source: Chen, Sun, Yang and Tao 2022, "SC²-PCR: A Second Order Spatial Compatibility for Efficient and Robust Point
/// Cloud Registration".

#include <span>

#include "scanmill/geometry/registration/descriptors.hpp"
#include "scanmill/geometry/registration/rigid_motion.hpp"

namespace scanmill {

struct ConsensusParams {
    /// Two correspondences are compatible if the distances of their points differ by less than this. A correspondence
    /// votes for a motion that brings its points closer than 1.5 times this, and motions differ by more than twice
    /// this.
    double tolerance = 0;
    /// The centre and the radius of the first set, for displacement().
    Vec3 centre = Vec3::Zero();
    double radius = 0;
    /// The largest number of motions.
    std::size_t most_motions = 20;
};

struct Hypothesis {
    RigidMotion motion;  ///< from the first set to the second
    u32 votes = 0;
};

struct PointsWithNormals {
    std::span<const Vec3> points, normals;
};

/// Motions from the first set to the second by number of votes, the most first; each differs from all before it.
///
/// Two correspondences i, j are compatible if the distances of their points agree, if these are not so short that they
/// agree by chance, and if the products of their normals agree. Their second-order compatibility is the number of
/// correspondences that are compatible with both. A group is a correspondence and those with which it has the largest
/// second-order compatibility. The groups of the correspondences with the largest sums give one motion each.
///
/// Ties: the lower index of a correspondence; for equal votes, the motion that was found first.
/// Cost: for n correspondences n² / 2 tests of compatibility, and n words of 64 bits for each compatible pair; about
/// 40 ms for 3,000.
std::vector<Hypothesis> consistent_motions(const PointsWithNormals& first, const PointsWithNormals& second,
                                           std::span<const Correspondence> correspondences,
                                           const ConsensusParams& params);

}  // namespace scanmill
