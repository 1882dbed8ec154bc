// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/register_to_target.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>

#include "register/view_checks.hpp"
#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/registration/plane_equations.hpp"
#include "scanmill/geometry/registration/relaxation.hpp"
#include "scanmill/geometry/registration/thinning.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

using namespace registration;

constexpr double spacings_per_voxel = 4, voxels_per_size = 10.5;
constexpr std::size_t normal_neighbours = 24, most_samples = 4000, few_samples = 800;
constexpr double settled = 0.01;  ///< in spacings
constexpr double least_product = 0.7;  ///< of the normals of a point and of the target
/// The share of few samples has a standard deviation of 0.01; poses below this share of the best fit cannot be equal.
constexpr double worth_finishing = 0.9;
/// One equal pose is enough for a refusal.
constexpr std::size_t most_finished = 10;
/// A point lies on the target within this distance from the plane of the nearest sample, which is at most twice as far.
/// Real parts deviate from their models, so dense scans are measured by the resolution.
constexpr double on_target_spacings = 2, on_target_resolutions = 0.2;
/// Poses with a smaller share of reduced points near the model cannot fit well enough; they are not refined further.
constexpr double least_coarse_overlap = 0.6;
/// The least share of the scan's points on the target.
constexpr double least_fit = 0.8;
/// Largest share of the target's points in front of the scan. Right poses have up to 0.036, wrong ones 0.08 to 0.13 or
/// a rival.
constexpr double largest_in_front = 0.055;
/// The mean of the directions to the scanner is at least this long for a scan from one side, whose lines of sight are
/// tested with this reach, in multiples of the distance above.
constexpr double least_one_sided = 0.8, sight_reach = 1.25;
/// A rival is equal with this share of the best fit, because small notches change the fit by 0.02 to 0.06, and the
/// share itself has a standard deviation of 0.002. It is equal, too, if it leaves less than this many times the points
/// that the best pose leaves: then neither may be right.
constexpr double equal_fit = 0.98, equal_rest = 2;
/// Poses that displace the scan by less resolutions are the same.
constexpr double same_pose = 2;
/// With a start: all other equal poses must be so many resolutions farther from it.
constexpr double clearly_farther = 5;
/// Turns about a principal axis, as shares of a full turn: parts have 3, 5, 6, 7 or 8 equal holes. Halves and quarters
/// are among the rotations of the cube.
constexpr int symmetries[] = {3, 5, 6, 7, 8};
/// A turned pose that fits better is turned again, so that turns about two axes are found.
constexpr int most_probe_rounds = 4;
constexpr double clearly_better = 1.02;
/// Refining a pose with reduced points is cheap, so all that the descriptors propose are refined.
constexpr std::size_t all_seeds = 300;
/// Nearly all that a scan of 1,500 reduced points has. Memory and time grow with the square.
constexpr std::size_t target_correspondences = 9000;
constexpr std::size_t most_target_samples = 2'000'000;

/// Centroid and principal axes of the target; the axes are right-handed.
struct PrincipalFrame {
    Vec3 centre;
    Eigen::Matrix3d axes;
};
PrincipalFrame principal_frame(std::span<const Vec3> points) {
    const ViewExtent extent = extent_of(points);
    Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
    for (const Vec3& p : points) covariance += (p - extent.centre) * (p - extent.centre).transpose();
    Eigen::Matrix3d axes = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(covariance).eigenvectors();
    if (axes.determinant() < 0) axes.col(0) = -axes.col(0);
    return {extent.centre, axes};
}

/// The 23 rotations of the cube other than the identity, and the turns of `symmetries` about each axis.
std::vector<Eigen::Matrix3d> probe_rotations() {
    std::vector<Eigen::Matrix3d> rotations;
    int order[3] = {0, 1, 2};
    do {
        for (int signs = 0; signs < 8; ++signs) {
            Eigen::Matrix3d rotation = Eigen::Matrix3d::Zero();
            for (int i = 0; i < 3; ++i) rotation(order[i], i) = signs >> i & 1 ? -1 : 1;
            if (rotation.determinant() > 0 && rotation.trace() < 3) rotations.push_back(rotation);
        }
    } while (std::next_permutation(std::begin(order), std::end(order)));
    for (int axis = 0; axis < 3; ++axis)
        for (const int k : symmetries)
            for (int j = 1; j < k; ++j) {
                // From -π to π, where the sine and cosine are exact.
                const double angle = 2 * std::numbers::pi * (2 * j > k ? j - k : j) / k;
                const elementary::Turn turn = elementary::turn_of(angle);
                Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();
                const int x = (axis + 1) % 3, y = (axis + 2) % 3;
                rotation(x, x) = rotation(y, y) = turn.cosine;
                rotation(x, y) = -turn.sine, rotation(y, x) = turn.sine;
                rotations.push_back(rotation);
            }
    return rotations;
}

