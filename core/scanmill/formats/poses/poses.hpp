// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Poses of several scans in one file.
///
/// Two kinds of file, told apart by their content. A Stanford `.conf` has lines `bmesh FILE tx ty tz qx qy qz qw` (or
/// `mesh …`), blank lines and `#` comments; `camera …` says where somebody looked from and moves nothing. Its
/// quaternions stand for the inverse of the usual rotation: a point p goes to R(q)ᵀ p + t. JSON has the usual one,
/// R(q) p + t:
///
///     {"scanmill": 1, "unit": "m", "frame": "bunny",
///      "poses": [{"scan": "bun000.ply", "rotation": [0, 0, 0, 1], "translation": [0, 0, 0]}]}
///
/// with rotation = [qx, qy, qz, qw] in both; `unit`, `frame` (the name of the frame that all poses lead to) and `scan`
/// may be left out. In place of rotation and translation JSON takes `"matrix"`, four rows of four numbers that p, 1
/// is multiplied with. Coordinates are world coordinates.

#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/transform.hpp"

namespace scanmill {

struct ScanPose {
    std::string scan;  ///< as the file has it: a file's name or stem; may be empty in JSON
    RigidTransform transform;
};

using OnPoseWarning = std::function<void(std::string sentence)>;

/// In the file's order, at least one. Throws Error, beginning with the path, for a file that is missing or empty, and
/// with the line, or the number of the pose from 1, for what cannot be read: unknown words, missing, superfluous or
/// infinite numbers, a quaternion whose length is more than 0.1 % off 1, a matrix that is no rigid motion. A length
/// that rounding to six digits does not explain is told; all quaternions are scaled to length 1.
std::vector<ScanPose> read_poses(const std::filesystem::path& file, const OnPoseWarning& warn);

/// The same from a file's content; errors and warnings come without the file's name.
std::vector<ScanPose> parse_poses(std::string_view content, const OnPoseWarning& warn);

/// Whether the pose says that it is of the scan with this name, with or without folder and extension.
bool is_of(const ScanPose& pose, const std::string& scan);

}  // namespace scanmill
