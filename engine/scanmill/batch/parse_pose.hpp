// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A pose as a batch gives it: written in place, or one of those in a file.

#include <filesystem>
#include <map>
#include <optional>

#include "scanmill/formats/poses/poses.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// Four rows of four numbers, or `{translation: [x, y, z], rotation: [qx, qy, qz, qw]}`; its unit is left unknown.
/// Nothing after reporting what is wrong.
std::optional<RigidTransform> parse_pose(const YamlNode& node, Diagnostics& diagnostics);

/// Files of poses, each read once however many scans it is for.
class PoseFiles {
public:
    /// The pose of the scan: the one that names it, else the only one when that names no scan. Warnings go to
    /// `diagnostics`. Throws Error, beginning with the path, for a file that cannot be read and when no pose, or
    /// several, are of this scan.
    RigidTransform pose_of(const std::filesystem::path& scan, const std::filesystem::path& file, Position position,
                           Diagnostics& diagnostics);

private:
    std::map<std::filesystem::path, std::vector<ScanPose>> poses_;
};

}  // namespace scanmill
