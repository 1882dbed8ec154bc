// SPDX-License-Identifier: GPL-3.0-or-later
#include "plate_corners/plate_corners.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "plate_corners/rectangle.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/direction.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

using plate::Rectangle;
using plate::Vec2;

/// Probability that all trials miss a plane with a tenth of the points: (1 - 0.1³)^10000, about 1 in 20,000.
constexpr std::size_t plane_trials = 10000, plane_sample = 1000;
constexpr double least_share = 0.1;
/// Number of planes to try before the search fails.
constexpr int most_planes = 3;

struct Plane {
    Vec3 point, normal;

    double distance(const Vec3& p) const { return normal.dot(p - point); }
};

std::vector<u32> rows_near(const Plane& plane, std::span<const Vec3> positions, std::span<const u32> rows,
                           double tolerance) {
    std::vector<u32> near;
    for (const u32 row : rows)
        if (std::abs(plane.distance(positions[row])) <= tolerance) near.push_back(row);
    return near;
}

/// Among planes through three sampled points, returns the one with the most sampled points within `tolerance`; ties:
/// the first. Empty if the three points of every trial are collinear.
std::optional<Plane> sampled_plane(std::span<const Vec3> positions, std::span<const u32> rows, double tolerance,
                                   Random random, Context& context) {
    std::vector<Vec3> sample;
    for (std::size_t i = 0; i < std::min(plane_sample, rows.size()); ++i)
        sample.push_back(positions[rows.size() <= plane_sample ? rows[i] : rows[random.index(rows.size())]]);
    std::optional<Plane> best;
    std::size_t most = 0;
    for (std::size_t trial = 0; trial < plane_trials; ++trial) {
        if (trial % 1000 == 0) context.check_cancelled();
        const Vec3 &a = sample[random.index(sample.size())], &b = sample[random.index(sample.size())],
                   &c = sample[random.index(sample.size())];
        const Vec3 normal = area_vector(a, b, c);
        const double length = normal.norm();
        if (!(length > 0)) continue;
        const Plane plane{a, normal / length};
        const auto near = static_cast<std::size_t>(
            std::ranges::count_if(sample, [&](const Vec3& p) { return std::abs(plane.distance(p)) <= tolerance; }));
        if (near > most) {
            most = near;
            best = plane;
        }
    }
    return best;
}

struct FlatPoints {
    Plane plane;
    std::vector<u32> rows;
};

/// Fits the plane to the points near it by least squares, until the set of these points stays the same.
FlatPoints fitted(Plane plane, std::span<const Vec3> positions, std::span<const u32> rows, double tolerance) {
    constexpr int most_rounds = 20;
    std::vector<u32> near = rows_near(plane, positions, rows, tolerance);
    for (int round = 0; round < most_rounds; ++round) {
        std::vector<Vec3> points;
        for (const u32 row : near) points.push_back(positions[row] - plane.point);
        const Scatter scatter = scatter_of(points);
        plane = {plane.point + scatter.centroid, scatter.normal};
        std::vector<u32> next = rows_near(plane, positions, rows, tolerance);
        if (next == near || next.size() < 3) break;
        near = std::move(next);
    }
    return {plane, near};
}

FlatPoints largest_plane(std::span<const Vec3> positions, std::span<const u32> rows, double tolerance, Random random,
                         Context& context) {
    const std::optional<Plane> start = sampled_plane(positions, rows, tolerance, random, context);
    FlatPoints found;
    if (start) found = fitted(*start, positions, rows, tolerance);
    const auto least = static_cast<std::size_t>(std::ceil(least_share * static_cast<double>(positions.size())));
    if (found.rows.size() < std::max<std::size_t>(least, 4))
        throw Error("no plane: the best one has {} of {} within {:.4g} u of it; at least {} are needed",
                    found.rows.size(), count_text(positions.size(), "point", "points"), tolerance,
                    std::max<std::size_t>(least, 4))
            .hint("crop the scan to the plate, or give a larger `tolerance`");
    return found;
}

/// Orthonormal axes in a plane; x, y and the plane's normal are right-handed.
struct Axes {
    Vec3 origin, x, y;

    explicit Axes(const Plane& plane) : origin(plane.point) {
        x = perpendicular(plane.normal);
        y = plane.normal.cross(x);
    }
    Vec2 flat(const Vec3& p) const { return {x.dot(p - origin), y.dot(p - origin)}; }
    Vec3 space(const Vec2& p) const { return origin + p.x() * x + p.y() * y; }
};

// Checks of the parameters, and choice of the upper side.

double square(double x) { return x * x; }

double positive(const Length& length, std::string_view what) {
    const double value = length.value();
    if (!(value > 0) || !std::isfinite(value))
        throw Error("{} is {} u; it must be above 0", what, value).hint("give a finite length above 0");
    return value;
}

std::optional<std::array<double, 2>> sides_of(const PlateCornersParams& params) {
    if (!params.sides) return {};
    if (params.sides->size() != 2)
        throw Error("`sides` has {}; it needs 2", count_text(params.sides->size(), "length", "lengths"))
            .hint("give both sides of the rectangle, for example [200 mm, 120 mm]");
    return std::array{positive((*params.sides)[0], "a length of `sides`"),
                      positive((*params.sides)[1], "a length of `sides`")};
}

