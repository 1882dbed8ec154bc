// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which of the poses in a file belongs to which scan.

#include <span>
#include <vector>

#include "scanmill/data/frame.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/formats/poses/poses.hpp"

namespace scanmill::merging {

/// The pose of every frame. Frames with names take the pose whose scan is called so, with or without folder and
/// extension; poses that nobody takes, or several, are told. When no frame has a name, the n-th takes the n-th pose.
/// Throws Error when only some frames have names, when a named one has no pose or several, and without names when the
/// numbers of frames and poses differ.
std::vector<RigidTransform> poses_of(std::span<const Frame> frames, std::span<const ScanPose> poses, Context& context);

}  // namespace scanmill::merging
