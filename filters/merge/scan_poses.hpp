// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Assigns poses to scans: those in a file, or the motions of a transform.
///
/// The quaternions of Stanford's .conf files are the inverse of the usual rotation (see
/// scanmill/formats/poses/poses.hpp). Read as inverse rotations, the ten views of the Stanford bunny lie on its model
/// (median 0.06 mm, 95 % below 0.4 mm). Read as usual rotations, eight of the views lie more than 3 mm off the model.

#include <optional>
#include <span>
#include <vector>

#include "merge/merge.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/formats/poses/poses.hpp"

namespace scanmill::merging {

/// The motions as poses, then the refused frames. The name of a scan is that of its frame.
std::vector<ScanPose> scan_poses_of(const Transforms& transforms);

/// The pose of every frame, nullopt for refused scans. A frame with a name gets the pose whose scan has that name, with
/// or without folder and extension. Warns of refused scans with their reasons, of unused poses, and of poses used
/// several times. If no frame has a name, the n-th frame gets the n-th pose. Throws Error if only some frames have
/// names, if a frame with a name has no pose or several, if frames without names and poses differ in number, if there
/// are refused scans and frames without names, and if all scans are refused.
std::vector<std::optional<RigidTransform>> poses_of(std::span<const Frame> frames, std::span<const ScanPose> poses,
                                                    Context& context);

/// Sets the poses of `params` to those of the clouds' frames. Removes the clouds whose scans are refused; the others
/// keep their numbers. Throws Error and warns as poses_of().
void place(std::vector<std::shared_ptr<const PointCloud>>& clouds, MergeParams& params, std::span<const ScanPose> poses,
           Context& context);

}  // namespace scanmill::merging
