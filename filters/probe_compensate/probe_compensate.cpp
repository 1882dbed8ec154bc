// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_compensate/probe_compensate.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <numeric>

#include "probe_compensate/arcs.hpp"
#include "probe_compensate/edge_point.hpp"
#include "probe_compensate/touched_lines.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill {

namespace {

using compensating::BallPair;
using compensating::EdgePoint;
using Reported = ProbeCompensateParams::Reported;

constexpr double degree = std::numbers::pi / 180;

/// Approaches of a pair are at least so far apart, and so far from opposite. At 10 degrees the pair's error is 8 times
/// the machine's.
constexpr double least_angle = 10 * degree;
/// Tolerance of angles, so that rounding does not decide about approaches at the limit.
constexpr double rounding = 1e-9;

/// The angle between contact normals is 1 - t/r to 1 + t/r times that of the approaches if the reference point is t
/// off the edge, 0 to t/r times if contacts are taken for centres, and about 2 times if centres for contacts.
constexpr double least_ratio = 0.5, most_ratio = 1.5;

constexpr std::string_view check_ball = "check `radius` (not the diameter) and `reported`: contact or centre";

// The input.

struct Touches {
    std::vector<Vec3> centres, approaches;  ///< O and u
    std::vector<double> sigma;
    /// Empty if the input has no such column.
    std::vector<double> touch, feature;
};

double length_of(const Length& length, std::string_view name) {
    const double value = length.value();
    if (!(value >= 0) || !std::isfinite(value))
        throw Error("{} is {} u; it must be 0 or more", name, number_text(value)).hint("give a finite length");
    return value;
}

double positive_length_of(const Length& length, std::string_view name, std::string_view hint) {
    const double value = length.value();
    if (!(value > 0) || !std::isfinite(value))
        throw Error("{} is {} u; it must be above 0", name, number_text(value)).hint(std::string(hint));
    return value;
}

/// The numbers of a column with one number per row; empty without the column.
std::vector<double> numbers_of(const ColumnTable& columns, std::string_view name) {
    std::vector<double> numbers;
    const Column* column = columns.find(name);
    if (!column) return numbers;
    if (column->components() != 1)
        throw Error("the column '{}' has {} per point; one is needed", name,
                    column->is_list() ? "a list" : fmt::format("{} numbers", column->components()))
            .hint("rename the column, or remove it from the file");
    for (std::size_t row = 0; row < column->rows(); ++row) {
        numbers.push_back(column->number(row));
        if (!std::isfinite(numbers.back()))
            throw Error("the column '{}' has {} in row {}; a number is needed", name, number_text(numbers.back()), row)
                .hint("pass measured touches alone to this filter, and `merge` its points with others afterwards");
    }
    return numbers;
}

std::vector<Vec3> approaches_of(const ColumnTable& columns) {
    constexpr double most = 1e-4;  // allows for the rounding of numbers in files
    constexpr std::string_view needed = "the unit vector from the part to the probe: i, j, k of the measurement";
    const Column* column = columns.find("approach");
    if (!column || column->components() != 3)
        throw Error("the touches have no column 'approach' with three numbers per point")
            .hint(fmt::format("the column holds {}", needed));
    std::vector<Vec3> approaches(column->rows());
    for (std::size_t row = 0; row < approaches.size(); ++row) {
        Vec3& u = approaches[row];
        u = {column->number(row, 0), column->number(row, 1), column->number(row, 2)};
        const double length = u.norm();
        if (!(std::abs(length - 1) <= most))
            throw Error("the approach in row {} has the length {:.6g}; a unit vector is needed", row, length)
                .hint(fmt::format("the column `approach` holds {}", needed));
        u /= length;
    }
    return approaches;
}

Touches touches_of(const PointCloud& cloud, double radius, double noise, Reported reported) {
    Touches touches;
    touches.approaches = approaches_of(cloud.columns);
    touches.sigma = numbers_of(cloud.columns, "uncertainty");
    touches.touch = numbers_of(cloud.columns, "touch");
    touches.feature = numbers_of(cloud.columns, "feature");
    for (std::size_t row = 0; row < touches.sigma.size(); ++row)
        if (touches.sigma[row] < 0)
            throw Error("the uncertainty in row {} is {}; it must be 0 or more", row, number_text(touches.sigma[row]))
                .hint("write the machine's standard deviation per coordinate, or remove the column");
    touches.sigma.resize(cloud.size(), noise);
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        touches.centres.push_back(cloud.positions[row]);
        if (reported == Reported::contact) touches.centres.back() += radius * touches.approaches[row];
    }
    return touches;
}

