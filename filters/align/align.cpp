// SPDX-License-Identifier: GPL-3.0-or-later
#include "align/align.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/registration/rigid_motion.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/direction.hpp"

namespace scanmill {

namespace {

using Matrix3 = Eigen::Matrix3d;
using Points = std::vector<Vec3>;

/// Largest accepted standard error of the rotation about any axis. It refuses at least 99.9 % of 10,000 trials with
/// three points on a line of length 200 and noise from 0.001 to 1, and as many with four points. Noise of 1 on the
/// corners of a plate of 200 x 120 gives 0.5 degrees.
constexpr double largest_angle = std::numbers::pi / 180;
/// Residuals below this share of the points' extent are rounding.
constexpr double rounding = 1e-12;
/// A scale closer to 1 than this does not indicate a wrong unit, because scanners are calibrated less precisely.
constexpr double least_scale = 1e-4;
/// A fit is clearly better than another one if its residuals are smaller by this factor.
constexpr double clear = 10;
/// A scale explains the residuals if it leaves less than this share of them. With pure noise this happens in 0.15 % of
/// 20,000 trials for the corners of a plate. For three pairs, which need the smaller share, it happens in 0.5 %.
constexpr double left_by_scale = 1.0 / 3, left_by_scale_of_three = 0.1;
/// Number of residuals that are reported one by one.
constexpr std::size_t most_residuals = 100;

Vec3 mean_of(const Points& points) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& p : points) sum += p;
    return sum / static_cast<double>(points.size());
}

Points about(const Points& points, const Vec3& centre) {
    Points result(points);
    for (Vec3& p : result) p -= centre;
    return result;
}

/// Pairs relative to their centroids, and the rotation between them.
struct Fit {
    Vec3 source_mean, target_mean;
    Points source, target;
    Matrix3 rotation;
    double scale = 1;
    /// Sums of the residuals' squared lengths after the rotation, after the best reflection, and after the rotation
    /// with the best scale.
    double squares = 0, mirrored_squares = 0, scaled_squares = 0;

    Vec3 residual(std::size_t row) const { return target[row] - rotation * source[row]; }
};

double squares_of(const Fit& fit, const Matrix3& map) {
    double sum = 0;
    for (std::size_t row = 0; row < fit.source.size(); ++row)
        sum += (fit.target[row] - map * fit.source[row]).squaredNorm();
    return sum;
}

Fit fit_of(const Points& source, const Points& target) {
    const PairsFit pairs = pairs_fit(source, target);
    Fit fit{pairs.from_mean,  pairs.to_mean, about(source, pairs.from_mean), about(target, pairs.to_mean),
            pairs.rotation(), pairs.scale()};
    fit.squares = squares_of(fit, fit.rotation);
    fit.mirrored_squares = squares_of(fit, pairs.reflection());
    fit.scaled_squares = squares_of(fit, fit.scale * fit.rotation);
    return fit;
}

double root_mean_square(double squares, std::size_t points) { return std::sqrt(squares / static_cast<double>(points)); }

/// sigma in the documentation of align().
double noise_of(const Fit& fit) { return std::sqrt(fit.squares / static_cast<double>(3 * fit.source.size() - 6)); }

Matrix3 cross_matrix(const Vec3& v) {
    Matrix3 matrix;
    matrix << 0, -v.z(), v.y(), v.z(), 0, -v.x(), -v.y(), v.x(), 0;
    return matrix;
}

/// J in the documentation of align().
Matrix3 inertia_of(const Points& centred) {
    Matrix3 inertia = Matrix3::Zero();
    for (const Vec3& c : centred) inertia += c.squaredNorm() * Matrix3::Identity() - c * c.transpose();
    return inertia;
}

/// Root of the sum of the squared distances from the line that fits the points best. It equals the root of the smallest
/// moment of inertia.
double spread_about_line(const Points& centred) {
    Matrix3 scatter = Matrix3::Zero();
    for (const Vec3& c : centred) scatter += c * c.transpose();
    const Vec3 line = Eigen::JacobiSVD<Matrix3>(scatter, Eigen::ComputeFullU).matrixU().col(0);
    // Sums the distances, because roots of the moments lose half of the digits.
    double sum = 0;
    for (const Vec3& c : centred) sum += (c - c.dot(line) * line).squaredNorm();
    return std::sqrt(sum);
}

double extent_of(const Points& centred) {
    double largest = 0;
    for (const Vec3& c : centred) largest = std::max(largest, c.norm());
    return largest;
}

