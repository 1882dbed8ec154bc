// SPDX-License-Identifier: GPL-3.0-or-later
#include "plate_corners/plate_corners.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <unordered_map>
#include <variant>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/spatial/spacing.hpp"

namespace scanmill {

namespace {

using Vec2 = Eigen::Vector2d;

/// A plane with a tenth of the points is missed once in 20,000 runs: (1 - 0.1³)^10000.
constexpr std::size_t plane_trials = 10000, plane_sample = 1000;
constexpr double least_share = 0.1;
/// Planes that are tried.
constexpr int most_planes = 3;
/// Of the plane's points, in a group that belongs to the plate.
constexpr double least_group = 0.02;
/// Of a side's length at either end, where corners are rounded or chamfered.
constexpr double end_share = 0.1;
/// A line with half of the strips is missed once in 10^62 runs.
constexpr std::size_t line_trials = 500;
constexpr double least_strips = 0.5;
constexpr double largest_skew_cosine = 0.0871557427476582;  // of 85 degrees

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

/// By samples of three points; of equally good planes the first. Nothing if all samples are on lines.
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
        const Vec3 normal = (b - a).cross(c - a);
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

/// Least squares on the points near the plane, until they stay the same.
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
        throw Error("no plane: the best one has {} of {} within {:.4g} u; at least {} are needed", found.rows.size(),
                    count_text(positions.size(), "point", "points"), tolerance, std::max<std::size_t>(least, 4))
            .hint("crop the scan to the plate, or give a larger `tolerance`");
    return found;
}

// In the plane.

/// Axes of a plane, right-handed with its normal.
struct Axes {
    Vec3 origin, x, y;