struct Pose {
    RigidMotion motion;
    double fit = 0;  ///< share of the scan's points on the target
};

/// Sorts by fit, the largest first; equal ones keep their order.
void sort_by_fit(std::vector<Pose>& poses) { std::ranges::stable_sort(poses, std::ranges::greater(), &Pose::fit); }

/// Points in rows across the longest edges of the triangles; nullopt if there are too many.
std::optional<TargetSamples> at_most_samples(const TriangleMesh& mesh, double spacing) {
    TargetSamples samples{{}, {}, spacing};
    const std::size_t most = most_target_samples + mesh.triangles.size();
    for (const Triangle& t : mesh.triangles) {
        const Vec3 area = area_vector(mesh.positions, t);
        if (!(area.norm() > 0)) continue;
        u32 longest = 0;
        double length = -1;
        for (u32 i = 0; i < 3; ++i)
            if (const double edge = (mesh.positions[t[(i + 1) % 3]] - mesh.positions[t[i]]).norm(); edge > length)
                length = edge, longest = i;
        const Vec3 &from = mesh.positions[t[longest]], &to = mesh.positions[t[(longest + 1) % 3]],
                   &apex = mesh.positions[t[(longest + 2) % 3]];
        const Vec3 normal = area.normalized(), along = (to - from) / length, across = normal.cross(along);
        const double foot = along.dot(apex - from), height = area.norm() / length;
        const double rows = std::ceil(length / spacing);
        for (double row = 0.5; row < rows; ++row) {
            const double x = row / rows * length,
                         width = height * (x < foot ? x / foot : (length - x) / (length - foot));
            const double columns = std::ceil(width / spacing);
            for (double column = 0.5; column < columns; ++column) {
                samples.points.push_back(from + x * along + column / columns * width * across);
                samples.normals.push_back(normal);
            }
            if (samples.points.size() > most) return std::nullopt;
        }
    }
    return samples;
}

Vec3 mean_of(std::span<const Vec3> directions) {
    Vec3 sum = Vec3::Zero();
    for (const Vec3& direction : directions) sum += direction;
    return sum / static_cast<double>(directions.size());
}

/// Number of the target's points in front of the scan, as a share of these and of the ones on it. The scanner would
/// have hit them first.
double share_in_front(const ViewSurface& scan, const Vec3& to_scanner, const ReducedView& target,
                      const RegisterToTargetResult& result) {
    const double reach = sight_reach * result.tolerance;
    const SightLines sight(scan.points(), to_scanner, reach);
    const RigidMotion to_scan = result.pose.inverse();
    std::size_t front = 0, on = 0;
    for (const Vec3& point : target.points) {
        const Vec3 p = to_scan.apply(point);
        front += sight.place_of(p) == SightLines::Place::in_front;
        on += scan.grid().nearest(p, reach, reach).row != ProjectedGrid::Nearest::none;
    }
    return front == 0 ? 0 : static_cast<double>(front) / static_cast<double>(front + on);
}

/// Fits poses of a scan on a target: many with few samples, then the good ones with all.
class Fitting {
public:
    /// `rough_target` has samples about the tolerance apart.
    Fitting(const ViewSurface& scan, const ViewSurface& target, const ViewSurface& rough_target,
            const ReducedView& reduced_scan, const ReducedView& reduced_target, double tolerance,
            const Execution& execution)
        : scan_(scan),
          few_(scan.with_samples(few_samples)),
          target_(target),
          rough_target_(rough_target),
          reduced_scan_(reduced_scan),
          reduced_target_(reduced_target),
          tolerance_(tolerance),
          execution_(execution) {}

    /// Fits with the reduced points, then with few samples.
    std::vector<Pose> roughly(std::span<const RigidMotion> starts) const {
        const double resolution = reduced_scan_.resolution;
        const RelaxationStage stages[] = {{resolution, 4}, {resolution / 2, 4}};
        std::vector<Pose> poses(starts.size());
        in_parallel(poses, [&](std::size_t i) -> Pose {
            const RigidMotion coarse = refined(reduced_scan_, reduced_target_, starts[i]);
            if (measured(reduced_scan_, reduced_target_, coarse).overlap < least_coarse_overlap) return {coarse, 0};
            return fitted(few_, rough_target_, coarse, stages);
        });
        return poses;
    }