/// Whether the residuals are more than rounding, and the best scale explains them.
bool is_scaled(const Fit& fit) {
    if (std::abs(fit.scale - 1) <= least_scale) return false;
    const std::size_t pairs = fit.source.size();
    const double rms = root_mean_square(fit.squares, pairs), left = root_mean_square(fit.scaled_squares, pairs);
    return rms > rounding * std::max(extent_of(fit.source), extent_of(fit.target)) &&
           left < (pairs == 3 ? left_by_scale_of_three : left_by_scale) * rms;
}

std::string scale_text(const Fit& fit, std::string_view unit) {
    return fmt::format(
        "the target is {:.6g} times as large as the source: the residuals are {:.4g} {} RMS, and {:.4g} {} with this "
        "scale",
        fit.scale, root_mean_square(fit.squares, fit.source.size()), unit,
        root_mean_square(fit.scaled_squares, fit.source.size()), unit);
}

// Refusals.

void require_cloud(const PointCloud& cloud, std::string_view port) {
    try {
        require_finite(cloud.positions.span());
    } catch (Error& error) {
        error.add_frame(fmt::format("at '{}'", port));
        if (error.hint().empty()) error.set_hint("remove these points from the file");
        throw;
    }
}

void require_pairs(const PointCloud& source, const PointCloud& target) {
    if (source.size() != target.size())
        throw Error("the source has {} and the target {}; each point needs a partner",
                    count_text(source.size(), "point", "points"), count_text(target.size(), "point", "points"))
            .hint(
                "write corresponding points in the same row of both files; `plate-corners` finds the four corners of "
                "a plate in a scan");
    if (source.size() < 3)
        throw Error("there {} {}; a motion needs at least 3 that are not on a line",
                    by_count(source.size(), "is", "are"),
                    count_text(source.size(), "pair of points", "pairs of points"))
            .hint("add corresponding points");
    require_cloud(source, "source");
    require_cloud(target, "target");
    Frame named_alike = target.frame;  // the two frames usually have different names
    named_alike.name = source.frame.name;
    require_same_frame(source.frame, "the source is", named_alike, "the target");
}

void require_not_mirrored(const Fit& fit, std::string_view unit) {
    const double rotated = root_mean_square(fit.squares, fit.source.size());
    const double mirrored = root_mean_square(fit.mirrored_squares, fit.source.size());
    if (rotated <= clear * mirrored || rotated <= rounding * extent_of(fit.target)) return;
    throw Error(
        "the target is a mirror image of the source: residuals are {:.4g} {} RMS after a rotation, {:.4g} {} "
        "after a reflection",
        rotated, unit, mirrored, unit)
        .hint("an axis of one of the files points the wrong way, or rows are exchanged");
}

void require_determined(const Fit& fit, std::string_view unit) {
    const double noise = std::max(noise_of(fit), rounding * std::max(extent_of(fit.source), extent_of(fit.target)));
    const double spread = std::min(spread_about_line(fit.source), spread_about_line(fit.target));
    if (spread > 0 && noise <= largest_angle * spread) return;
    const double pairs = static_cast<double>(fit.source.size());
    // The scale takes one degree of freedom more than noise_of().
    const double scaled_noise = std::sqrt(fit.scaled_squares / (3 * pairs - 7));
    if (is_scaled(fit) && scaled_noise <= largest_angle * spread_about_line(fit.target))
        throw Error("{}", scale_text(fit, unit))
            .hint(
                "one of the files has a wrong unit: `scanmill convert` with --unit and --to-unit writes it in another "
                "unit");
    throw Error(
        "the {} pairs determine the rotation only to {} deg; 1 deg is needed: the points lie {:.4g} {} RMS from one "
        "line, and the residuals are {:.4g} {} RMS",
        fit.source.size(),
        spread > noise ? fmt::format("{:.3g}", noise / spread * 180 / std::numbers::pi) : std::string("more than 57"),
        spread / std::sqrt(pairs), unit, root_mean_square(fit.squares, fit.source.size()), unit)
        .hint(fmt::format("use points that do not lie on a line, or check the correspondence of the points and the "
                          "units; the best scale is {:.6g}",
                          fit.scale));
}

// Normals and rectangles.

