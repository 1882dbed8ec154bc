// SPDX-License-Identifier: GPL-3.0-or-later
#include "icp/icp.hpp"

#include <fmt/format.h>

#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <iterator>

#include "icp/target.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/robust_box.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/registration/plane_equations.hpp"
#include "scanmill/geometry/spatial/spatial_order.hpp"

namespace scanmill {

namespace {

using detail::Foot;
using detail::Search;
using detail::Target;

/// With noise of 20 um, 50,000 points determine a pose to about 0.1 um; more points would only take more time.
constexpr std::size_t most_points = 50'000;
constexpr std::size_t least_points = 6, least_pairs = 6;
constexpr std::size_t chunk = 512;
/// The automatic `max_distance` as a share of the diagonal. Twice what a part moves when it is 2 % of its diagonal and
/// 2 degrees away, so that Tukey's weights still are above 1/2 there.
constexpr double automatic_share = 0.05;
/// Tukey's biweight with this cut has 95 % of the efficiency of least squares with normally distributed residuals.
constexpr double tukey_cut = 4.685;
/// The standard deviation of normally distributed residuals, as a multiple of the median of their magnitudes.
constexpr double deviation_by_median = 1.4826;
/// The least cut as a share of the diagonal. Without it, residuals that are rounding would be outliers of each other.
constexpr double least_cut = 1e-6;
/// The cut is halved when a motion was smaller than this share of it: the residuals then change no more by much.
constexpr double settled_share = 0.1;
constexpr double tolerance_share = 1e-4;  ///< as a share of the spacing
/// Eigenvalues of H below this do not determine a motion. With noise of half a spacing, planes, spheres, cylinders and
/// bodies of revolution have 0 to 0.0004; parts that do not slide have 0.0022 and more.
constexpr double least_slide = 0.002;
/// More directions than a plane or a sphere has cannot be free on a surface.
constexpr u32 most_free_directions = 3;
constexpr double least_overlap = 0.05, doubtful_overlap = 0.3;
/// Residuals that are spread evenly up to `max_distance` have their median at 0.5 of it; normally distributed ones of
/// which the outer 13 % are cut off have it at 0.4.
constexpr double even_median = 0.4;
constexpr double rounding = 1e-12;

std::size_t pairs_of_share(double share, std::size_t points) {
    return static_cast<std::size_t>(std::ceil(share * static_cast<double>(points)));
}

/// The points at a pose.
struct Pairs {
    Array<PlanePair> list;  ///< one per point; the residual is NaN without a pair
    Array<double> magnitudes;  ///< absolute residuals of the points with a pair, in any order
    double nearest = 0;  ///< smallest distance of a point from the target, also without a pair
    std::size_t on_boundary = 0;  ///< points near enough, where the target ends
};

class Refinement {
public:
    /// `points` are in the coordinates of the target.
    Refinement(const Target& target, Array<Vec3> points, double limit, const IcpParams& params, std::string_view unit,
               Context& context)
        : target_(target),
          points_(std::move(points)),
          limit_(limit),
          params_(params),
          unit_(unit),
          context_(context),
          hints_(points_.size(), NearestTriangle::none) {
        const std::size_t count = points_.size();
        pairs_.list.resize(count);
        pairs_.magnitudes.reserve(count);
        distances_.resize(count);
        valid_.resize(count);
        Vec3 sum = Vec3::Zero();
        for (const Vec3& p : points_) sum += p - points_[0];
        pivot_ = points_[0] + sum / static_cast<double>(count);
        const double diagonal = bounding_box(points_).diagonal();
        least_cut_ = least_cut * std::min(diagonal, target.diagonal());
        result_.tolerance = std::max(tolerance_share * point_spacing(points_), rounding * diagonal);
        for (std::size_t i = 0; i < count; ++i) {
            points_[i] -= pivot_;
            pairs_.list[i].point = points_[i];
        }
    }