    /// Fits the poses with all samples whose fit is near the best one; the others keep what they have.
    void finish(std::vector<Pose>& poses) const {
        double best = 0;
        for (const Pose& pose : poses) best = std::max(best, pose.fit);
        const RelaxationStage stages[] = {{1.5 * tolerance_, 12}};
        in_parallel(poses, [&](std::size_t i) {
            return poses[i].fit > 0 && poses[i].fit >= worth_finishing * best
                       ? fitted(scan_, target_, poses[i].motion, stages)
                       : poses[i];
        });
    }

    /// The smallest eigenvalue of the planes under the points that lie on the target. Points off it do not count: they
    /// may be the ones that show that the scan has slid.
    double slide(const RigidMotion& motion) const {
        std::vector<PlanePair> on;
        for (const u32 sample : scan_.samples()) {
            const Vec3 point = motion.apply(scan_.points()[sample]);
            const u32 partner = target_.grid().nearest(point, target_.grid().edge(), 2 * tolerance_).row;
            if (partner == ProjectedGrid::Nearest::none) continue;
            const Vec3& normal = target_.normals()[partner];
            const double residual = (point - target_.points()[partner]).dot(normal);
            if (std::abs(residual) <= tolerance_ && motion.turned(scan_.normals()[sample]).dot(normal) > least_product)
                on.push_back({point, normal, residual});
        }
        return std::max(0.0, plane_equations(on).eigenvalues()[0]);
    }

private:
    template <class Fit>
    void in_parallel(std::vector<Pose>& poses, const Fit& fit) const {
        for_each_chunk(execution_.threads(), poses.size(), 1, [&](std::size_t i, std::size_t) {
            execution_.check_cancelled();
            poses[i] = fit(i);
        });
    }

    Pose fitted(const ViewSurface& scan, const ViewSurface& target, const RigidMotion& start,
                std::span<const RelaxationStage> stages) const {
        const ViewSurface* const surfaces[] = {&target, &scan};
        const ViewPair pairs[] = {{0, 1}};
        const Execution one_thread;
        const RigidMotion motion =
            relaxed(surfaces, {RigidMotion(), start}, pairs, stages, settled * scan.spacing(), one_thread).poses[1];
        const Agreement on = agreement(scan, target, motion, 2 * tolerance_, tolerance_);
        return {motion, static_cast<double>(on.close) / static_cast<double>(scan.samples().size())};
    }

    const ViewSurface& scan_;
    ViewSurface few_;
    const ViewSurface& target_;
    const ViewSurface& rough_target_;
    const ReducedView& reduced_scan_;
    const ReducedView& reduced_target_;
    double tolerance_;  ///< to the plane of the nearest sample
    const Execution& execution_;
};

}  // namespace

std::string_view name_of(TargetRefusal refusal) {
    switch (refusal) {
        case TargetRefusal::none: break;
        case TargetRefusal::ambiguous: return "ambiguous";
        case TargetRefusal::slides: return "slides";
        case TargetRefusal::no_fit: return "no-fit";
        case TargetRefusal::contradicts: return "contradicts";
    }
    return {};
}

TargetSamples samples_of(const TriangleMesh& mesh, double spacing) {
    for (;; spacing *= 2)
        if (std::optional<TargetSamples> samples = at_most_samples(mesh, spacing)) return std::move(*samples);
}

TargetSamples samples_of(std::span<const Vec3> points, std::span<const Vec3> to_scanner, double spacing) {
    const ViewSurface surface(points, to_scanner, normal_neighbours, 0);
    TargetSamples samples;
    samples.spacing = std::max(spacing, surface.spacing());
    for (const u32 row : thinned_rows(surface.points(), spacing)) {
        samples.points.push_back(surface.points()[row]);
        samples.normals.push_back(surface.normals()[row]);
    }
    return samples;
}