/// By row: the vector in the column `normal`, or zero if it is not finite. Empty without such a column.
std::optional<Points> normals_of(const PointCloud& cloud) {
    const Column* column = cloud.columns.find("normal");
    if (!column || column->components() != 3) return {};
    Points normals;
    for (std::size_t row = 0; row < column->rows(); ++row) {
        const Vec3 normal(column->number(row, 0), column->number(row, 1), column->number(row, 2));
        normals.push_back(normal.allFinite() ? normal : Vec3::Zero());
    }
    return normals;
}

void require_same_side(const PointCloud& source, const PointCloud& target, std::span<const u32> partner,
                       const Matrix3& rotation) {
    const std::optional<Points> before = normals_of(source), after = normals_of(target);
    if (!before || !after) return;
    std::size_t compared = 0;
    for (std::size_t row = 0; row < partner.size(); ++row) {
        const Vec3 &one = (*before)[partner[row]], &other = (*after)[row];
        if (one.isZero(0) || other.isZero(0)) continue;
        if (!((rotation * one).dot(other) < 0)) return;
        ++compared;
    }
    if (compared == 0) return;
    throw Error(
        "the normals of all {} pairs{} point to opposite sides after the motion: the target is a mirror image of "
        "the source",
        compared, compared < partner.size() ? " that have them" : "")
        .hint("the points of the two files go around in opposite directions; reverse the rows of one file");
}

/// Twice the area vector of the polygon. Seen from the tip of the vector, the polygon is counter-clockwise.
Vec3 area_of(const Points& corners) {
    Vec3 area = Vec3::Zero();
    for (std::size_t i = 0; i < corners.size(); ++i) area += corners[i].cross(corners[(i + 1) % corners.size()]);
    return area;
}

/// Twice the area vector of the largest of the three polygons through the corners. Only its sign depends on the order
/// of the corners.
Vec3 largest_area(const Points& c, std::string_view port) {
    Vec3 largest = Vec3::Zero();
    for (const Points& order :
         {Points{c[0], c[1], c[2], c[3]}, Points{c[0], c[2], c[1], c[3]}, Points{c[0], c[1], c[3], c[2]}})
        if (const Vec3 area = area_of(order); area.squaredNorm() > largest.squaredNorm()) largest = area;
    if (const double extent = extent_of(c); !(largest.norm() > rounding * extent * extent))
        throw Error("the four corners at '{}' lie on one line", port)
            .hint("give the four different corners of a rectangle");
    return largest;
}

/// Whether the polygon of four corners in the order of their rows goes once around. If the polygon crosses itself, only
/// noise gives its area a sign.
bool goes_around(const Vec3& area, const Vec3& largest) { return area.norm() > 0.5 * largest.norm(); }

/// The unit normal of the plate on its upper side; see align() for how that side is determined.
Vec3 up_of(const PointCloud& cloud, const Points& corners, const std::optional<Vec3>& given, bool rows_decide,
           std::string_view port) {
    const Vec3 largest = largest_area(corners, port), normal = largest.normalized(), by_rows = area_of(corners);
    std::vector<std::pair<std::string_view, Vec3>> directions;  // in the order in which they are tried
    if (const std::optional<Points> normals = normals_of(cloud))
        if (const Vec3 mean = mean_of(*normals); mean.norm() > 0)
            directions.emplace_back("the mean normal of the corners", mean);
    const bool has_normals = !directions.empty();
    if (given) directions.emplace_back("`up`", *given);
    if (!has_normals && rows_decide && goes_around(by_rows, largest))
        directions.emplace_back("the order of the rows", by_rows);
    if (directions.empty()) directions.emplace_back("`up`", Vec3::UnitZ());
    const auto cosine_of = [&](const Vec3& up) { return normal.dot(up.normalized()); };
    for (const auto& [name, up] : directions) {
        constexpr double least = 0.5;  // cosine of 60 degrees
        if (const double cosine = cosine_of(up); std::abs(cosine) >= least) return cosine > 0 ? normal : Vec3(-normal);
    }
    const auto& [name, up] = directions.front();
    const double angle = angle_between(normal, up);
    throw Error("{} is {:.3g} deg off the normal of the plate at '{}'; at most 60 deg determine the upper side", name,
                std::min(angle, std::numbers::pi - angle) * 180 / std::numbers::pi, port)
        .hint("give `up`, a direction that points away from the plate's upper side");
}