// Points.

/// Returns the rows of every touch, ascending; touches are in the order of their first rows. Without the column
/// `touch`, every row is a touch.
std::vector<std::vector<u32>> grouped(const Touches& touches) {
    std::vector<u32> rows(touches.centres.size());
    std::iota(rows.begin(), rows.end(), 0u);
    const auto same_touch = [&](u32 a, u32 b) {
        return !touches.touch.empty() && touches.touch[a] == touches.touch[b];
    };
    if (!touches.touch.empty()) std::ranges::stable_sort(rows, {}, [&](u32 row) { return touches.touch[row]; });
    std::vector<std::vector<u32>> groups;
    for (const u32 row : rows) {
        if (groups.empty() || !same_touch(groups.back().front(), row)) groups.emplace_back();
        groups.back().push_back(row);
    }
    std::ranges::sort(groups, {}, [](const std::vector<u32>& group) { return group.front(); });
    return groups;
}

void require_one_feature(const Touches& touches, std::span<const u32> rows) {
    if (touches.feature.empty()) return;
    for (const u32 row : rows)
        if (touches.feature[row] != touches.feature[rows.front()])
            throw Error("touch {} is of feature {} in row {} and of feature {} in row {}; a touch is of one edge",
                        number_text(touches.touch[row]), number_text(touches.feature[rows.front()]), rows.front(),
                        number_text(touches.feature[row]), row)
                .hint("number the touches of two plans differently before you put them into one file");
}

/// Returns the two rows whose approaches are farthest apart; empty if that is less than least_angle.
std::optional<std::array<u32, 2>> pair_among(const Touches& touches, std::span<const u32> rows, Context& context) {
    std::array<u32, 2> pair{};
    double least_cosine = 2;
    for (std::size_t i = 0; i < rows.size(); ++i) {
        if (i > 0) context.check_cancelled();
        for (std::size_t j = i + 1; j < rows.size(); ++j) {
            const double cosine = touches.approaches[rows[i]].dot(touches.approaches[rows[j]]);
            if (cosine >= least_cosine) continue;
            least_cosine = cosine;
            pair = {rows[i], rows[j]};
        }
    }
    if (rows.size() < 2 ||
        angle_between(touches.approaches[pair[0]], touches.approaches[pair[1]]) < least_angle - rounding)
        return {};
    return pair;
}

void require_meeting(const Touches& touches, const std::array<u32, 2>& pair, double radius) {
    const auto [first, second] = pair;
    const double approaches = angle_between(touches.approaches[first], touches.approaches[second]);
    if (approaches > std::numbers::pi - least_angle)
        throw Error(
            "the approaches in rows {} and {}, of one touch, are {:.4g} deg apart; no edge is touched from "
            "opposite directions",
            first, second, approaches / degree)
            .hint("the column `approach` points from the part to the probe, in all rows");
    const double apart = (touches.centres[second] - touches.centres[first]).norm();
    if (apart > 2 * radius)
        throw Error(
            "the balls in rows {} and {}, of one touch, do not meet: their centres are {:.6g} u apart, {:.4g} "
            "u more than the diameter of {} u",
            first, second, apart, apart - 2 * radius, number_text(2 * radius))
            .hint(fmt::format("{}; equal numbers in `touch` are of one point of an edge", check_ball));
}

/// Pre: require_meeting().
BallPair balls_of(const Touches& touches, const std::array<u32, 2>& pair) {
    const Vec3 &u1 = touches.approaches[pair[0]], &u2 = touches.approaches[pair[1]];
    return {touches.centres[pair[0]], touches.centres[pair[1]], u1.cross(u2).normalized(), (u1 + u2).normalized()};
}

EdgePoint paired_point(const BallPair& balls, const std::array<u32, 2>& pair, double radius) {
    if (const auto point = compensating::edge_point(balls, radius)) return *point;
    const Vec3 apart = balls.second - balls.first;
    throw Error(
        "the circles round the centres in rows {} and {}, of one touch, fix no point: the centres are {:.4g} u "
        "apart across the edge, the radius is {} u",
        pair[0], pair[1], (apart - balls.tangent.dot(apart) * balls.tangent).norm(), number_text(radius))
        .hint(std::string(check_ball));
}

/// A point that is made of two touches or of one.
struct Made {
    std::array<u32, 2> rows;
    EdgePoint point;
    std::optional<BallPair> balls;  ///< empty for one touch
};

