// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Pairs of points for tests of align and apply-transform.

#include <Eigen/Geometry>
#include <vector>

#include "align/align.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::test {

/// A plate of 200 x 120 around 0, counter-clockwise seen from above.
inline std::vector<Vec3> plate() { return {{-100, -60, 0}, {100, -60, 0}, {100, 60, 0}, {-100, 60, 0}}; }

inline PointCloud cloud(std::vector<Vec3> points, std::string frame = {}) {
    PointCloud result;
    result.frame.name = std::move(frame);
    result.positions = Array<Vec3>(points.begin(), points.end());
    return result;
}

/// Any rotation, and a translation within [-range, range]³.
inline RigidTransform random_motion(Random& random, double range = 1000) {
    RigidTransform motion;
    const Eigen::Quaterniond turn(random.normal(), random.normal(), random.normal(), random.normal());
    motion.rotation = turn.normalized().toRotationMatrix();
    for (double& coordinate : motion.translation) coordinate = random.uniform(-range, range);
    return motion;
}

inline std::vector<Vec3> moved(const std::vector<Vec3>& points, const RigidTransform& motion) {
    std::vector<Vec3> result;
    for (const Vec3& p : points) result.push_back(motion.apply(p));
    return result;
}

inline std::vector<Vec3> with_noise(std::vector<Vec3> points, double sigma, Random& random) {
    for (Vec3& p : points)
        for (double& coordinate : p) coordinate += sigma * random.normal();
    return points;
}

struct Aligned : AlignResult {
    Metrics metrics;
    std::vector<std::string> warnings;
    std::vector<Doubt> doubts;
};

inline Aligned aligned(const PointCloud& source, const PointCloud& target, const AlignParams& params = {},
                       const std::optional<AlignPart>& part = {}) {
    Context context;
    AlignResult result = align(source, target, part, params, context);
    return {std::move(result), context.metrics(), context.warnings(), context.doubts()};
}

inline AlignParams in_rectangle(const Vec3& first_corner) {
    AlignParams params;
    params.correspondence = AlignParams::Correspondence::rectangle;
    params.first_corner = {first_corner.x(), first_corner.y(), first_corner.z()};
    return params;
}

}  // namespace scanmill::test