/// The rows in counter-clockwise order seen from `up`, beginning with row 0.
std::array<u32, 4> order_around(const Points& centred, const Vec3& up, std::string_view port) {
    const Vec3 x = (centred[0] - up * up.dot(centred[0])).normalized(), y = up.cross(x);
    std::array<u32, 4> order{0, 1, 2, 3};
    // A number from 0 to 4 that ascends with the angle from x, without trigonometric functions.
    const auto angle = [&](u32 row) {
        const double across = centred[row].dot(x), along = centred[row].dot(y),
                     size = std::abs(across) + std::abs(along);
        const double share = along / size;
        return row == 0 || size == 0 ? 0.0 : across >= 0 ? (along >= 0 ? share : 4 + share) : 2 - share;
    };
    std::ranges::sort(order, {}, angle);
    Points sorted;
    for (const u32 row : order) sorted.push_back(centred[row]);
    for (std::size_t i = 0; i < 4; ++i)
        if (!(sorted[i].cross(sorted[(i + 1) % 4]).dot(up) > 0))
            throw Error("the four corners at '{}' do not go once around their centre", port)
                .hint("give the four different corners of a rectangle");
    return order;
}

/// The world coordinates of `first-corner`.
Vec3 first_corner_of(const AlignParams& params) {
    if (!params.first_corner)
        throw Error("`first-corner` is not given; a rectangle fits its corners in 2 ways, half a turn apart")
            .hint(
                "give `first-corner`, a rough position in the source of the corner that belongs to the first target "
                "point");
    return position_of(*params.first_corner, "`first-corner`");
}

/// The index in `order` of the corner nearest to `position`. The corners and `position` have one origin.
std::size_t corner_near(const Points& corners, const std::array<u32, 4>& order, const Vec3& position,
                        std::string_view unit) {
    double shortest = std::numeric_limits<double>::infinity();
    for (std::size_t i = 0; i < 4; ++i)
        shortest = std::min(shortest, (corners[order[(i + 1) % 4]] - corners[order[i]]).norm());
    std::size_t nearest = 0;
    for (std::size_t i = 1; i < 4; ++i)
        if ((corners[order[i]] - position).norm() < (corners[order[nearest]] - position).norm()) nearest = i;
    const double distance = (corners[order[nearest]] - position).norm();
    if (!(distance < shortest / 2))
        throw Error(
            "`first-corner` is {:.4g} {} from the nearest corner of the source; less than {:.4g} {}, half of "
            "the shortest side, is needed",
            distance, unit, shortest / 2, unit)
            .hint("give it in the coordinates of the source, as `scanmill info` prints them");
    return nearest;
}

Points points_of(const PointCloud& cloud) { return {cloud.positions.begin(), cloud.positions.end()}; }

/// The source row of every target row.
std::vector<u32> partners_in_rectangle(const PointCloud& source, const PointCloud& target, const AlignParams& params) {
    if (source.size() != 4)
        throw Error("the source and the target have {} points each; a rectangle has 4 corners", source.size())
            .hint("`correspondence: rows` aligns any number of pairs");
    std::optional<Vec3> up;
    if (params.up) up = direction_of(*params.up, "`up`");
    const std::string_view unit = symbol(source.frame.unit);
    const Points from = points_of(source), to = points_of(target);
    const Points from_centre = about(from, mean_of(from)), to_centre = about(to, mean_of(to));
    const Vec3 source_up = up_of(source, from_centre, up, true, "source");
    const Vec3 target_up = up_of(target, to_centre, up, false, "target");
    const std::array<u32, 4> from_order = order_around(from_centre, source_up, "source");
    const std::array<u32, 4> to_order = order_around(to_centre, target_up, "target");
    const std::size_t first = corner_near(from, from_order, first_corner_of(params) - source.frame.origin, unit);

    const auto partners = [&](std::size_t turn) {
        std::vector<u32> partner(4);
        for (std::size_t i = 0; i < 4; ++i) partner[to_order[i]] = from_order[(first + turn + i) % 4];
        return partner;
    };
    const auto squares = [&](std::size_t turn) {
        Points paired;
        for (const u32 row : partners(turn)) paired.push_back(from[row]);
        return fit_of(paired, to).squares;
    };
    // Half a turn fits equally well, by symmetry. A quarter turn exchanges long and short sides.
    const double chosen = squares(0), other = std::min(squares(1), squares(3));
    if (root_mean_square(chosen, 4) > std::max(clear * root_mean_square(other, 4), rounding * extent_of(to_centre)))
        throw Error(
            "with the corner at `first-corner` long sides meet short ones: residuals are {:.4g} {} RMS, and "
            "{:.4g} {} with a corner next to it",
            root_mean_square(chosen, 4), unit, root_mean_square(other, 4), unit)
            .hint("give `first-corner` near the source corner that belongs to the first target point");
    return partners(0);
}