    explicit Axes(const Plane& plane) : origin(plane.point) {
        Eigen::Index axis = 0;
        plane.normal.cwiseAbs().minCoeff(&axis);
        x = plane.normal.cross(Vec3::Unit(axis)).normalized();
        y = plane.normal.cross(x);
    }
    Vec2 flat(const Vec3& p) const { return {x.dot(p - origin), y.dot(p - origin)}; }
    Vec3 space(const Vec2& p) const { return origin + p.x() * x + p.y() * y; }
};

double square(double x) { return x * x; }

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
/// By a right angle to the right: outwards of a side that is passed counter-clockwise.
Vec2 outwards(const Vec2& direction) { return {direction.y(), -direction.x()}; }

double extent_of(std::span<const Vec2> points) {
    Vec2 low = points.front(), high = low;
    for (const Vec2& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

/// Without small groups: points of cells that touch belong together.
std::vector<Vec2> without_strays(std::span<const Vec2> points, double cell) {
    std::unordered_map<u64, u32> number_of;
    std::vector<std::array<std::int32_t, 2>> cells;
    std::vector<u32> cell_of;
    const auto key = [](std::int32_t x, std::int32_t y) {
        return static_cast<u64>(static_cast<u32>(x)) << 32 | static_cast<u32>(y);
    };
    for (const Vec2& p : points) {
        const auto x = static_cast<std::int32_t>(std::floor(p.x() / cell)),
                   y = static_cast<std::int32_t>(std::floor(p.y() / cell));
        const auto [found, is_new] = number_of.emplace(key(x, y), static_cast<u32>(cells.size()));
        if (is_new) cells.push_back({x, y});
        cell_of.push_back(found->second);
    }
    DisjointSets sets(static_cast<u32>(cells.size()));
    for (u32 i = 0; i < cells.size(); ++i)
        for (int dx = -1; dx <= 1; ++dx)
            for (int dy = -1; dy <= 1; ++dy)
                if (const auto other = number_of.find(key(cells[i][0] + dx, cells[i][1] + dy));
                    other != number_of.end())
                    sets.unite(i, other->second);
    std::vector<std::size_t> size(cells.size());
    for (const u32 each : cell_of) ++size[sets.find(each)];
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (static_cast<double>(size[sets.find(cell_of[i])]) >= least_group * static_cast<double>(points.size()))
            kept.push_back(points[i]);
    return kept;
}

/// Counter-clockwise, without points on its edges (Andrew 1979).
std::vector<Vec2> convex_hull(std::vector<Vec2> points) {
    std::ranges::sort(points,
                      [](const Vec2& a, const Vec2& b) { return a.x() != b.x() ? a.x() < b.x() : a.y() < b.y(); });
    std::vector<Vec2> hull;
    const auto add = [&](const Vec2& p, std::size_t least) {
        while (hull.size() > least && cross(hull.back() - hull[hull.size() - 2], p - hull.back()) <= 0) hull.pop_back();
        hull.push_back(p);
    };
    for (const Vec2& p : points) add(p, 1);
    const std::size_t lower = hull.size();
    for (auto p = points.rbegin() + 1; p != points.rend(); ++p) add(*p, lower);
    hull.pop_back();
    return hull;
}

/// Counter-clockwise.
using Corners = std::array<Vec2, 4>;

/// One of its sides lies on an edge of the hull (Freeman and Shapira 1975); of equal ones the first.
Corners smallest_rectangle(std::span<const Vec2> hull) {
    Corners best;
    double least = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < hull.size(); ++i) {
        const Vec2 along = (hull[(i + 1) % hull.size()] - hull[i]).normalized(), across(-along.y(), along.x());
        Vec2 low = Vec2::Constant(std::numeric_limits<double>::infinity()), high = -low;
        for (const Vec2& p : hull) {
            const Vec2 turned(along.dot(p), across.dot(p));
            low = low.cwiseMin(turned);
            high = high.cwiseMax(turned);
        }
        const double area = (high.x() - low.x()) * (high.y() - low.y());
        if (!(area < least)) continue;
        least = area;
        const auto at = [&](double x, double y) -> Vec2 { return x * along + y * across; };
        best = {at(low.x(), low.y()), at(high.x(), low.y()), at(high.x(), high.y()), at(low.x(), high.y())};
    }
    return best;
}

/// A side of the plate, and the points at the border that it was fitted to.
struct Side {
    Vec2 point, direction;
    std::vector<Vec2> border;
};

/// How many strips a side has, and how many points near the line were needed.
struct NotASide {
    std::size_t found, strips;
};

/// The outermost point of every strip across the side from `a` to `b`. In coordinates along the side and outwards.
std::vector<Vec2> border_points(std::span<const Vec2> points, const Vec2& a, const Vec2& b, std::size_t strips) {
    const double length = (b - a).norm();
    const Vec2 along = (b - a) / length, out = outwards(along);
    std::vector<Vec2> outermost(strips, Vec2(0, -std::numeric_limits<double>::infinity()));
    for (const Vec2& p : points) {
        const double share = along.dot(p - a) / length, strip = (share - end_share) / (1 - 2 * end_share);
        if (!(strip >= 0 && strip < 1)) continue;
        Vec2& best = outermost[std::min(strips - 1, static_cast<std::size_t>(strip * static_cast<double>(strips)))];
        if (const double height = out.dot(p - a); height > best.y()) best = {share * length, height};
    }
    std::erase_if(outermost, [](const Vec2& p) { return std::isinf(p.y()); });
    return outermost;
}

/// height = offset + slope · position.
struct Line {
    double offset = 0, slope = 0;

    double distance(const Vec2& p) const { return p.y() - offset - slope * p.x(); }
};

std::vector<Vec2> near_line(const Line& line, std::span<const Vec2> points, double within) {
    std::vector<Vec2> near;
    for (const Vec2& p : points)
        if (std::abs(line.distance(p)) <= within) near.push_back(p);
    return near;
}

Line least_squares(std::span<const Vec2> points) {
    Vec2 mean = Vec2::Zero();
    for (const Vec2& p : points) mean += p;
    mean /= static_cast<double>(points.size());
    double xx = 0, xy = 0;
    for (const Vec2& p : points) {
        xx += (p.x() - mean.x()) * (p.x() - mean.x());
        xy += (p.x() - mean.x()) * (p.y() - mean.y());
    }
    const double slope = xx > 0 ? xy / xx : 0;
    return {mean.y() - slope * mean.x(), slope};
}

/// The side near that from `a` to `b`, or why there is none.
std::variant<Side, NotASide> side_near(std::span<const Vec2> points, const Vec2& a, const Vec2& b, double spacing,
                                       double tolerance, Random random) {
    constexpr double most_strips = 200;
    constexpr std::size_t least_points = 5;
    const double length = (b - a).norm(), used = (1 - 2 * end_share) * length;
    const auto strips =
        static_cast<std::size_t>(std::max(1.0, std::floor(used / std::max(2 * spacing, used / most_strips))));
    const std::vector<Vec2> border = border_points(points, a, b, strips);
    const auto needed =
        std::max(least_points, static_cast<std::size_t>(std::ceil(least_strips * static_cast<double>(strips))));
    if (border.size() < needed) return NotASide{border.size(), strips};

    const double within = tolerance + spacing;
    std::vector<Vec2> near;
    for (std::size_t trial = 0; trial < line_trials; ++trial) {
        const Vec2 &p = border[random.index(border.size())], &q = border[random.index(border.size())];
        if (!(std::abs(p.x() - q.x()) >= 0.2 * length)) continue;
        const double slope = (q.y() - p.y()) / (q.x() - p.x());
        if (std::vector<Vec2> found = near_line({p.y() - slope * p.x(), slope}, border, within);
            found.size() > near.size())
            near = std::move(found);
    }
    Line line;
    for (int round = 0; round < 10 && near.size() >= needed; ++round) {
        line = least_squares(near);
        std::vector<Vec2> next = near_line(line, border, within);
        if (next == near) break;
        near = std::move(next);
    }
    if (near.size() < needed) return NotASide{near.size(), strips};
    const Vec2 along = (b - a) / length, out = outwards(along);
    Side side{a + line.offset * out, (along + line.slope * out).normalized(), {}};
    for (const Vec2& p : near) side.border.push_back(a + p.x() * along + p.y() * out);
    return side;
}

Vec2 intersection(const Side& a, const Side& b) {
    return a.point + cross(b.point - a.point, b.direction) / cross(a.direction, b.direction) * a.direction;
}

/// By least squares about the centroid: the corners of the rectangle of these sides that are nearest to the given ones.
Corners of_size(const Corners& found, double first, double second) {
    const Corners ideal{Vec2(-first, -second) / 2, Vec2(first, -second) / 2, Vec2(first, second) / 2,
                        Vec2(-first, second) / 2};
    const Vec2 centre = (found[0] + found[1] + found[2] + found[3]) / 4;
    double cosine = 0, sine = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        cosine += ideal[i].dot(found[i] - centre);
        sine += cross(ideal[i], found[i] - centre);
    }
    const double length = std::sqrt(cosine * cosine + sine * sine);
    Corners result;
    for (std::size_t i = 0; i < 4; ++i)
        result[i] = centre + (cosine * ideal[i] + sine * Vec2(-ideal[i].y(), ideal[i].x())) / length;
    return result;
}

struct Rectangle {
    Corners corners;
    double residual = 0, first_side = 0, second_side = 0;
};

void require_right_angles(const std::array<Side, 4>& sides) {
    for (std::size_t i = 0; i < 4; ++i) {
        const double cosine = sides[i].direction.dot(sides[(i + 1) % 4].direction);
        if (!(std::abs(cosine) <= largest_skew_cosine))
            throw Error("two sides of the plane meet at {:.4g} deg; 90 deg within 5 deg are needed",
                        std::acos(std::clamp(-cosine, -1.0, 1.0)) * 180 / std::numbers::pi)
                .hint("crop the scan to the plate");
    }
}

/// The given lengths in the order of the found ones. Throws Error if they differ by more than `most`.
std::array<double, 2> matched(std::array<double, 2> given, const Rectangle& found, double most) {
    const auto off = [&] {
        return std::max(std::abs(given[0] - found.first_side), std::abs(given[1] - found.second_side));
    };
    const double straight = off();
    std::swap(given[0], given[1]);
    if (straight <= off()) std::swap(given[0], given[1]);
    if (!(off() <= most))
        throw Error(
            "the sides of the plane are {:.6g} and {:.6g} u long; {:.6g} and {:.6g} u are given, and at most "
            "{:.3g} u of difference is accepted",
            found.first_side, found.second_side, given[0], given[1], most)
            .hint("check `sides` and the unit of the scan, crop the scan to the plate, or give a larger `tolerance`");
    return given;
}

double residual_of(const Corners& corners, const std::array<Side, 4>& sides) {
    double sum = 0;
    std::size_t count = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec2 out = outwards((corners[(i + 1) % 4] - corners[i]).normalized());
        for (const Vec2& p : sides[i].border) sum += square(out.dot(p - corners[i]));
        count += sides[i].border.size();
    }
    return std::sqrt(sum / static_cast<double>(count));
}

