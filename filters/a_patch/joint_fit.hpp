// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Fits a mesh, its normals, and the gradients of its edges together to points, so that the surface over it bends
/// little.

#include <span>

#include "a_patch/hull.hpp"

namespace scanmill::a_patches {

struct JointFit {
    double weight = 0;  ///< the bending's, beside the points
    double offset_rms = 0, offset_max = 0;  ///< moves of the vertices along their normals
    std::size_t flips = 0, bisected = 0;  ///< numbers of edges
    std::size_t unseen = 0;    ///< number of vertices without a point in their triangles
    std::vector<double> offsets;  ///< by vertex: its move along its normal
};

/// Makes the triangles even (make_even()), then minimises
///     A / n · sum over the points of omega (distance from the surface)²  +  weight · h⁴ · integral of |H|²
/// over the offsets of the vertices along their normals, two turns of every normal, and one slope per edge. A is the
/// area of the mesh, h² = 4 A / (sqrt(3) · number of triangles), and H has the second derivatives of the surface's
/// height over its triangle; see FacetHeight. omega is less than 1 for points farther than outlier_distances() (Huber).
///
/// The weight is a power of the square root of 10, from 1e-6 to 1: the one with which the surface fitted to one half of
/// the points is nearest to the other half. Cubic cells of edge h are in one half, so that correlated noise does not
/// count as shape.
///
/// A triangle is too coarse for the shape if its points have an rms distance of more than 1.5 times that of the median
/// triangle, and of more than a twentieth of their rms distance from the mesh. Such triangles are bisected and the fit
/// is repeated, up to four times. This adds up to 30 % of the edges on clean scans, and few on noisy ones.
///
/// Vertices on sharp edges and on the boundary, without normal, or without a point in their triangles keep their
/// positions, and so do those of triangles that intersect others. Normals beside sharp edges stay, so that creases do.
/// Steps that would fold triangles are shortened.
///
/// The weight is multiplied by `fairing`. Without points near the mesh nothing changes.
///
/// Pre: at least one point; `fairing` at least 0. Sets positions, normals, triangles and bends of the mesh. Bytes do
/// not depend on the number of threads. Cost: about 500 us per triangle and 15 us per point,
/// a little more than linear; up to three times as much if triangles intersect.
JointFit fit_jointly(PatchMesh& mesh, std::span<const Vec3> points, double fairing, Execution& execution);

/// Bisects triangles of a mesh that fit_jointly() fitted, and repeats the fit with the same weight, without making the
/// triangles even. The result's `bisected`, `flips` and offsets include those of `before`. Pre: as for fit_jointly().
/// Cost: about 200 us per triangle and 10 us per point.
JointFit fit_refined(PatchMesh& mesh, std::span<const u32> triangles, std::span<const Vec3> points,
                     const JointFit& before, Execution& execution);

}  // namespace scanmill::a_patches
