// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz/targets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/poses/poses.hpp"

namespace scanmill::test {

bool check_poses(std::string_view bytes) {
    std::vector<ScanPose> poses;
    try {
        poses = parse_poses(bytes, [](const std::string&) {});
    } catch (const Error&) {
        return false;
    }
    require_law(!poses.empty(), "a file of poses without one");
    for (const ScanPose& pose : poses) {
        const Eigen::Matrix3d& rotation = pose.transform.rotation;
        require_law((rotation * rotation.transpose() - Eigen::Matrix3d::Identity()).norm() < 1e-12, "no rotation");
        require_law(pose.transform.translation.allFinite(), "a translation that is no vector");
    }
    return true;
}

}  // namespace scanmill::test