Rectangle rectangle_of(std::span<const Vec2> points, double spacing, double tolerance,
                       const std::optional<std::array<double, 2>>& given, const Random& random) {
    const std::vector<Vec2> hull = convex_hull({points.begin(), points.end()});
    const Corners start = smallest_rectangle(hull);
    std::array<Side, 4> sides;
    std::vector<std::string> missing;
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec2 &a = start[i], &b = start[(i + 1) % 4];
        const auto found = side_near(points, a, b, spacing, tolerance, random.stream(i));
        if (const auto* side = std::get_if<Side>(&found))
            sides[i] = *side;
        else
            missing.push_back(fmt::format("{} of {} strips at the side of {:.4g} u", std::get<NotASide>(found).found,
                                          std::get<NotASide>(found).strips, (b - a).norm()));
    }
    if (!missing.empty())
        throw Error(
            "{} of 4 sides of the plane {} straight within {:.4g} u: only {} lie on a line; half of them are "
            "needed",
            missing.size(), by_count(missing.size(), "is not", "are not"), tolerance + spacing, enumerated(missing))
            .hint("crop the scan to a rectangular plate whose border was scanned, or give a larger `tolerance`");
    require_right_angles(sides);

    Rectangle result;
    for (std::size_t i = 0; i < 4; ++i) result.corners[i] = intersection(sides[(i + 3) % 4], sides[i]);
    const auto length = [&](std::size_t i) { return (result.corners[(i + 1) % 4] - result.corners[i]).norm(); };
    result.first_side = (length(0) + length(2)) / 2;
    result.second_side = (length(1) + length(3)) / 2;
    if (given) {
        const std::array<double, 2> lengths = matched(*given, result, 2 * (tolerance + spacing));
        result.corners = of_size(result.corners, lengths[0], lengths[1]);
    }
    result.residual = residual_of(result.corners, sides);
    return result;
}

