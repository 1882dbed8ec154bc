// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The two kinds of pose file, from their bytes: see poses.hpp. Errors and warnings come without the file's name.

#include "scanmill/formats/poses/poses.hpp"

namespace scanmill {

std::vector<ScanPose> parse_stanford_conf(std::string_view text, const OnPoseWarning& warn);
std::vector<ScanPose> parse_poses_json(std::string_view text, const OnPoseWarning& warn);

}  // namespace scanmill