    /// Runs to the end; `explain` is added to the hint if there are too few pairs.
    void run(const std::function<std::string()>& explain) {
        double level = limit_;
        cut_ = limit_;
        for (;; ++result_.iterations) {
            context_.check_cancelled();
            find_pairs();
            if (result_.iterations == 0) require_pairs(explain);
            const double tight = tight_cut();
            const bool is_tight = counts_equally() || level <= tight;
            cut_ = counts_equally() ? limit_ : std::min(limit_, std::max(level, tight));
            weight_pairs(is_tight ? trim_limit() : cut_);
            equations_ = plane_equations(pairs_.list);
            if (!(equations_.radius > rounding * target_.diagonal())) equations_ = {};
            if (result_.converged || result_.iterations == params_.max_iterations) break;
            move();
            result_.converged = is_tight && result_.last_motion <= result_.tolerance;
            if (result_.last_motion <= settled_share * level) level /= 2;
            context_.progress(0.2 + 0.8 * (result_.iterations + 1.0) / params_.max_iterations);
        }
        summarise(explain);
    }

    /// The motion of points relative to pivot(), which is in the coordinates of the target.
    const RigidMotion& motion() const { return motion_; }
    const Vec3& pivot() const { return pivot_; }
    const IcpResult& result() const { return result_; }
    const PlaneEquations& equations() const { return equations_; }
    double median_residual() const { return median_; }

private:
    bool counts_equally() const { return params_.trim.value() == 0; }

    void find_pairs() {
        for_each_chunk(context_.threads(), points_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            context_.check_cancelled();
            Search search;
            for (std::size_t i = begin; i < end; ++i) {
                if (hints_[i] != NearestTriangle::none) search.hint = hints_[i];
                PlanePair& pair = pairs_.list[i];
                const Foot foot = target_.foot(pivot_ + pair.point, search);
                hints_[i] = search.hint;
                distances_[i] = foot.distance;
                valid_[i] = foot.is_valid;
                pair.normal = foot.normal;
                pair.residual = foot.is_valid && foot.distance <= limit_ ? foot.residual : std::nan("");
            }
        });
        pairs_.magnitudes.clear();
        pairs_.on_boundary = 0;
        pairs_.nearest = *std::ranges::min_element(distances_);
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const double residual = pairs_.list[i].residual;
            if (!std::isnan(residual)) pairs_.magnitudes.push_back(std::abs(residual));
            pairs_.on_boundary += distances_[i] <= limit_ && !valid_[i];
        }
    }

    /// The cut by the median of the residuals that the cut before leaves.
    double tight_cut() {
        Array<double> magnitudes;
        magnitudes.reserve(pairs_.magnitudes.size());
        std::ranges::copy_if(pairs_.magnitudes, std::back_inserter(magnitudes), [&](double r) { return r <= cut_; });
        median_ = magnitudes.empty() ? 0 : median(magnitudes);
        return std::max(tukey_cut * deviation_by_median * median_, least_cut_);
    }

    /// The largest residual that counts after trimming.
    double trim_limit() {
        if (pairs_.magnitudes.empty()) return 0;
        return std::min(cut_, quantile(pairs_.magnitudes, 1 - params_.trim.value()));
    }

    /// Pairs with residuals up to `largest` count.
    void weight_pairs(double largest) {
        for (PlanePair& pair : pairs_.list) {
            const double share = pair.residual / cut_, rest = 1 - share * share;
            pair.weight = !(std::abs(pair.residual) <= largest) ? 0 : counts_equally() ? 1 : rest * rest;
        }
    }

    /// One Gauss-Newton step.
    void move() {
        motion_ = orthonormal(motion_.then(equations_.motion(least_slide)));
        double farthest = 0;
        for (std::size_t i = 0; i < points_.size(); ++i) {
            const Vec3 moved = motion_.apply(points_[i]);
            farthest = std::max(farthest, (moved - pairs_.list[i].point).squaredNorm());
            pairs_.list[i].point = moved;
        }
        result_.last_motion = std::sqrt(farthest);
    }

    void summarise(const std::function<std::string()>& explain) {
        std::size_t on_target = 0;
        double squares = 0;
        for (const PlanePair& pair : pairs_.list)
            if (std::abs(pair.residual) <= cut_) ++on_target, squares += pair.residual * pair.residual;
        const std::size_t least = std::max(least_pairs, pairs_of_share(least_overlap, points_.size()));
        if (on_target < least)
            throw Error(
                "only {} of {} points of the source lie within {:.4g} {} of the target after {}; at least {} "
                "are needed",
                on_target, points_.size(), cut_, unit_, count_text(result_.iterations, "iteration", "iterations"),
                least)
                .hint(explain() + "crop the source to the part, or begin with a pose that is nearer");
        result_.cut = cut_;
        result_.overlap = static_cast<double>(on_target) / static_cast<double>(points_.size());
        result_.rms = std::sqrt(squares / static_cast<double>(on_target));
        const Vector6 eigenvalues = equations_.eigenvalues();
        result_.slide = std::max(0.0, eigenvalues[0]);
        result_.free_directions = static_cast<u32>((eigenvalues.array() < least_slide).count());
        if (result_.free_directions > most_free_directions)
            throw Error("the pairs determine only {} of 6 directions of motion; a plane or a sphere determines 3",
                        6 - result_.free_directions)
                .hint("the points that lie on the target are nearly on one line; use more of the part");
    }