std::vector<u32> partners_by_row(const PointCloud& source, const AlignParams& params) {
    if (params.first_corner)
        throw Error("`first-corner` is given, but `correspondence` is rows")
            .hint("write `correspondence: rectangle`, or remove `first-corner`");
    std::vector<u32> partner(source.size());
    for (std::size_t row = 0; row < partner.size(); ++row) partner[row] = static_cast<u32>(row);
    return partner;
}

double error_at(const AlignPart& part, const PointCloud& source, const Fit& fit) {
    if (!part.frame.empty() && !source.frame.name.empty() && part.frame != source.frame.name)
        throw Error("the part is in the frame '{}', the source in '{}'; both need one frame", part.frame,
                    source.frame.name)
            .hint("wire the part as the scanner saw it, before `apply-transform`");
    if (part.box.empty())
        throw Error("the part has no points; its box is empty").hint("wire the scan of the part, or leave `part` out");
    const Vec3 centre = source.frame.origin + fit.source_mean;
    const Matrix3 inverse = inertia_of(fit.source).inverse();
    double largest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 world((corner & 1 ? part.box.high : part.box.low).x(),
                         (corner & 2 ? part.box.high : part.box.low).y(),
                         (corner & 4 ? part.box.high : part.box.low).z());
        const Matrix3 arm = cross_matrix(world - centre);
        const double variance = 3 / static_cast<double>(fit.source.size()) + (arm * inverse * arm.transpose()).trace();
        largest = std::max(largest, noise_of(fit) * std::sqrt(variance));
    }
    return largest;
}

void report(const AlignResult& result, const Fit& fit, std::string_view unit, const AlignParams& params,
            Context& context) {
    context.metric("rms", result.rms, Unit::length);
    context.metric("largest-residual", result.largest_residual, Unit::length);
    for (std::size_t row = 0; row < std::min(result.residuals.size(), most_residuals); ++row)
        context.metric(row == 0 ? "residual" : fmt::format("residual@{}", row + 1), result.residuals[row].norm(),
                       Unit::length);
    if (params.scale == AlignParams::Scale::report) {
        context.metric("scale", result.scale, Unit::number);
        if (is_scaled(fit))
            context.doubt(scale_text(fit, unit) + "; a unit is wrong, or the scanner is out of calibration");
    }
    if (result.error_at_part) context.metric("error-at-part", *result.error_at_part, Unit::length);
}

}  // namespace

AlignResult align(const PointCloud& source, const PointCloud& target, const std::optional<AlignPart>& part,
                  const AlignParams& params, Context& context) {
    require_pairs(source, target);
    const std::string_view unit = symbol(source.frame.unit);
    AlignResult result;
    result.partner = params.correspondence == AlignParams::Correspondence::rectangle
                         ? partners_in_rectangle(source, target, params)
                         : partners_by_row(source, params);
    Points paired;
    paired.reserve(result.partner.size());
    for (const u32 row : result.partner) paired.push_back(source.positions[row]);
    const Fit fit = fit_of(paired, points_of(target));
    require_not_mirrored(fit, unit);
    require_determined(fit, unit);
    require_same_side(source, target, result.partner, fit.rotation);
    if (!source.frame.name.empty() && source.frame.name == target.frame.name)
        context.warn(
            fmt::format("source and target are both in the frame '{}': a second application of the transform "
                        "cannot be detected",
                        source.frame.name));

    result.transform.rotation = fit.rotation;
    result.transform.translation =
        (target.frame.origin + fit.target_mean) - fit.rotation * (source.frame.origin + fit.source_mean);
    result.transform.unit = source.frame.unit;
    result.transform.from = source.frame.name;
    result.transform.to = target.frame.name;
    result.residuals.reserve(result.partner.size());
    for (std::size_t row = 0; row < result.partner.size(); ++row) {
        result.residuals.push_back(fit.residual(row));
        result.largest_residual = std::max(result.largest_residual, result.residuals.back().norm());
    }
    result.rms = root_mean_square(fit.squares, result.partner.size());
    result.transform.rms = result.rms;
    result.scale = fit.scale;
    if (part) result.error_at_part = error_at(*part, source, fit);
    report(result, fit, unit, params, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
