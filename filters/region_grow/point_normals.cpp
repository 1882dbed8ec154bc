// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/point_normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/filter/parallel.hpp"

namespace scanmill::growing {

namespace {

/// So few that at a border, where they lie on one side, they still are of the same sheet.
constexpr std::size_t counted_neighbours = 12;

/// A symmetric matrix: xx, yy, zz, xy, xz, yz.
struct Covariance {
    double xx = 0, yy = 0, zz = 0, xy = 0, xz = 0, yz = 0;
};

Covariance covariance(const Samples& samples, u32 place, std::span<const u32> neighbours) {
    const Vec3& centre = samples.positions[place];
    Vec3 mean = Vec3::Zero();
    Covariance sum;
    for (u32 other : neighbours) {
        const Vec3 d = samples.positions[other] - centre;
        mean += d;
        sum.xx += d.x() * d.x();
        sum.yy += d.y() * d.y();
        sum.zz += d.z() * d.z();
        sum.xy += d.x() * d.y();
        sum.xz += d.x() * d.z();
        sum.yz += d.y() * d.z();
    }
    const double count = static_cast<double>(neighbours.size() + 1);  // the place itself adds zeros
    mean /= count;
    return {sum.xx / count - mean.x() * mean.x(), sum.yy / count - mean.y() * mean.y(),
            sum.zz / count - mean.z() * mean.z(), sum.xy / count - mean.x() * mean.y(),
            sum.xz / count - mean.x() * mean.z(), sum.yz / count - mean.y() * mean.z()};
}

/// The least eigenvalue. Left of it the characteristic polynomial has one sign and bends one way, so Newton's steps
/// from 0 rise to it and never pass it.
double least_eigenvalue(const Covariance& c) {
    const double trace = c.xx + c.yy + c.zz;
    const double minors = c.xx * c.yy - c.xy * c.xy + (c.xx * c.zz - c.xz * c.xz) + (c.yy * c.zz - c.yz * c.yz);
    const double determinant =
        c.xx * (c.yy * c.zz - c.yz * c.yz) - c.xy * (c.xy * c.zz - c.yz * c.xz) + c.xz * (c.xy * c.yz - c.yy * c.xz);
    double value = 0;
    for (int step = 0; step < 30; ++step) {
        const double polynomial = ((trace - value) * value - minors) * value + determinant;
        const double slope = (2 * trace - 3 * value) * value - minors;
        if (!(slope < 0)) break;
        const double next = value - polynomial / slope;
        if (!(next > value + 1e-12 * trace)) break;
        value = next;
    }
    return value;
}

Vec3 any_across(const Vec3& line) {
    int axis = 0;
    line.cwiseAbs().minCoeff(&axis);
    const Vec3 across = line.cross(Vec3::Unit(axis));
    return across.squaredNorm() > 0 ? across.normalized() : Vec3::UnitZ();
}

}  // namespace

PointNormals principal_normals(const Samples& samples, const Neighbourhoods& neighbourhoods, unsigned threads) {
    PointNormals normals;
    normals.directions.resize(samples.size());
    normals.roughness.resize(samples.size());
    for_each_chunk(threads, samples.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t place = begin; place < end; ++place) {
            const auto near = neighbourhoods.of(static_cast<u32>(place));
            const auto neighbours = near.first(std::min(counted_neighbours, near.size()));
            Covariance c = covariance(samples, static_cast<u32>(place), neighbours);
            const double trace = c.xx + c.yy + c.zz;
            const double least = least_eigenvalue(c);
            // Two rows of the matrix less its eigenvalue span the plane across the eigenvector.
            const Vec3 x(c.xx - least, c.xy, c.xz), y(c.xy, c.yy - least, c.yz), z(c.xz, c.yz, c.zz - least);
            Vec3 best = x.cross(y);
            for (const Vec3& other : {Vec3(y.cross(z)), Vec3(z.cross(x))})
                if (other.squaredNorm() > best.squaredNorm()) best = other;
            const double length = best.norm();
            normals.directions[place] =
                length > 1e-12 * trace * trace
                    ? Vec3(best / length)
                    : any_across(samples.positions[neighbours.back()] - samples.positions[place]);
            normals.roughness[place] = static_cast<float>(trace > 0 ? least / trace : 0);
        }
    });
    return normals;
}

}  // namespace scanmill::growing
