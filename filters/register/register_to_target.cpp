// SPDX-License-Identifier: GPL-3.0-or-later
#include "register/register_to_target.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "register/view_checks.hpp"
#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/registration/plane_equations.hpp"
#include "scanmill/geometry/registration/relaxation.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

using namespace registration;

constexpr double spacings_per_voxel = 4, voxels_per_size = 10.5;
constexpr std::size_t normal_neighbours = 24, most_samples = 4000;
/// A point lies on the model within these distances, in spacings of the scan: to the nearest sample, and to its plane.
constexpr double near_target = 4, on_target = 2;
/// Poses with a smaller share of reduced points near the model cannot fit well enough; they are not refined further.
constexpr double least_coarse_overlap = 0.6;
/// The least share of the scan's points on the model.
constexpr double least_fit = 0.8;
/// A rival is equal with this share of the best fit. Small notches change the fit by 0.02 to 0.06; the share itself has
/// a standard deviation of 0.002.
constexpr double equal_fit = 0.98;
/// Poses that displace the scan by less resolutions are the same.
constexpr double same_pose = 2;
/// With a start: all other equal poses must be so many resolutions farther from it.
constexpr double clearly_farther = 5;
/// Turns about a principal axis, as shares of a full turn: parts have 3, 5, 6, 7 or 8 equal holes. Halves and quarters
/// are among the rotations of the cube.
constexpr int symmetries[] = {3, 5, 6, 7, 8};
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
    double fit = 0;
};

}  // namespace

std::string_view name_of(TargetRefusal refusal) {
    switch (refusal) {
        case TargetRefusal::none: break;
        case TargetRefusal::ambiguous: return "ambiguous";
        case TargetRefusal::slides: return "slides";
        case TargetRefusal::no_fit: return "no-fit";
    }
    return {};
}

TargetSamples samples_of(const TriangleMesh& mesh, double spacing) {
    double area = 0;
    for (const Triangle& t : mesh.triangles) area += area_vector(mesh.positions, t).norm() / 2;
    spacing = std::max(spacing, std::sqrt(area / static_cast<double>(most_target_samples)));
    TargetSamples samples;
    for (const Triangle& t : mesh.triangles) {
        const Vec3 normal = area_vector(mesh.positions, t);
        if (!(normal.norm() > 0)) continue;
        const Vec3 &a = mesh.positions[t[0]], b = mesh.positions[t[1]] - a, c = mesh.positions[t[2]] - a;
        const double longest = std::max({b.norm(), c.norm(), (c - b).norm()});
        const double parts = std::max(1.0, std::ceil(longest / spacing));
        // The centroids of parts² equal triangles: those with the tip up, and those between them.
        for (double i = 0; i < parts; ++i)
            for (double j = 0; i + j < parts; ++j)
                for (const double offset : {1.0 / 3, 2.0 / 3}) {
                    if (offset > 0.5 && i + j + 1 >= parts) continue;
                    samples.points.push_back(a + (i + offset) / parts * b + (j + offset) / parts * c);
                    samples.normals.push_back(normal.normalized());
                }
    }
    return samples;
}

