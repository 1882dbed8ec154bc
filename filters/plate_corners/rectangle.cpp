// SPDX-License-Identifier: GPL-3.0-or-later
#include "plate_corners/rectangle.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <variant>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/cell_grid.hpp"

namespace scanmill::plate {

namespace {

/// A group of points belongs to the plate if it holds at least this share of the plane's points.
constexpr double least_group = 0.02;
/// Share of a side's length, at either end, that is ignored because corners are rounded or chamfered.
constexpr double end_share = 0.1;
/// The trials miss a line through half of the strips with a probability of at most about 10^-14. That is the worst
/// case, in which these strips are neighbours: about one trial in 16 then finds two points on the line far enough
/// apart.
constexpr std::size_t line_trials = 500;
constexpr double least_strips = 0.5;
constexpr double largest_skew_cosine = 0.0871557427476582;  // cosine of 85 degrees

double square(double x) { return x * x; }

double cross(const Vec2& a, const Vec2& b) { return a.x() * b.y() - a.y() * b.x(); }
/// Returns the direction turned clockwise by 90 degrees: outwards from a side of a counter-clockwise polygon.
Vec2 outwards(const Vec2& direction) { return {direction.y(), -direction.x()}; }

/// Returns the corners of the convex hull, counter-clockwise (Andrew 1979). Points on its edges are left out.
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

/// Corners of a rectangle, counter-clockwise.
using Corners = std::array<Vec2, 4>;

/// Returns the rectangle of smallest area around the hull. One of its sides lies on an edge of the hull (Freeman and
/// Shapira 1975); ties: the first such edge.
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

/// A side of the plate. `border` holds the border points that it was fitted to, moved outwards onto the border.
struct Side {
    Vec2 point, direction;
    std::vector<Vec2> border;
};

/// Reason why a side was not found: only `found` of its `strips` strips have their border point on a line.
struct NotASide {
    std::size_t found, strips;
};

/// Strips of equal width across a side of this length. `end_share` of the length at either end has no strips.
struct Strips {
    double length;
    std::size_t count;

