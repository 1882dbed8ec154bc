// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Assigns the poses in a file to scans.
///
/// The quaternions of Stanford's .conf files are the inverse of the usual rotation (see scanmill/formats/poses.hpp).
/// Read so, the ten views of the Stanford bunny lie on its model (median 0.06 mm, 95 % below 0.4 mm); read the usual
/// way, eight of them lie more than 3 mm off it.

#include <span>
#include <vector>

#include "scanmill/data/frame.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/formats/poses/poses.hpp"

namespace scanmill::merging {

/// The pose of every frame. Frames with names get the pose whose scan has that name, with or without folder and
/// extension; unused poses, and poses used several times, give a warning. When no frame has a name, the n-th gets the
/// n-th pose. Throws Error when only some frames have names, when a named one has no pose or several, and without names
/// when the numbers of frames and poses differ.
std::vector<RigidTransform> poses_of(std::span<const Frame> frames, std::span<const ScanPose> poses, Context& context);

}  // namespace scanmill::merging