    void require_pairs(const std::function<std::string()>& explain) const {
        const std::size_t least = std::max(least_pairs, pairs_of_share(least_overlap, points_.size()));
        if (pairs_.magnitudes.size() >= least) return;
        throw Error(
            "only {} of {} points of the source have a pair within `max-distance`, {:.4g} {}; at least {} are needed. "
            "The nearest point is {:.4g} {} from the target{}",
            pairs_.magnitudes.size(), points_.size(), limit_, unit_, least, pairs_.nearest, unit_,
            pairs_.on_boundary > 0 ? fmt::format("; {} nearest to its boundary, which does not count",
                                                 count_text(pairs_.on_boundary, "point is", "points are"))
                                   : "")
            .hint(explain() + "bring the source near with `align` first, or raise `max-distance`");
    }

    const Target& target_;
    Array<Vec3> points_;  ///< relative to `pivot_`
    Vec3 pivot_ = Vec3::Zero();  ///< centroid of the points: near 0, motions lose no digits
    double limit_, least_cut_ = 0, cut_ = 0, median_ = 0;
    const IcpParams& params_;
    std::string_view unit_;
    Context& context_;
    Array<u32> hints_;
    Array<double> distances_;
    std::vector<u8> valid_;
    RigidMotion motion_;
    Pairs pairs_;
    PlaneEquations equations_;
    IcpResult result_;
};

void require_params(const IcpParams& params) {
    if (params.max_distance && !(params.max_distance->value() > 0 && std::isfinite(params.max_distance->value())))
        throw Error("`max-distance` is {}; it must be finite and above 0", params.max_distance->text())
            .hint("leave it out: `auto` is 5 % of the diagonal");
    if (!(params.trim.value() >= 0 && params.trim.value() < 1))
        throw Error("`trim` is {}; it must be at least 0 and below 100 %", params.trim.text())
            .hint("the share of the points that do not belong to the target");
    if (params.max_iterations == 0)
        throw Error("`max-iterations` is 0; at least 1 is needed").hint("leave it out: 50 suffice for most parts");
}

template <class Check>
void at_port(std::string_view port, Check&& check) {
    try {
        check();
    } catch (Error& error) {
        error.add_frame(fmt::format("at '{}'", port));
        if (error.hint().empty()) error.set_hint("remove these points from the file");
        throw;
    }
}

/// Evenly chosen points along a space-filling curve, moved by `shift`.
Array<Vec3> sampled(const PointCloud& source, const Vec3& shift) {
    const Array<u32> order = spatial_order(source.positions.span());
    const std::size_t count = std::min(order.size(), most_points);
    Array<Vec3> points(count);
    for (std::size_t i = 0; i < count; ++i) points[i] = source.positions[order[i * order.size() / count]] + shift;
    return points;
}

/// Says which unit may be wrong, if the target is about that many times as large; else empty.
std::string scale_hint(double ratio) {
    constexpr double tolerated = 1.2;
    for (const double factor : {10.0, 25.4, 1000.0})
        for (const double scale : {factor, 1 / factor})
            if (ratio < tolerated * scale && ratio * tolerated > scale)
                return fmt::format(
                    "the target is {:.4g} times as large as the source, about {}: one of the files may have a wrong "
                    "unit (`scanmill convert` with --unit and --to-unit writes another one); else ",
                    ratio, scale > 1 ? fmt::format("{}", factor) : fmt::format("1/{}", factor));
    return "";
}

/// What slides on itself in that many ways, with its article.
std::string_view sliding_shape(const PlaneEquations& equations, u32 directions) {
    if (directions == 1) return "a body of revolution or an extrusion";
    if (directions == 2) return "a cylinder";
    // The turns of a sphere have three axes, those of a plane one.
    constexpr double least_turn = 0.1;
    const Eigen::Matrix3d turns = equations.eigenvectors().topLeftCorner<3, 3>();
    return Eigen::JacobiSVD<Eigen::Matrix3d>(turns).singularValues()[1] > least_turn ? "a sphere" : "a plane";
}

