// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Moves all views together until the points of each lie on the surfaces of the others.
///
/// Source: Chen and Medioni 1992 for point to plane; Chetverikov et al. 2002 for trimming.

#include <optional>
#include <span>
#include <vector>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/registration/projected_grid.hpp"
#include "scanmill/geometry/registration/rigid_motion.hpp"

namespace scanmill {

/// The points of a view with their normals, for searches from other views.
class ViewSurface {
public:
    /// Keeps each position once. Normals are those of the planes through `neighbours` other points, turned to the
    /// scanner: `to_scanner` has one direction for all points, or one for each. Chooses at most `most_samples` points,
    /// every k-th row, that are searched for in other views.
    /// Pre: finite points and directions. Cost: about 3 us per point for 24 neighbours.
    ViewSurface(std::span<const Vec3> points, std::span<const Vec3> to_scanner, std::size_t neighbours,
                std::size_t most_samples);

    /// A surface that stays, with given normals, one unit vector per point, and without samples. Pre: distinct points.
    ViewSurface(std::span<const Vec3> points, std::span<const Vec3> normals, double spacing);

    /// The same surface with at most `most_samples` of the samples, every k-th one.
    ViewSurface with_samples(std::size_t most_samples) const;

    std::span<const Vec3> points() const { return points_; }
    std::span<const Vec3> normals() const { return normals_; }
    /// Rows of `points`.
    std::span<const u32> samples() const { return samples_; }
    const ProjectedGrid& grid() const { return *grid_; }
    /// Median distance of a point from the nearest other one.
    double spacing() const { return spacing_; }
    /// Median over the points of the root mean square distance of the neighbours from their plane.
    double noise() const { return noise_; }

private:
    Array<Vec3> points_, normals_;
    Array<u32> samples_;
    double spacing_ = 0, noise_ = 0;
    std::optional<ProjectedGrid> grid_;
};

struct ViewPair {
    u32 first, second;
};

struct RelaxationStage {
    double tolerance;  ///< pairs of points farther apart do not count
    u32 most_rounds;
};

struct Relaxed {
    std::vector<RigidMotion> poses;
    /// By pair: number of points that have a partner within the last tolerance, and the sum of their squared distances
    /// from the partners' planes, after trimming.
    struct Residual {
        std::size_t points = 0;
        double squares = 0;
    };
    std::vector<Residual> residuals;
};

struct Agreement {
    std::size_t points = 0;  ///< samples with a partner within the tolerance
    std::size_t close = 0;  ///< of these, the ones at most `close` from the partner's plane
};

/// How many samples of `from` lie on the surface of `to`, and how many only near it. `motion` leads from the frame of
/// `from` to that of `to`; the product of the normals of partners is above 0.7.
Agreement agreement(const ViewSurface& from, const ViewSurface& to, const RigidMotion& motion, double tolerance,
                    double close);

/// Gauss-Newton steps for the poses of all views but the first. In each round every sample of both views of a pair is
/// joined to the nearest point of the other view, if it lies within the tolerance and the product of the normals is
/// above 0.7; the tenth of the joined points with the largest distances from their planes does not count. A stage ends
/// early when a step moves no view by more than `settled`.
///
/// Pre:  poses near the result; at least one view; the pairs connect all views.
/// Post: the first pose is kept. Bytes do not depend on the number of threads.
/// Cost: one search per sample and round at most; a search is left out where the motion since the last one cannot have
///       changed its result. One dense solution for 6 (views - 1) unknowns per round. Throws Cancelled.
Relaxed relaxed(std::span<const ViewSurface* const> views, std::vector<RigidMotion> poses,
                std::span<const ViewPair> pairs, std::span<const RelaxationStage> stages, double settled,
                const Execution& execution);

}  // namespace scanmill
