// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Files with the poses of several scans.
///
/// The content decides between two formats. A Stanford `.conf` has lines `bmesh FILE tx ty tz qx qy qz qw` (or
/// `mesh …`), blank lines and `#` comments; lines `camera …` are ignored. Its quaternions q mean the inverse of the
/// usual rotation: the pose maps a point p to R(q)ᵀ p + t. JSON is as described in kinds/transform.hpp.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/kinds/transform.hpp"

namespace scanmill {

using OnPoseWarning = OnWarning;

/// The poses in the order of the file; at least one. All quaternions are scaled to length 1. Warns about a quaternion
/// whose length differs from 1 by more than rounding to six digits explains.
///
/// Throws Error that begins with the path for a missing or empty file. The message also contains the line, or the
/// number of the pose from 1, for unknown words, missing, superfluous or infinite numbers, a quaternion whose length is
/// more than 0.1 % off 1, and a matrix that is not a rigid motion.
std::vector<ScanPose> read_poses(const std::filesystem::path& file, const OnPoseWarning& warn);

/// The same from a file's content. Errors and warnings do not contain the file's name.
std::vector<ScanPose> parse_poses(std::string_view content, const OnPoseWarning& warn);

/// Whether the pose is for the scan with this name, with or without folder and extension.
bool is_of(const ScanPose& pose, const std::string& scan);

}  // namespace scanmill
