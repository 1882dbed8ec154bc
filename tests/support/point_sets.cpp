// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/point_sets.hpp"

#include <Eigen/Geometry>
#include <numbers>
#include <numeric>
#include <unordered_map>

#include "scanmill/base/random.hpp"

namespace scanmill::test {

namespace {

PointCloud cloud(Array<Vec3> positions) {
    PointCloud result;
    result.positions = std::move(positions);
    return result;
}

Vec3 shake(Random& random, double amount) {
    if (amount == 0) return Vec3::Zero();
    const double x = random.uniform(-amount, amount), y = random.uniform(-amount, amount);
    return {x, y, random.uniform(-amount, amount)};
}

/// Cells of a cubic grid of edge `distance`, so that only 27 must be searched for a point nearer than that.
class Grid {
public:
    explicit Grid(double distance) : distance_(distance) {}

    /// Adds the point unless another one is nearer than `distance`.
    bool add(const Vec3& p) {
        const Eigen::Vector3i centre = (p / distance_).array().floor().cast<int>();
        for (int i = 0; i < 27; ++i) {
            const Eigen::Vector3i offset(i % 3 - 1, i / 3 % 3 - 1, i / 9 - 1);
            const auto found = bins_.find(key(centre + offset));
            if (found == bins_.end()) continue;
            for (const Vec3& other : found->second)
                if ((other - p).squaredNorm() < distance_ * distance_) return false;
        }
        bins_[key(centre)].push_back(p);
        return true;
    }

private:
    static u64 key(const Eigen::Vector3i& bin) {
        u64 packed = 0;
        for (int axis = 0; axis < 3; ++axis) packed = packed << 21 | static_cast<u64>(bin[axis] + (1 << 20));
        return packed;
    }
    double distance_;
    std::unordered_map<u64, std::vector<Vec3>> bins_;
};

}  // namespace

PointCloud fibonacci_sphere(std::size_t count, double jitter, std::uint64_t seed) {
    Random random(seed);
    Array<Vec3> positions(count);
    const double golden_angle = std::numbers::pi * (3 - std::sqrt(5.0));
    for (std::size_t i = 0; i < count; ++i) {
        const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(count);
        const double radius = std::sqrt(1 - z * z), angle = golden_angle * static_cast<double>(i);
        positions[i] = Vec3(radius * std::cos(angle), radius * std::sin(angle), z) + shake(random, jitter);
    }
    return cloud(std::move(positions));
}

PointCloud poisson_torus(double distance, double minor, std::size_t misses, std::uint64_t seed, std::size_t limit) {
    Random random(seed);
    Grid grid(distance);
    Array<Vec3> positions;
    for (std::size_t missed = 0; missed < misses && positions.size() < limit;) {
        const double around = random.uniform(0, 2 * std::numbers::pi), along = random.uniform(0, 2 * std::numbers::pi);
        const double axis_distance = 1 + minor * std::cos(along);
        // Area per angle grows with the distance from the axis.
        if (random.uniform(0, 1 + minor) > axis_distance) continue;
        const Vec3 p(axis_distance * std::cos(around), axis_distance * std::sin(around), minor * std::sin(along));
        if (grid.add(p)) {
            positions.push_back(p);
            missed = 0;
        } else {
            ++missed;
        }
    }
    return cloud(std::move(positions));
}

PointCloud lattice_cube(u32 n, double spacing, bool surface_only) {
    Array<Vec3> positions;
    const auto at_end = [&](u32 step) { return step == 0 || step == n; };
    for (u32 i = 0; i <= n; ++i)
        for (u32 j = 0; j <= n; ++j)
            for (u32 k = 0; k <= n; ++k)
                if (!surface_only || at_end(i) || at_end(j) || at_end(k)) positions.push_back(Vec3(i, j, k) * spacing);
    return cloud(std::move(positions));
}

PointCloud l_block_surface(u32 half_steps, double size, u32 height_steps, double jitter, std::uint64_t seed) {
    Random random(seed);
    const u32 n = 2 * half_steps;
    const double spacing = size / n;
    Array<Vec3> positions;
    for (u32 i = 0; i <= n; ++i)
        for (u32 j = 0; j <= n; ++j)
            for (u32 k = 0; k <= height_steps; ++k) {
                if (i > half_steps && j > half_steps) continue;
                const bool on_side = i == 0 || j == 0 || i == n || j == n || (i == half_steps && j >= half_steps) ||
                                     (j == half_steps && i >= half_steps);
                if (on_side || k == 0 || k == height_steps)
                    positions.push_back(Vec3(i, j, k) * spacing + shake(random, jitter));
            }
    return cloud(std::move(positions));
}

PointCloud shuffled(const PointCloud& source, std::uint64_t seed) {
    Random random(seed);
    std::vector<u32> rows(source.size());
    std::iota(rows.begin(), rows.end(), 0);
    for (std::size_t i = rows.size(); i > 1; --i) std::swap(rows[i - 1], rows[random.index(i)]);
    return gather(source, rows);
}

PointCloud joined(const PointCloud& a, const PointCloud& b) {
    Array<Vec3> positions(a.positions.begin(), a.positions.end());
    positions.insert(positions.end(), b.positions.begin(), b.positions.end());
    return cloud(std::move(positions));
}

PointCloud moved(const PointCloud& source, double factor, const Vec3& shift) {
    PointCloud result = source;
    Array<Vec3> positions(source.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = source.positions[i] * factor + shift;
    result.positions = std::move(positions);
    return result;
}

PointCloud rotated(const PointCloud& source, double angle) {
    PointCloud result = source;
    const Eigen::Matrix3d rotation = Eigen::AngleAxisd(angle, Vec3(1, 2, 3).normalized()).toRotationMatrix();
    Array<Vec3> positions(source.size());
    for (std::size_t i = 0; i < positions.size(); ++i) positions[i] = rotation * source.positions[i];
    result.positions = std::move(positions);
    return result;
}

}  // namespace scanmill::test