RegisterToTargetResult register_to_target(const ViewToRegister& scan,
                                          const std::function<TargetSamples(double spacing)>& target,
                                          const RegisterViewsParams& params, Execution& execution) {
    require_surface(scan.points, scan.name);
    RegisterToTargetResult result;
    const Vec3 to_scanner = scan.to_scanner.normalized();
    const ViewSurface surface(scan.points, to_scanner, normal_neighbours, most_samples);
    result.spacing = surface.spacing();
    const double spacing = result.spacing;
    result.resolution = params.resolution.value_or(
        std::max(spacings_per_voxel * spacing, extent_of(scan.points).radius / voxels_per_size));
    const double resolution = result.resolution;
    const TargetSamples samples = target(spacing);
    if (samples.points.empty())
        throw Error("the target has no surface").hint("give a mesh with triangles, or points with normals");
    execution.progress(0.1);

    const ReducedView reduced_scan = reduced_view(scan.points, to_scanner, resolution),
                      reduced_target = reduced_surface(samples.points, samples.normals, resolution);
    const ViewSurface target_surface(samples.points, samples.normals, spacing);
    const ViewSurface* const surfaces[] = {&target_surface, &surface};
    const ViewPair pairs[] = {{0, 1}};
    const RelaxationStage stages[] = {{1.5 * resolution, 4}, {resolution, 4}, {resolution / 2, 4}, {3 * spacing, 12}};
    const auto count = static_cast<double>(surface.samples().size());
    const auto share_on_target = [&](const RigidMotion& motion) {
        const Agreement on = agreement(surface, target_surface, motion, near_target * spacing, on_target * spacing);
        return static_cast<double>(on.close) / count;
    };
    const auto difference = [&](const RigidMotion& one, const RigidMotion& other) {
        return displacement(one, other, reduced_scan.extent.centre, reduced_scan.extent.radius);
    };
    const auto fitted = [&](std::vector<RigidMotion> starts) {
        std::vector<Pose> poses(starts.size());
        const Execution quiet;
        for_each_chunk(execution.threads(), starts.size(), 1, [&](std::size_t i, std::size_t) {
            execution.check_cancelled();
            const RigidMotion coarse = refined(reduced_scan, reduced_target, starts[i]);
            if (measured(reduced_scan, reduced_target, coarse).overlap < least_coarse_overlap) {
                poses[i] = {coarse, 0};
                return;
            }
            const RigidMotion fine =
                relaxed(surfaces, {RigidMotion(), coarse}, pairs, stages, 0.01 * spacing, quiet).poses[1];
            poses[i] = {fine, share_on_target(fine)};
        });
        return poses;
    };

    std::vector<RigidMotion> starts;
    if (scan.start) starts.push_back(*scan.start);
    for (const Candidate& candidate :
         registered_pair(reduced_scan, reduced_target, {params.overlap, params.seed_tries}).candidates)
        starts.push_back(candidate.motion);
    execution.progress(0.3);
    std::vector<Pose> poses = fitted(starts);
    if (poses.empty()) return result;
    const auto by_fit = [](const Pose& a, const Pose& b) { return a.fit > b.fit; };
    std::ranges::stable_sort(poses, by_fit);

    const PrincipalFrame frame = principal_frame(samples.points);
    starts.clear();
    for (const Eigen::Matrix3d& rotation : probe_rotations()) {
        const Eigen::Matrix3d turn = frame.axes * rotation * frame.axes.transpose();
        starts.push_back(poses[0].motion.then({turn, frame.centre - turn * frame.centre}));
    }
    const std::vector<Pose> probes = fitted(starts);
    poses.insert(poses.end(), probes.begin(), probes.end());
    std::ranges::stable_sort(poses, by_fit);
    execution.progress(0.9);

    // Different poses, the best first.
    std::vector<Pose> chosen;
    for (const Pose& pose : poses)
        if (std::ranges::all_of(chosen, [&](const Pose& better) {
                return difference(pose.motion, better.motion) > same_pose * resolution;
            }))
            chosen.push_back(pose);
    const double best = chosen[0].fit;
    const auto is_equal = [&](const Pose& pose) { return pose.fit >= equal_fit * best; };
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
        result.rival_pose = chosen[1].motion;
    }
    result.slide = measured(reduced_scan, reduced_target, result.pose).slide;
    execution.progress(1);
    if (result.fit < std::max(least_fit, params.overlap))
        result.refusal = TargetRefusal::no_fit;
    else if (result.slide < least_slide)
        result.refusal = TargetRefusal::slides;
    else if (result.rivals > 0 && !is_chosen_by_start)
        result.refusal = TargetRefusal::ambiguous;
    else
        result.refusal = TargetRefusal::none;
    return result;
}

}  // namespace scanmill