// Refusals, and the upper side.

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
            .hint("give both sides of the rectangle, as [200 mm, 120 mm]");
    return std::array{positive((*params.sides)[0], "a length of `sides`"),
                      positive((*params.sides)[1], "a length of `sides`")};
}

Vec3 direction_of(std::span<const double> up) {
    if (up.size() != 3)
        throw Error("`up` has {}; it needs 3", count_text(up.size(), "number", "numbers")).hint("give x, y, z");
    const Vec3 direction(up[0], up[1], up[2]);
    if (!direction.allFinite() || !(direction.norm() > 0))
        throw Error("`up` is ({}, {}, {}); it must have a length", up[0], up[1], up[2])
            .hint("give a direction, as 0, 0, 1");
    return direction.normalized();
}

/// Sum of the normals at the rows; zero without a column of normals.
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

/// The plane with its normal on the upper side.
Plane with_upper_side(Plane plane, const PointCloud& cloud, std::span<const u32> rows, const Vec3& given) {
    const Vec3 by_normals = mean_normal(cloud, rows);
    const bool has_normals = by_normals != Vec3::Zero();
    const double cosine = plane.normal.dot(has_normals ? by_normals : given);
    constexpr double least = 0.5;
    if (!(std::abs(cosine) >= least))
        throw Error("{} is {:.3g} deg off the normal of the plate; at most 60 deg decide which side is up",
                    has_normals ? "the mean normal of the plate's points" : "`up`",
                    std::acos(std::min(1.0, std::abs(cosine))) * 180 / std::numbers::pi)
            .hint("give `up`, a direction that points away from the plate's upper side");
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
    points = without_strays(points, std::max(4 * spacing, extent_of(points) / 100));
    if (points.size() < 4)
        throw Error("the {} points of the plane are scattered: no group has {} % of them", flat.rows.size(),
                    100 * least_group)
            .hint("crop the scan to the plate");
    const Rectangle rectangle = rectangle_of(points, spacing, tolerance, sides, random);

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
    const Vec3 up = direction_of(params.up);
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
