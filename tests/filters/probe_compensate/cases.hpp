// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Touches of a straight edge along y with its normal n0 = z, for tests of probe-compensate.

#include <Eigen/Geometry>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "probe_compensate/probe_compensate.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::test {

inline constexpr double degree = std::numbers::pi / 180;

struct Touch {
    Vec3 position, approach;
    double touch = 0, feature = 0, uncertainty = 0;
};

/// The approach at the angle phi from z, in the plane across y.
inline Vec3 approach_at(double phi) { return {-std::sin(phi), 0, std::cos(phi)}; }

/// The touch of the edge at `edge` by a ball of radius r whose reference point is d off the edge across the approach,
/// as a machine reports it that compensates along the approach.
inline Touch touch_of(const Vec3& edge, double phi, double d, double r, double number = 0, double feature = 0) {
    const Vec3 u = approach_at(phi), across = Vec3::UnitY().cross(u);
    return {edge + (std::sqrt(r * r - d * d) - r) * u + d * across, u, number, feature, 0};
}

enum class Columns { all, approach_only, without_feature };

inline PointCloud cloud_of(const std::vector<Touch>& touches, Columns which = Columns::all) {
    Array<Vec3> positions;
    Array<double> approach, touch, feature, uncertainty;
    for (const Touch& row : touches) {
        positions.push_back(row.position);
        approach.insert(approach.end(), row.approach.begin(), row.approach.end());
        touch.push_back(row.touch);
        feature.push_back(row.feature);
        uncertainty.push_back(row.uncertainty);
    }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    cloud.columns.add(Column("approach", 3, Buffer<double>(std::move(approach))));
    if (which == Columns::approach_only) return cloud;
    cloud.columns.add(Column("touch", 1, Buffer<double>(std::move(touch))));
    cloud.columns.add(Column("uncertainty", 1, Buffer<double>(std::move(uncertainty))).with_length_exponent(1));
    if (which == Columns::all) cloud.columns.add(Column("feature", 1, Buffer<double>(std::move(feature))));
    return cloud;
}

inline ProbeCompensateParams with_radius(double radius, double scanner_error = 0) {
    ProbeCompensateParams params;
    params.radius = radius;
    params.scanner_error = scanner_error;
    return params;
}

struct Compensated : ProbeCompensateResult {
    Metrics metrics;
    std::vector<std::string> warnings;
    std::vector<Doubt> doubts;

    double number(const char* column, std::size_t row, u32 component = 0) const {
        return points.columns.find(column)->number(row, component);
    }
    Vec3 approach(std::size_t row) const {
        return {number("approach", row, 0), number("approach", row, 1), number("approach", row, 2)};
    }
};

inline Compensated compensated(const PointCloud& cloud, const ProbeCompensateParams& params) {
    Context context;
    ProbeCompensateResult result = probe_compensate(cloud, params, context);
    return {std::move(result), context.metrics(), context.warnings(), context.doubts()};
}
inline Compensated compensated(const std::vector<Touch>& touches, const ProbeCompensateParams& params) {
    return compensated(cloud_of(touches), params);
}

}  // namespace scanmill::test