    double width() const { return (1 - 2 * end_share) * length / static_cast<double>(count); }
    /// Index of the strip at a position along the side; `count` if no strip is there.
    std::size_t at(double along) const {
        const double strip = (along / length - end_share) / (1 - 2 * end_share);
        if (!(strip >= 0 && strip < 1)) return count;
        return std::min(count - 1, static_cast<std::size_t>(strip * static_cast<double>(count)));
    }
};

/// Returns the outermost point of every strip that has points. In `points` and the result, x runs along the side and y
/// outwards.
std::vector<Vec2> border_points(std::span<const Vec2> points, const Strips& strips) {
    std::vector<Vec2> outermost(strips.count, Vec2(0, -std::numeric_limits<double>::infinity()));
    for (const Vec2& p : points)
        if (const std::size_t strip = strips.at(p.x()); strip < strips.count && p.y() > outermost[strip].y())
            outermost[strip] = p;
    std::erase_if(outermost, [](const Vec2& p) { return std::isinf(p.y()); });
    return outermost;
}

/// The line y = offset + slope · x.
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

/// Distance from the line through the outermost points to the border. The number n(D) of points down to the depth D
/// below the line is the density times the sum of D and this distance. The density and the distance follow from two
/// integrals of n: over depths up to a strip's width, and from there to twice that width. Points outside all strips do
/// not count.
double border_beyond(const Line& line, std::span<const Vec2> points, const Strips& strips) {
    const double depth = strips.width();
    double upper = 0, lower = 0;
    for (const Vec2& p : points) {
        const double under = -line.distance(p);
        if (under < -depth || under >= 2 * depth || strips.at(p.x()) == strips.count) continue;
        upper += std::clamp(depth - under, 0.0, depth);
        lower += std::min(2 * depth - under, depth);
    }
    if (!(lower > upper)) return 0;  // the density changes with depth: a part, or a shadow
    return std::clamp(upper * depth / (lower - upper) - depth / 2, 0.0, depth);
}

/// Finds the side of the plate near the line from `a` to `b`, or returns why there is none.
std::variant<Side, NotASide> side_near(std::span<const Vec2> points, const Vec2& a, const Vec2& b, double spacing,
                                       double tolerance, Random random) {
    constexpr double most_strips = 200;
    constexpr std::size_t least_points = 5;
    const double length = (b - a).norm(), used = (1 - 2 * end_share) * length;
    const Strips strips{
        length, static_cast<std::size_t>(std::max(1.0, std::floor(used / std::max(2 * spacing, used / most_strips))))};
    const Vec2 along = (b - a) / length, out = outwards(along);
    std::vector<Vec2> turned;
    turned.reserve(points.size());
    for (const Vec2& p : points) turned.emplace_back(along.dot(p - a), out.dot(p - a));
    const std::vector<Vec2> border = border_points(turned, strips);
    const auto needed =
        std::max(least_points, static_cast<std::size_t>(std::ceil(least_strips * static_cast<double>(strips.count))));
    if (border.size() < needed) return NotASide{border.size(), strips.count};

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
    if (near.size() < needed) return NotASide{near.size(), strips.count};
    const double beyond = border_beyond(line, turned, strips);
    Side side{a + (line.offset + beyond) * out, (along + line.slope * out).normalized(), {}};
    for (const Vec2& p : near) side.border.push_back(a + p.x() * along + (p.y() + beyond) * out);
    return side;
}

Vec2 intersection(const Side& a, const Side& b) {
    return a.point + cross(b.point - a.point, b.direction) / cross(a.direction, b.direction) * a.direction;
}

/// Returns the corners of the rectangle with these side lengths that is nearest to the given corners, by least squares
/// about their centroid.
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

void require_right_angles(const std::array<Side, 4>& sides) {
    for (std::size_t i = 0; i < 4; ++i) {
        const Vec2 &one = sides[i].direction, &next = sides[(i + 1) % 4].direction;
        const double cosine = one.dot(next);
        if (!(std::abs(cosine) <= largest_skew_cosine))
            throw Error("two sides of the plane meet at {:.4g} deg; from 85 to 95 deg are needed",
                        angle_of(-cosine, std::abs(cross(one, next))) * 180 / std::numbers::pi)
                .hint("crop the scan to the plate");
    }
}

/// Returns the given lengths in the order that fits the found lengths better. Throws Error if a given length differs
/// from the found one by more than `most`.
std::array<double, 2> matched(std::array<double, 2> given, const Rectangle& found, double most) {
    const auto off = [&] {
        return std::max(std::abs(given[0] - found.first_side), std::abs(given[1] - found.second_side));
    };
    const double straight = off();
    std::swap(given[0], given[1]);
    if (straight <= off()) std::swap(given[0], given[1]);
    if (!(off() <= most))
        throw Error(
            "the sides of the plane are {:.6g} and {:.6g} u long, but {:.6g} and {:.6g} u are given; at most {:.3g} u "
            "of difference is accepted",
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

}  // namespace

double extent_of(std::span<const Vec2> points) {
    Vec2 low = points.front(), high = low;
    for (const Vec2& p : points) {
        low = low.cwiseMin(p);
        high = high.cwiseMax(p);
    }
    return (high - low).norm();
}

std::vector<Vec2> without_strays(std::span<const Vec2> points, double cell) {
    CellGrid grid(Vec3::Zero(), cell);
    std::vector<Vec3> cells;  // the first point of each cell
    std::vector<u32> cell_of;
    for (const Vec2& p : points) {
        const Vec3 point(p.x(), p.y(), 0);
        cell_of.push_back(grid.enter(point));
        if (cell_of.back() == cells.size()) cells.push_back(point);
    }
    DisjointSets sets(cells.size());
    for (u32 i = 0; i < cells.size(); ++i)
        grid.any_near(cells[i], [&](u32 other) { return sets.unite(i, other), false; });
    std::vector<std::size_t> size(cells.size());
    for (const u32 each : cell_of) ++size[sets.find(each)];
    std::vector<Vec2> kept;
    for (std::size_t i = 0; i < points.size(); ++i)
        if (static_cast<double>(size[sets.find(cell_of[i])]) >= least_group * static_cast<double>(points.size()))
            kept.push_back(points[i]);
    return kept;
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
            "{} of 4 sides of the plane {} straight within {:.4g} u: only {} lie on a line; half of a side's strips "
            "are needed",
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

}  // namespace scanmill::plate