void report(const IcpResult& result, const Refinement& refinement, double limit, std::string_view unit,
            Context& context) {
    context.metric("rms", result.rms, Unit::length);
    context.metric("overlap", result.overlap, Unit::ratio);
    context.metric("iterations", result.iterations);
    context.metric("slide", result.slide, Unit::number);
    if (result.free_directions > 0)
        context.doubt(fmt::format(
            "the surfaces determine only {} of 6 directions of motion, as {} does (`slide` is {:.2g}; {} is needed); "
            "the source is not moved along {}",
            6 - result.free_directions, sliding_shape(refinement.equations(), result.free_directions), result.slide,
            least_slide, by_count(result.free_directions, "the other one", "the others")));
    if (!result.converged)
        context.doubt(
            fmt::format("not converged after {}: the last one moved a point by {:.3g} {}; {:.3g} {} is needed",
                        count_text(result.iterations, "iteration", "iterations"), result.last_motion, unit,
                        result.tolerance, unit));
    if (result.overlap < doubtful_overlap)
        context.doubt(fmt::format("only {:.3g} % of the points of the source lie on the target, within {:.3g} {}",
                                  100 * result.overlap, result.cut, unit));
    if (refinement.median_residual() > even_median * limit)
        context.doubt(fmt::format(
            "the residuals fill the range up to `max-distance`, {:.3g} {}, evenly: half of them are above {:.3g} {}; "
            "the surfaces do not fit, or are too far apart",
            limit, unit, refinement.median_residual(), unit));
}

IcpResult refined(const PointCloud& source, const Target& target, const Frame& target_frame, double target_size,
                  const IcpParams& params, Context& context) {
    const std::string_view unit = symbol(source.frame.unit);
    const double diagonal = robust_box(source.positions.span()).diagonal();
    if (!(diagonal > 0))
        throw Error("all {} points of the source are at one position", source.size())
            .hint("`scanmill info` shows what a file contains");
    const double limit =
        params.max_distance ? params.max_distance->value() : automatic_share * std::min(diagonal, target_size);
    Refinement refinement(target, sampled(source, source.frame.origin - target_frame.origin), limit, params, unit,
                          context);
    refinement.run([&] { return scale_hint(target_size / diagonal); });

    IcpResult result = refinement.result();
    const RigidMotion& motion = refinement.motion();
    const Vec3 pivot = target_frame.origin + refinement.pivot();
    result.transform.rotation = motion.rotation;
    result.transform.translation = motion.translation + (pivot - result.transform.rotation * pivot);
    result.transform.unit = source.frame.unit;
    result.transform.from = source.frame.name;
    result.transform.to = target_frame.name;
    result.transform.rms = result.rms;
    report(result, refinement, limit, unit, context);
    context.progress(1);
    return result;
}

void require_source(const PointCloud& source, const Frame& target, const IcpParams& params) {
    require_params(params);
    at_port("source", [&] { require_points(source, "planes need points to compare with"); });
    if (source.size() < least_points)
        throw Error("the source has {}; a motion needs at least {}", count_text(source.size(), "point", "points"),
                    least_points)
            .hint("for a few corresponding points, `align` finds the motion");
    Frame named_alike = target;  // the two frames may have different names
    named_alike.name = source.frame.name;
    require_same_frame(source.frame, "the source is", named_alike, "the target");
}

}  // namespace

IcpResult icp(const PointCloud& source, const TriangleMesh& target, const IcpParams& params, Context& context) {
    require_source(source, target.frame, params);
    at_port("target", [&] { require_triangles(target, "a surface is needed"); });
    const detail::MeshTarget surface(target, context);
    return refined(source, surface, target.frame, surface.diagonal(), params, context);
}

IcpResult icp(const PointCloud& source, const PointCloud& target, const IcpParams& params, Context& context) {
    require_source(source, target.frame, params);
    at_port("target", [&] { require_points(target, "planes need points"); });
    const detail::PointsTarget surface(target, context);
    return refined(source, surface, target.frame, surface.diagonal(), params, context);
}

}  // namespace scanmill
