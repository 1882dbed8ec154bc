// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The pose of one scan on a model that stays, without a start.
///
/// Source: as for register_views.hpp; the test against rivals is our own.

#include <algorithm>
#include <functional>

#include "register/register_views.hpp"
#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct TargetSamples {
    Array<Vec3> points, normals;
    double spacing = 0;  ///< about the distance of a point from the nearest other one
};

/// Points of the mesh in rows across the longest edge of each triangle, at most `spacing` apart, with the normals of
/// the triangles. Triangles without area have none. The spacing is doubled until there are at most two million points
/// beside one per triangle. Pre: finite; spacing > 0.
TargetSamples samples_of(const TriangleMesh& mesh, double spacing);

/// Points of the cloud, about `spacing` apart or as they are if that is farther, with the normals of the planes through
/// their neighbours, turned to the scanner. Pre: finite; spacing > 0; `to_scanner` as for ScanToPlace.
TargetSamples samples_of(std::span<const Vec3> points, std::span<const Vec3> to_scanner, double spacing);

/// A scan from one side or from all sides.
struct ScanToPlace {
    std::string name;
    std::span<const Vec3> points;
    /// Unit vectors to the scanner: one for all points, or one per point.
    std::span<const Vec3> to_scanner;
    /// A pose to begin with.
    std::optional<RigidMotion> start{};
};

enum class TargetRefusal {
    none,
    ambiguous,  ///< another pose fits equally well
    slides,  ///< the surfaces do not determine the pose
    no_fit,  ///< too few of the scan's points lie on the model
    contradicts  ///< the model is in front of the scan, where the scanner would have hit it first
};
/// "ambiguous", "slides", "no-fit", "contradicts"; empty for `none`.
std::string_view name_of(TargetRefusal refusal);

struct RegisterToTargetResult {
    /// The best pose, from the scan's frame to the target's; usable only without a refusal.
    RigidMotion pose;
    TargetRefusal refusal = TargetRefusal::no_fit;
    double fit = 0;  ///< share of the scan's points that lie on the model
    double rival = 0;  ///< the largest share of another pose; with a start, the share of the next nearest one
    std::size_t rivals = 0;  ///< number of other poses that fit about equally well
    double slide = 0;  ///< see PairMeasures::slide
    /// For scans from one side: number of the target's points in front of the scan, as a share of these and of the ones
    /// on it.
    double front = 0;
    double spacing = 0;  ///< the larger one of the scan's and the target's
    double resolution = 0;
    double tolerance = 0;  ///< points up to so far from the model's planes lie on it

    /// How much better the best pose is than any other.
    double confidence() const { return fit > 0 ? std::max(0.0, 1 - rival / fit) : 0; }
};

/// Registers a scan to a target. Tries the poses that descriptors propose, and turns of the best one about the
/// principal axes of the target, because symmetric parts fit in several poses.
///
/// `target` returns samples of the target that are about as far apart as its argument, or farther.
/// Pre:  units are equal. Throws Error as register_views() for the scan, and for a target without samples.
/// Determinism: bytes do not depend on the number of threads.
/// Cost: a few seconds; most of it refines the turned poses.
RegisterToTargetResult register_to_target(const ScanToPlace& scan,
                                          const std::function<TargetSamples(double spacing)>& target,
                                          const RegisterViewsParams& params, Execution& execution);

}  // namespace scanmill