RegisterToTargetResult register_to_target(const ScanToPlace& scan,
                                          const std::function<TargetSamples(double spacing)>& target,
                                          const RegisterViewsParams& params, Execution& execution) {
    require_surface(scan.points, scan.name);
    RegisterToTargetResult result;
    const ViewSurface surface(scan.points, scan.to_scanner, normal_neighbours, most_samples);
    const TargetSamples samples = target(surface.spacing());
    if (samples.points.empty()) throw Error("the target has no surface").hint("give a mesh with triangles, or points");
    const double spacing = result.spacing = std::max(surface.spacing(), samples.spacing);
    const double resolution = result.resolution = params.resolution.value_or(
        std::max(spacings_per_voxel * spacing, extent_of(scan.points).radius / voxels_per_size));
    result.tolerance = std::max(on_target_spacings * spacing, on_target_resolutions * resolution);
    execution.progress(0.1);

    const ReducedView reduced_scan = reduced_surface(scan.points, scan.to_scanner, resolution),
                      reduced_target = reduced_surface(samples.points, samples.normals, resolution);
    const ViewSurface target_surface(samples.points, samples.normals, spacing);
    const TargetSamples rough = target(result.tolerance);
    const ViewSurface rough_surface(rough.points, rough.normals, rough.spacing);
    const Fitting fitting(surface, target_surface, rough_surface, reduced_scan, reduced_target, result.tolerance,
                          execution);
    const auto difference = [&](const RigidMotion& one, const RigidMotion& other) {
        return displacement(one, other, reduced_scan.extent.centre, reduced_scan.extent.radius);
    };

    std::vector<RigidMotion> starts;
    if (scan.start) starts.push_back(*scan.start);
    std::vector<Candidate> candidates =
        registered_pair(reduced_scan, reduced_target, {params.overlap, all_seeds, all_seeds, target_correspondences})
            .candidates;
    std::ranges::stable_sort(candidates, std::ranges::greater(), [](const Candidate& c) { return c.measures.overlap; });
    candidates.resize(std::min<std::size_t>(candidates.size(), params.seed_tries));
    for (const Candidate& candidate : candidates) starts.push_back(candidate.motion);
    execution.progress(0.3);
    std::vector<Pose> poses = fitting.roughly(starts);
    if (poses.empty()) return result;
    sort_by_fit(poses);

    const PrincipalFrame frame = principal_frame(samples.points);
    const std::vector<Eigen::Matrix3d> rotations = probe_rotations();
    for (int round = 0; round < most_probe_rounds; ++round) {
        const Pose best = poses[0];
        starts.clear();
        for (const Eigen::Matrix3d& rotation : rotations) {
            const Eigen::Matrix3d turn = frame.axes * rotation * frame.axes.transpose();
            starts.push_back(best.motion.then({turn, frame.centre - turn * frame.centre}));
        }
        const std::vector<Pose> probes = fitting.roughly(starts);
        poses.insert(poses.end(), probes.begin(), probes.end());
        sort_by_fit(poses);
        if (poses[0].fit < clearly_better * best.fit) break;
    }
    execution.progress(0.7);

    // Different poses, the best first.
    std::vector<Pose> chosen;
    for (const Pose& pose : poses)
        if (std::ranges::all_of(chosen, [&](const Pose& better) {
                return difference(pose.motion, better.motion) > same_pose * resolution;
            }))
            chosen.push_back(pose);
    if (scan.start)
        std::stable_sort(chosen.begin() + 1, chosen.end(), [&](const Pose& a, const Pose& b) {
            return difference(a.motion, *scan.start) < difference(b.motion, *scan.start);
        });
    chosen.resize(std::min(chosen.size(), most_finished));
    fitting.finish(chosen);
    sort_by_fit(chosen);
    execution.progress(0.9);
    const double best = chosen[0].fit;
    const auto is_equal = [&](const Pose& pose) {
        return pose.fit > 0 && (pose.fit >= equal_fit * best || 1 - pose.fit < equal_rest * (1 - best));
    };
    bool is_chosen_by_start = false;
    if (scan.start) {
        std::ranges::stable_sort(chosen, {}, [&](const Pose& pose) {
            return is_equal(pose) ? difference(pose.motion, *scan.start) : std::numeric_limits<double>::infinity();
        });
        is_chosen_by_start = chosen.size() < 2 || !is_equal(chosen[1]) ||
                             difference(chosen[1].motion, *scan.start) >
                                 difference(chosen[0].motion, *scan.start) + clearly_farther * resolution;
    }
    result.pose = chosen[0].motion;
    result.fit = chosen[0].fit;
    result.rivals = static_cast<std::size_t>(std::ranges::count_if(chosen, is_equal)) - 1;
    if (chosen.size() > 1) {
        result.rival = chosen[1].fit;
    }
    if (const Vec3 side = mean_of(scan.to_scanner); side.norm() >= least_one_sided)
        result.front = share_in_front(surface, side.normalized(), reduced_target, result);
    result.slide = fitting.slide(result.pose);
    execution.progress(1);
    if (result.fit < std::max(least_fit, params.overlap))
        result.refusal = TargetRefusal::no_fit;
    else if (result.slide < least_slide)
        result.refusal = TargetRefusal::slides;
    else if (result.front > largest_in_front)
        result.refusal = TargetRefusal::contradicts;
    else if (result.rivals > 0 && !is_chosen_by_start)
        result.refusal = TargetRefusal::ambiguous;
    else
        result.refusal = TargetRefusal::none;
    return result;
}

}  // namespace scanmill