double uncertainty_of(const Made& made, const Touches& touches, double scanner_error) {
    const double first = touches.sigma[made.rows[0]], second = made.balls ? touches.sigma[made.rows[1]] : scanner_error;
    return std::sqrt(first * first + second * second) / (made.balls ? made.point.sine : 1);
}

/// Makes the points of all touches, in the order of the touches' first rows.
std::vector<Made> points_of(const Touches& touches, double radius, std::vector<std::size_t>& first_of_touch,
                            ProbeCompensateResult& result, Context& context) {
    std::vector<Made> made;
    const std::vector<std::vector<u32>> groups = grouped(touches);
    for (std::size_t i = 0; i < groups.size(); ++i) {
        constexpr std::size_t often = 4096;
        if (i % often == 0) {
            context.check_cancelled();
            context.progress(static_cast<double>(i) / static_cast<double>(groups.size()));
        }
        const std::vector<u32>& rows = groups[i];
        require_one_feature(touches, rows);
        first_of_touch.push_back(made.size());
        if (const auto pair = pair_among(touches, rows, context)) {
            require_meeting(touches, *pair, radius);
            const BallPair balls = balls_of(touches, *pair);
            made.push_back({*pair, paired_point(balls, *pair, radius), balls});
            result.unused += rows.size() - 2;
            ++result.paired;
            continue;
        }
        for (const u32 row : rows) {
            const Vec3 position = touches.centres[row] - radius * touches.approaches[row];
            made.push_back({{row, ProbeCompensateResult::no_row}, {position, 1, Vec3::Zero(), Vec3::Zero()}, {}});
        }
        result.single += rows.size();
    }
    return made;
}

/// Corrects the points on curved edges. `points`: for each vertex of the lines, its touch.
void correct(std::vector<Made>& made, std::span<const std::size_t> first_of_touch, std::span<const std::size_t> points,
             double radius, ProbeCompensateResult& result) {
    Array<Vec3> positions(result.features.positions.size());
    for (const FeaturePolyline& line : result.features.polylines) {
        std::vector<compensating::LinePosition> sequence;
        for (u32 i = line.begin; i < line.end; ++i) {
            Made& point = made[first_of_touch[points[i]]];
            sequence.push_back({point.balls ? &*point.balls : nullptr, &point.point});
        }
        result.curved += compensating::correct_curved(sequence, line.closed, radius);
        for (u32 i = line.begin; i < line.end; ++i) positions[i] = sequence[i - line.begin].point->position;
    }
    result.features.positions = std::move(positions);
}

/// The median distance of consecutive points.
double median_chord(const FeatureGraph& lines) {
    std::vector<double> chords;
    for (const FeaturePolyline& line : lines.polylines)
        for (u32 i = line.begin; i + 1 < line.end; ++i)
            chords.push_back((lines.positions[lines.vertices[i + 1]] - lines.positions[lines.vertices[i]]).norm());
    return median(chords);
}

/// Joins the points to lines.
void join(std::vector<Made>& made, const Touches& touches, std::span<const std::size_t> first_of_touch, double radius,
          const ProbeCompensateParams& params, ProbeCompensateResult& result) {
    std::vector<compensating::LinePoint> points;
    if (!touches.feature.empty())
        for (const std::size_t i : first_of_touch)
            points.push_back({made[i].point.position, touches.feature[made[i].rows[0]], made[i].balls.has_value()});
    std::optional<double> spacing;
    if (params.spacing) spacing = params.spacing->value();
    compensating::TouchedLines lines = compensating::touched_lines(result.points.frame, points, spacing);
    result.lone = lines.lone;
    result.repeated = lines.repeated;
    result.features = std::move(lines.graph);
    if (params.tangent == ProbeCompensateParams::Tangent::line)
        correct(made, first_of_touch, lines.points, radius, result);
    if (result.features.polylines.empty()) return;
    std::vector<bool> is_exact(result.features.positions.size());
    for (std::size_t i = 0; i < is_exact.size(); ++i)
        is_exact[i] = made[first_of_touch[lines.points[i]]].balls.has_value();
    const double chord_error = params.chord_error ? params.chord_error->value() : 0.005 * median_chord(result.features);
    result.features = compensating::along_arcs(result.features, is_exact, chord_error);
}