/// Mean of the finite normals at the rows, as a unit vector. Zero if there are none or they cancel out.
Vec3 mean_normal(const PointCloud& cloud, std::span<const u32> rows) {
    const Column* column = cloud.columns.find("normal");
    Vec3 sum = Vec3::Zero();
    if (!column || column->components() != 3) return sum;
    for (const u32 row : rows)
        if (const Vec3 normal(column->number(row, 0), column->number(row, 1), column->number(row, 2));
            normal.allFinite())
            sum += normal;
    return sum.norm() > 0 ? sum.normalized() : sum;
}

/// Turns the normal of the plane to its upper side. The normals of the points decide which side that is. Without them,
/// the direction `given` decides.
Plane with_upper_side(Plane plane, const PointCloud& cloud, std::span<const u32> rows, const Vec3& given) {
    const Vec3 by_normals = mean_normal(cloud, rows);
    const bool has_normals = by_normals != Vec3::Zero();
    const double cosine = plane.normal.dot(has_normals ? by_normals : given);
    constexpr double least = 0.5;
    if (!(std::abs(cosine) >= least)) {
        const double angle = angle_between(plane.normal, has_normals ? by_normals : given);
        throw Error("{} is {:.3g} deg off the normal of the plate; the upper side is undecided above 60 deg",
                    has_normals ? "the mean normal of the plate's points" : "`up`",
                    std::min(angle, std::numbers::pi - angle) * 180 / std::numbers::pi)
            .hint("give `up`, the direction in which the plate's upper side faces");
    }
    if (cosine < 0) plane.normal = -plane.normal;
    return plane;
}

PlateCornersResult corners_on(const FlatPoints& flat, const PointCloud& cloud, double tolerance, double spacing,
                              const std::optional<std::array<double, 2>>& sides, const Vec3& up, const Random& random) {
    const Plane plane = with_upper_side(flat.plane, cloud, flat.rows, up);
    const Axes axes(plane);
    PlateCornersResult result;
    std::vector<Vec2> points;
    for (const u32 row : flat.rows) {
        points.push_back(axes.flat(cloud.positions[row]));
        result.flatness += square(plane.distance(cloud.positions[row]));
    }
    result.flatness = std::sqrt(result.flatness / static_cast<double>(flat.rows.size()));
    result.points = flat.rows.size();
    points = plate::without_strays(points, std::max(4 * spacing, plate::extent_of(points) / 100));
    if (points.size() < 4)
        throw Error("the {} points of the plane are scattered: no group has 2 % of them", flat.rows.size())
            .hint("crop the scan to the plate");
    const Rectangle rectangle = plate::rectangle_of(points, spacing, tolerance, sides, random);

    std::array<Vec3, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = axes.space(rectangle.corners[i]);
    std::size_t first = 0;
    const auto rank = [&](std::size_t i) { return std::array{corners[i].sum(), corners[i].x(), corners[i].y()}; };
    for (std::size_t i = 1; i < 4; ++i)
        if (rank(i) < rank(first)) first = i;
    result.residual = rectangle.residual;
    result.first_side = first % 2 == 0 ? rectangle.first_side : rectangle.second_side;
    result.second_side = first % 2 == 0 ? rectangle.second_side : rectangle.first_side;
    Array<Vec3> positions;
    Array<double> normals;
    for (std::size_t i = 0; i < 4; ++i) {
        positions.push_back(corners[(first + i) % 4]);
        normals.insert(normals.end(), plane.normal.begin(), plane.normal.end());
    }
    result.corners.frame = cloud.frame;
    result.corners.positions = std::move(positions);
    result.corners.columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
    return result;
}

}  // namespace

PlateCornersResult plate_corners(const PointCloud& cloud, const PlateCornersParams& params, Context& context) {
    if (cloud.size() < 4)
        throw Error("the cloud has {}; a plate needs at least 4", count_text(cloud.size(), "point", "points"))
            .hint("wire a scan of the plate");
    require_finite(cloud.positions.span());
    const double tolerance = positive(params.tolerance, "`tolerance`");
    const std::optional<std::array<double, 2>> sides = sides_of(params);
    const Vec3 up = direction_of(params.up, "`up`");
    const double spacing = point_spacing(cloud.positions.span());
    context.progress(0.3);

    std::vector<u32> rows(cloud.size());
    std::iota(rows.begin(), rows.end(), u32(0));
    std::optional<Error> first_error;
    for (int number = 0; number < most_planes; ++number) {
        context.progress(0.3 + 0.2 * number);
        try {
            const Random random = context.random().stream(static_cast<u64>(number));
            const FlatPoints flat = largest_plane(cloud.positions.span(), rows, tolerance, random.stream(0), context);
            std::vector<u32> others;
            std::ranges::set_difference(rows, flat.rows, std::back_inserter(others));
            rows = std::move(others);
            const PlateCornersResult result = corners_on(flat, cloud, tolerance, spacing, sides, up, random.stream(1));
            context.metric("residual", result.residual, Unit::length);
            context.metric("flatness", result.flatness, Unit::length);
            context.metric("side-1", result.first_side, Unit::length);
            context.metric("side-2", result.second_side, Unit::length);
            context.metric("plane-points", static_cast<double>(result.points));
            context.progress(1);
            return result;
        } catch (const Error& error) {
            if (!first_error) first_error = error;
            if (rows.size() < 4) break;
        }
    }
    throw *first_error;
}

}  // namespace scanmill
