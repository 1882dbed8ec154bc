// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/fit/local_surface.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <utility>

#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/fit/quadric.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr std::size_t fewest_samples = 6;
constexpr double most_deviations = 3;
/// Least ratio of squared width to squared length. A narrower neighbourhood (about 1/30) determines only a curve.
constexpr double least_flatness = 1e-3;

/// Expresses all offsets except number `origin` relative to it, in a frame of the plane.
void take_samples(std::span<const Vec3> offsets, std::size_t origin, const Vec3& normal,
                  Array<QuadricSample>& samples) {
    const auto [along, across] = directions_across(normal);
    samples.clear();
    double sum = 0;
    for (std::size_t i = 0; i < offsets.size(); ++i) {
        if (i == origin) continue;
        const Vec3 offset = offsets[i] - offsets[origin];
        const double u = offset.dot(along), v = offset.dot(across);
        samples.push_back({u, v, offset.dot(normal), u * u + v * v});
        sum += u * u + v * v;
    }
    const double mean = sum / static_cast<double>(samples.size());
    for (QuadricSample& sample : samples) sample.weight = 1 / (sample.weight + mean);
}

double error_of(const QuadricSample& sample, const Quadric& quadric) {
    return sample.s - quadric.at(sample.u, sample.v);
}

double mean_error(std::span<const QuadricSample> samples, const Quadric& quadric) {
    double sum = 0;
    for (const QuadricSample& sample : samples) sum += std::abs(error_of(sample, quadric));
    return sum / static_cast<double>(samples.size());
}

/// Repeats the fit without outliers; returns their number.
u32 reject_outliers(std::span<const QuadricSample> samples, Inclination inclination, Array<QuadricSample>& kept,
                    Quadric& quadric) {
    double squares = 0;
    for (const QuadricSample& sample : samples) squares += error_of(sample, quadric) * error_of(sample, quadric);
    const double variance = squares / static_cast<double>(samples.size() - 5);
    const double most = most_deviations * most_deviations * variance;
    const auto is_outlier = [&](const QuadricSample& sample) {
        return error_of(sample, quadric) * error_of(sample, quadric) > most;
    };
    kept.clear();
    for (const QuadricSample& sample : samples)
        if (!is_outlier(sample)) kept.push_back(sample);
    if (kept.size() == samples.size() || kept.size() < fewest_samples) return 0;
    const std::optional<Quadric> without = fit_quadric(kept, inclination);
    if (!without) return 0;
    quadric = *without;
    return static_cast<u32>(samples.size() - kept.size());
}

/// Reusable memory of a fit.
struct Fit {
    Array<Vec3> neighbours, offsets;
    Array<QuadricSample> samples, kept;
};

std::size_t nearest_to(const Vec3& centre, std::span<const Vec3> points) {
    std::size_t best = 0;
    for (std::size_t i = 1; i < points.size(); ++i)
        if ((points[i] - centre).squaredNorm() < (points[best] - centre).squaredNorm()) best = i;
    return best;
}

LocalSurface fitted(const Vec3& point, std::span<const Vec3> neighbours, LocalSurfaceParams::Origin origin, Fit& fit) {
    fit.offsets.assign(1, Vec3::Zero());
    for (const Vec3& neighbour : neighbours) fit.offsets.push_back(neighbour - point);
    const Scatter scatter = scatter_of(fit.offsets);
    LocalSurface surface;
    surface.normal = scatter.normal;
    const bool at_point = origin == LocalSurfaceParams::Origin::nearest;
    const std::size_t from = at_point ? 0 : nearest_to(scatter.centroid, fit.offsets);
    const Inclination inclination = at_point ? Inclination::none : Inclination::free;
    take_samples(fit.offsets, from, scatter.normal, fit.samples);
    Quadric quadric;
    if (fit.samples.size() >= fewest_samples && scatter.flatness > least_flatness)
        if (const std::optional<Quadric> first = fit_quadric(fit.samples, inclination)) {
            surface.is_curved = true;
            quadric = *first;
            surface.outliers = reject_outliers(fit.samples, inclination, fit.kept, quadric);
            const auto [along, across] = directions_across(scatter.normal);
            surface.normal = with_positive_sign((scatter.normal - quadric.d * along - quadric.e * across).normalized());
            const PrincipalCurvatures curvatures = principal_curvatures(quadric);
            const double sign = surface.normal.dot(scatter.normal) < 0 ? -1 : 1;
            surface.first_curvature = sign * curvatures.first;
            surface.second_curvature = sign * curvatures.second;
        }
    if (fit.offsets.size() > 1) surface.spacing = std::sqrt(fit.offsets[1].squaredNorm());
    if (!fit.samples.empty()) surface.fit_error = mean_error(fit.samples, quadric);
    return surface;
}

}  // namespace

LocalSurface local_surface(const Vec3& point, std::span<const Vec3> neighbours, LocalSurfaceParams::Origin origin) {
    Fit fit;
    return fitted(point, neighbours, origin, fit);
}

Array<LocalSurface> local_surfaces(const PointTree& tree, const LocalSurfaceParams& params,
                                   const Execution& execution) {
    const std::span<const Vec3> positions = tree.positions();
    Array<LocalSurface> surfaces(positions.size());
    tree.for_each_nearest(params.neighbours, execution.threads(), [&](const NeighbourBatch& batch) {
        execution.check_cancelled();
        Fit fit;
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const u32 index = batch.indices[i];
            fit.neighbours.clear();
            for (const Neighbour& neighbour : batch.of(i)) fit.neighbours.push_back(positions[neighbour.index]);
            surfaces[index] = fitted(positions[index], fit.neighbours, params.origin, fit);
        }
    });
    return surfaces;
}

}  // namespace scanmill
