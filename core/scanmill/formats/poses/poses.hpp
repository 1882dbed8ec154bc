// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Files with the poses of several scans.
///
/// The content decides between two formats. A Stanford `.conf` has lines `bmesh FILE tx ty tz qx qy qz qw` (or
/// `mesh …`), blank lines and `#` comments; lines `camera …` are ignored. Its quaternions mean the inverse of the usual
/// rotation: a point p goes to R(q)ᵀ p + t. JSON is as described in kinds/transform.hpp.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/kinds/transform.hpp"

namespace scanmill {

using OnPoseWarning = OnWarning;

/// In the file's order, at least one. Throws Error that begins with the path, for a missing or empty file, and with the
/// line or the number of the pose from 1 for unknown words, missing, superfluous or infinite numbers, a quaternion
/// whose length is more than 0.1 % off 1, a matrix that is not a rigid motion. Warns of a quaternion whose length
/// rounding to six digits does not explain; all quaternions are scaled to length 1.
std::vector<ScanPose> read_poses(const std::filesystem::path& file, const OnPoseWarning& warn);

/// The same from a file's content; errors and warnings do not have the file's name.
std::vector<ScanPose> parse_poses(std::string_view content, const OnPoseWarning& warn);

/// Whether the pose is for the scan with this name, with or without folder and extension.
bool is_of(const ScanPose& pose, const std::string& scan);

}  // namespace scanmill
