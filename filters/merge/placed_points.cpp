// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge/placed_points.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::merging {

namespace {

/// p goes to rotation p + shift.
struct Motion {
    Eigen::Matrix3d rotation;
    Vec3 shift;
};

}  // namespace

PointCloud placed_points(std::span<const std::shared_ptr<const PointCloud>> clouds,
                         std::span<const RigidTransform> poses) {
    PointCloud result;
    result.frame = clouds.front()->frame;
    std::vector<Motion> motions;  // to world coordinates, from relative ones
    std::size_t points = 0;
    BoundingBox world;
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        points += clouds[i]->size();
        const Vec3& origin = clouds[i]->frame.origin;
        if (poses.empty()) {
            motions.push_back({Eigen::Matrix3d::Identity(), origin});
            continue;
        }
        const Eigen::Matrix3d& rotation = poses[i].rotation;
        motions.push_back({rotation, rotation * origin + translation_in(result.frame.unit, poses[i])});
        for (const Vec3& p : clouds[i]->positions) {
            const Vec3 moved = rotation * p + motions.back().shift;
            world.low = world.low.cwiseMin(moved);
            world.high = world.high.cwiseMax(moved);
        }
    }
    if (!poses.empty()) {
        result.frame.name = poses.front().to;
        result.frame.origin = distant_origin(world);
    }

    Array<Vec3> positions;
    positions.reserve(points);
    for (std::size_t i = 0; i < clouds.size(); ++i) {
        const Vec3 shift = motions[i].shift - result.frame.origin;
        if (poses.empty() && shift.isZero(0))  // adding zero would turn -0 into 0
            positions.insert(positions.end(), clouds[i]->positions.begin(), clouds[i]->positions.end());
        else
            for (const Vec3& p : clouds[i]->positions) positions.push_back(motions[i].rotation * p + shift);
    }
    try {
        require_finite(positions);
    } catch (Error& error) {
        error.add_frame("after the clouds were moved to one frame");
        throw;
    }
    result.positions = std::move(positions);
    return result;
}

}  // namespace scanmill::merging
