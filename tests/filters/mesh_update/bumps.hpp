// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A sphere with a smaller sphere added or removed, and clouds on its surface, whose volume is known in closed form.

#include <cmath>
#include <memory>
#include <numbers>

#include "mesh_update/mesh_update.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::test {

/// The sphere of radius R around 0, united with (added) or without the sphere of radius r around (0, 0, R).
struct Bump {
    double R = 10, r = 4;
    bool is_added = true;

    double lens() const {  // volume of the intersection of both balls, whose centres are R apart
        const double d = R;
        return std::numbers::pi * (R + r - d) * (R + r - d) *
               (d * d + 2 * d * r - 3 * r * r + 2 * d * R + 6 * r * R - 3 * R * R) / (12 * d);
    }
    double ball(double radius) const { return 4.0 / 3 * std::numbers::pi * radius * radius * radius; }
    double volume() const { return is_added ? ball(R) + ball(r) - lens() : ball(R) - lens(); }
    /// Distance from the surface of the smaller ball's part and of the larger one's.
    bool is_on_large(const Vec3& p) const { return (p - Vec3(0, 0, R)).norm() > r; }
    bool is_on_small(const Vec3& p) const { return is_added ? p.norm() > R : p.norm() < R; }
};

struct Sampling {
    double spacing = 0.5;  ///< least distance between points
    double overlap = 2;  ///< width of the ring on the large sphere
    double noise = 0;  ///< standard deviation per coordinate
    Vec3 shift = Vec3::Zero();
    std::uint64_t seed = 1;
};

inline Vec3 on_unit_sphere(Random& random) {
    while (true) {
        const Vec3 p(random.uniform() * 2 - 1, random.uniform() * 2 - 1, random.uniform() * 2 - 1);
        if (const double length = p.norm(); length > 0.1 && length <= 1) return p / length;
    }
}

inline std::shared_ptr<const PointCloud> bump_cloud(const Bump& bump, const Sampling& sampling) {
    Random random(sampling.seed);
    Array<Vec3> points;
    const Vec3 top(0, 0, bump.R);
    int misses = 0;
    while (misses < 4000) {
        const bool large = random.uniform() < 0.5;
        const Vec3 p = large ? Vec3(bump.R * on_unit_sphere(random)) : Vec3(top + bump.r * on_unit_sphere(random));
        if (large ? !bump.is_on_large(p) || (p - top).norm() > bump.r + sampling.overlap : !bump.is_on_small(p))
            continue;
        bool is_free = true;
        for (const Vec3& q : points) is_free = is_free && (p - q).norm() >= sampling.spacing;
        if (!is_free) {
            ++misses;
            continue;
        }
        misses = 0;
        points.push_back(p);
    }
    for (Vec3& p : points)
        p += sampling.shift + sampling.noise * Vec3(random.normal(), random.normal(), random.normal());
    PointCloud cloud;
    cloud.positions = std::move(points);
    return std::make_shared<const PointCloud>(std::move(cloud));
}

}  // namespace scanmill::test
