// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two kinds of pose file, from their bytes: see poses.hpp. Errors and warnings come without the file's name.

#include <functional>

#include "merge/poses.hpp"

namespace scanmill::merging {

using Warn = std::function<void(std::string sentence)>;

std::vector<ScanPose> parse_stanford_conf(std::string_view text, const Warn& warn);
std::vector<ScanPose> parse_poses_json(std::string_view text, const Warn& warn);

/// The usual rotation of the quaternion x, y, z, w scaled to length 1. `place` begins every message: "line 3".
Eigen::Matrix3d rotation_of(std::span<const double, 4> quaternion, std::string_view place, const Warn& warn);

}  // namespace scanmill::merging
