// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Assigns the poses in a file to scans.
///
/// The quaternions of Stanford's .conf files are the inverse of the usual rotation (see
/// scanmill/formats/poses/poses.hpp). Read as inverse rotations, the ten views of the Stanford bunny lie on its model
/// (median 0.06 mm, 95 % below 0.4 mm). Read as usual rotations, eight of the views lie more than 3 mm off the model.

#include <span>
#include <vector>

#include "scanmill/data/frame.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/formats/poses/poses.hpp"

namespace scanmill::merging {

/// The pose of every frame. A frame with a name gets the pose whose scan has that name, with or without folder and
/// extension. Warns of unused poses, and of poses used several times. If no frame has a name, the n-th frame gets the
/// n-th pose. Throws Error if only some frames have names, if a frame with a name has no pose or several, or if frames
/// without names and poses differ in number.
std::vector<RigidTransform> poses_of(std::span<const Frame> frames, std::span<const ScanPose> poses, Context& context);

}  // namespace scanmill::merging