void doubt_ratios(std::span<const Made> made, const Touches& touches, Context& context) {
    std::vector<double> ratios;
    for (const Made& point : made)
        if (point.balls)
            ratios.push_back(angle_between(point.point.first_normal, point.point.second_normal) /
                             angle_between(touches.approaches[point.rows[0]], touches.approaches[point.rows[1]]));
    if (ratios.empty()) return;
    const std::size_t pairs = ratios.size();
    const double ratio = median(ratios);
    if (ratio < least_ratio || ratio > most_ratio)
        context.doubt(
            fmt::format("the contact normals of the median pair are {:.2f} times as far apart as its "
                        "approaches, of {} pairs: {}",
                        ratio, pairs, check_ball));
}

void warn_of_other_columns(const ColumnTable& columns, Context& context) {
    ColumnTable others;
    for (const Column& column : columns)
        if (column.name() != "approach" && column.name() != "touch" && column.name() != "feature" &&
            column.name() != "uncertainty")
            others.add(column);
    warn_of_dropped(others, "point columns", "the points are new", context);
}

void report(const ProbeCompensateResult& result, Context& context) {
    const auto metric = [&](std::string_view name, std::size_t count) {
        context.metric(name, static_cast<double>(count));
    };
    metric("points", result.points.size());
    metric("paired", result.paired);
    metric("single", result.single);
    metric("unused", result.unused);
    metric("curved", result.curved);
    metric("lines", result.features.polylines.size());
    metric("lone", result.lone);
    metric("repeated", result.repeated);
}

}  // namespace

ProbeCompensateResult probe_compensate(const PointCloud& cloud, const ProbeCompensateParams& params, Context& context) {
    const double radius = positive_length_of(params.radius, "radius", "give the radius of the probe's ball");
    const double scanner_error = length_of(params.scanner_error, "scanner-error");
    const double noise = length_of(params.noise, "noise");
    if (params.spacing) positive_length_of(*params.spacing, "spacing", "give the distance of touches, or `auto`");
    if (params.chord_error)
        positive_length_of(*params.chord_error, "chord-error",
                           "give a length, or `auto`; a long one keeps straight lines");
    require_points(cloud, "compensation needs at least 1");
    const Touches touches = touches_of(cloud, radius, noise, params.reported);

    ProbeCompensateResult result;
    result.points.frame = cloud.frame;
    std::vector<std::size_t> first_of_touch;
    std::vector<Made> made = points_of(touches, radius, first_of_touch, result, context);
    join(made, touches, first_of_touch, radius, params, result);

    Array<Vec3> positions;
    Array<double> approach, uncertainty;
    Array<u32> first_rows;
    for (const Made& point : made) {
        const Vec3& u = point.balls ? point.balls->approach : touches.approaches[point.rows[0]];
        positions.push_back(point.point.position);
        approach.insert(approach.end(), u.begin(), u.end());
        uncertainty.push_back(uncertainty_of(point, touches, scanner_error));
        first_rows.push_back(point.rows[0]);
        result.rows.push_back(point.rows);
    }
    result.points.positions = std::move(positions);
    ColumnTable& columns = result.points.columns;
    for (const char* name : {"touch", "feature"})
        if (const Column* column = cloud.columns.find(name)) columns.add(column->gather(first_rows));
    columns.add(Column("approach", 3, Buffer<double>(std::move(approach))));
    columns.add(Column("uncertainty", 1, Buffer<double>(std::move(uncertainty))).with_length_exponent(1));
    warn_of_other_columns(cloud.columns, context);
    doubt_ratios(made, touches, context);
    report(result, context);
    context.progress(1);
    return result;
}

PointCloud with_features(const PointCloud& touches, const ProbePlan& plan) {
    if (touches.columns.find("feature")) return touches;
    const Column* numbers = touches.columns.find("touch");
    if (!numbers || numbers->components() != 1)
        throw Error("the plan cannot name the lines: the touches have no column 'touch' with one number per row")
            .hint("give the number of the reference point in a column 'touch', or no plan");
    std::map<double, u32> feature_of;
    for (const ProbeTouch& touch : plan.touches) feature_of.emplace(touch.touch, touch.feature);
    Array<u32> features;
    for (std::size_t row = 0; row < touches.size(); ++row) {
        const auto found = feature_of.find(numbers->number(row));
        if (found == feature_of.end())
            throw Error("row {} is of touch {}, which is not in the plan of {} touches", row, numbers->number(row),
                        plan.touches.size())
                .hint("give the plan that the machine has measured");
        features.push_back(found->second);
    }
    PointCloud result = touches;
    result.columns.add(Column("feature", 1, Buffer<u32>(std::move(features))));
    return result;
}

}  // namespace scanmill
