// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/registration/relaxation.hpp"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/registration/plane_equations.hpp"

namespace scanmill {

namespace {

constexpr double least_product = 0.7;  ///< of the normals of two joined points
constexpr double trimmed_share = 0.1;
/// Added to the diagonal as a share of its mean, so that views that slide on others stay where they are.
constexpr double ridge = 1e-9;

/// Few walls of parts are parallel to this direction, so few points are behind each other along it.
const Vec3 oblique = Vec3(0.36, 0.48, 0.8);

/// The edge of cells for points whose spacing is 0.
double least_edge(std::span<const Vec3> points) {
    constexpr double cells_per_diagonal = 1e6;
    return std::max(bounding_box(points).diagonal() / cells_per_diagonal, std::numeric_limits<double>::min());
}

/// The joined points of one view of a pair in the other view, kept from round to round.
class Joins {
public:
    Joins(const ViewSurface& from, const ViewSurface& to) : from_(&from), to_(&to), states_(from.samples().size()) {}

    /// The samples on the planes of the other view, in its frame. Residuals beyond the trimmed share are left out.
    std::vector<PlanePair> pairs(const RigidMotion& motion, double tolerance) {
        std::vector<PlanePair> found;
        Array<double> magnitudes;
        for (std::size_t i = 0; i < states_.size(); ++i) {
            const u32 sample = from_->samples()[i];
            const Vec3 point = motion.apply(from_->points()[sample]);
            State& state = states_[i];
            search(point, tolerance, state);
            if (state.nearest == ProjectedGrid::Nearest::none) continue;
            const Vec3 away = point - to_->points()[state.nearest];
            if (!(away.squaredNorm() <= tolerance * tolerance)) continue;
            const Vec3& normal = to_->normals()[state.nearest];
            if (!(motion.turned(from_->normals()[sample]).dot(normal) > least_product)) continue;
            found.push_back({point, normal, away.dot(normal)});
            magnitudes.push_back(std::abs(found.back().residual));
        }
        if (found.empty()) return found;
        const double limit = quantile(magnitudes, 1 - trimmed_share);
        std::erase_if(found, [&](const PlanePair& pair) { return std::abs(pair.residual) > limit; });
        return found;
    }

private:
    struct State {
        Vec3 point;  ///< where the last search was
        u32 nearest = ProjectedGrid::Nearest::none;
        double distance = 0;  ///< of the nearest point from there; without one, the limit of the search
        double margin = -1;  ///< a point that has moved by less has the same nearest point
    };

    /// Searches again, unless the last search decides.
    void search(const Vec3& point, double tolerance, State& state) const {
        // Beyond the tolerance, so that points without a partner may move before they are searched again.
        constexpr double widening = 1.25;
        double guess = to_->grid().edge();
        if (state.margin >= 0) {
            const double moved = (point - state.point).norm();
            if (moved < state.margin || state.distance - moved > tolerance) return;
            if (state.nearest != ProjectedGrid::Nearest::none)
                guess = (point - to_->points()[state.nearest]).norm() + to_->spacing();
        }
        const ProjectedGrid::Nearest found = to_->grid().nearest(point, guess, widening * tolerance);
        state = {point, found.row, found.distance, (found.second - found.distance) / 2};
    }

    const ViewSurface* from_;
    const ViewSurface* to_;
    std::vector<State> states_;
};

/// Sums over the joined points of a pair, in world coordinates, with J = ((p - centre) × n / radius, n).
struct PairSums {
    Matrix6 matrix = Matrix6::Zero();
    Vector6 gradient = Vector6::Zero();
    Relaxed::Residual residual;
};

class Relaxation {
public:
    Relaxation(std::span<const ViewSurface* const> views, std::vector<RigidMotion> poses,
               std::span<const ViewPair> pairs, const Execution& execution)
        : pairs_(pairs),
          execution_(execution),
          poses_(std::move(poses)),
          sums_(2 * pairs.size()) {
        for (const ViewPair& pair : pairs) {
            joins_.emplace_back(*views[pair.first], *views[pair.second]);
            joins_.emplace_back(*views[pair.second], *views[pair.first]);
        }
        Vec3 sum = Vec3::Zero();
        for (std::size_t view = 0; view < poses_.size(); ++view) {
            const BoundingBox box = bounding_box(views[view]->points());
            const Vec3 middle = poses_[view].apply((box.low + box.high) / 2);
            radius_ = std::max(radius_, box.diagonal() / 2);
            sum += middle;
        }
        centre_ = sum / static_cast<double>(poses_.size());
    }

    void run(const RelaxationStage& stage, double settled) {
        for (u32 round = 0; round < stage.most_rounds; ++round) {
            execution_.check_cancelled();
            collect(stage.tolerance);
            if (move() <= settled) return;
        }
    }
    void collect(double tolerance) {
        for_each_chunk(execution_.threads(), joins_.size(), 1, [&](std::size_t i, std::size_t) {
            const ViewPair& pair = pairs_[i / 2];
            const bool is_back = i % 2 == 1;
            const RigidMotion &from = poses_[is_back ? pair.second : pair.first],
                              &to = poses_[is_back ? pair.first : pair.second];
            sums_[i] = PairSums();
            for (const PlanePair& joined : joins_[i].pairs(from.then(to.inverse()), tolerance)) {
                const Vec3 point = to.apply(joined.point), normal = to.turned(joined.normal);
                Vector6 j;
                j << (point - centre_).cross(normal) / radius_, normal;
                sums_[i].matrix += j * j.transpose();
                sums_[i].gradient += j * joined.residual;
                ++sums_[i].residual.points;
                sums_[i].residual.squares += joined.residual * joined.residual;
            }
        });
    }
    Relaxed result() const {
        Relaxed relaxed{poses_, {}};
        for (std::size_t i = 0; i < pairs_.size(); ++i) {
            const auto &one = sums_[2 * i].residual, &other = sums_[2 * i + 1].residual;
            relaxed.residuals.push_back({one.points + other.points, one.squares + other.squares});
        }
        return relaxed;
    }

private:
    /// Moving the view with the points changes a residual by J x, moving the view with the planes by -J x. Returns a
    /// bound of the largest motion of a point.
    double move() {
        const Eigen::Index size = 6 * static_cast<Eigen::Index>(poses_.size());
        Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(size, size);
        Eigen::VectorXd gradient = Eigen::VectorXd::Zero(size);
        for (std::size_t i = 0; i < sums_.size(); ++i) {
            const ViewPair& pair = pairs_[i / 2];
            const bool is_back = i % 2 == 1;
            const Eigen::Index from = 6 * static_cast<Eigen::Index>(is_back ? pair.second : pair.first),
                               to = 6 * static_cast<Eigen::Index>(is_back ? pair.first : pair.second);
            matrix.block<6, 6>(from, from) += sums_[i].matrix;
            matrix.block<6, 6>(to, to) += sums_[i].matrix;
            matrix.block<6, 6>(from, to) -= sums_[i].matrix;
            matrix.block<6, 6>(to, from) -= sums_[i].matrix;
            gradient.segment<6>(from) += sums_[i].gradient;
            gradient.segment<6>(to) -= sums_[i].gradient;
        }
        const Eigen::Index free = size - 6;
        if (free == 0 || !(matrix.trace() > 0)) return 0;
        matrix.diagonal().array() += ridge * matrix.trace() / static_cast<double>(size);
        const Eigen::VectorXd step = -matrix.bottomRightCorner(free, free).ldlt().solve(gradient.tail(free));
        if (!step.allFinite()) return 0;
        double largest = 0;
        for (std::size_t view = 1; view < poses_.size(); ++view) {
            const Vector6 x = step.segment<6>(6 * static_cast<Eigen::Index>(view) - 6);
            poses_[view] = orthonormal(poses_[view].then(small_motion(x.head<3>() / radius_, centre_, x.tail<3>())));
            largest = std::max(largest, x.head<3>().norm() + x.tail<3>().norm());
        }
        return largest;
    }

    std::span<const ViewPair> pairs_;
    const Execution& execution_;
    std::vector<RigidMotion> poses_;
    std::vector<Joins> joins_;  ///< two per pair
    std::vector<PairSums> sums_;
    Vec3 centre_ = Vec3::Zero();
    double radius_ = 0;
};

}  // namespace

ViewSurface::ViewSurface(std::span<const Vec3> points, std::span<const Vec3> to_scanner, std::size_t neighbours,
                         std::size_t most_samples) {
    const PointTree tree(points);
    Array<Vec3> outside(tree.positions().size(), to_scanner[0]);
    if (to_scanner.size() > 1)  // of equal positions the lower row counts
        for (std::size_t row = points.size(); row-- > 0;) outside[tree.index_of_row()[row]] = to_scanner[row];
    points_.assign(tree.positions().begin(), tree.positions().end());
    normals_.resize(points_.size());
    Array<double> distances(points_.size(), 0), variances(points_.size(), 0);
    Array<Vec3> around;
    tree.for_each_nearest(neighbours, 1, [&](const NeighbourBatch& batch) {
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const u32 index = batch.indices[i];
            around.clear();
            around.push_back(Vec3::Zero());
            for (const Neighbour& n : batch.of(i)) around.push_back(points_[n.index] - points_[index]);
            const Scatter scatter = scatter_of(around);
            normals_[index] = scatter.normal.dot(outside[index]) < 0 ? Vec3(-scatter.normal) : scatter.normal;
            double squares = 0;
            for (const Vec3& p : around) squares += (p - scatter.centroid).squaredNorm();
            variances[index] = scatter.surface_variation * squares / static_cast<double>(around.size());
            if (batch.each > 0) distances[index] = std::sqrt(batch.of(i)[0].squared);
        }
    });
    if (!distances.empty()) spacing_ = median(distances), noise_ = std::sqrt(median(variances));
    // Along the rows and not along the order of the tree: the same points when the view is turned.
    const std::size_t count = std::min(most_samples, points.size());
    for (std::size_t i = 0; i < count; ++i) samples_.push_back(tree.index_of_row()[i * points.size() / count]);
    // Two spacings: a few points per cell.
    grid_.emplace(points_, to_scanner.size() > 1 ? oblique : to_scanner[0],
                  2 * std::max(spacing_, least_edge(points_)));
}

ViewSurface::ViewSurface(std::span<const Vec3> points, std::span<const Vec3> normals, double spacing)
    : points_(points.begin(), points.end()),
      normals_(normals.begin(), normals.end()),
      spacing_(spacing),
      grid_(std::in_place, points, oblique, 2 * std::max(spacing, least_edge(points))) {}

ViewSurface ViewSurface::with_samples(std::size_t most_samples) const {
    ViewSurface result = *this;
    const std::size_t count = std::min(most_samples, samples_.size());
    result.samples_.clear();
    for (std::size_t i = 0; i < count; ++i) result.samples_.push_back(samples_[i * samples_.size() / count]);
    return result;
}

Agreement agreement(const ViewSurface& from, const ViewSurface& to, const RigidMotion& motion, double tolerance,
                    double close) {
    Agreement counts;
    for (const u32 sample : from.samples()) {
        const Vec3 point = motion.apply(from.points()[sample]);
        const u32 partner = to.grid().nearest(point, to.grid().edge(), tolerance).row;
        if (partner == ProjectedGrid::Nearest::none) continue;
        const Vec3& normal = to.normals()[partner];
        if (!(motion.turned(from.normals()[sample]).dot(normal) > least_product)) continue;
        ++counts.points;
        counts.close += std::abs((point - to.points()[partner]).dot(normal)) <= close;
    }
    return counts;
}

Relaxed relaxed(std::span<const ViewSurface* const> views, std::vector<RigidMotion> poses,
                std::span<const ViewPair> pairs, std::span<const RelaxationStage> stages, double settled,
                const Execution& execution) {
    Relaxation relaxation(views, std::move(poses), pairs, execution);
    for (const RelaxationStage& stage : stages) relaxation.run(stage, settled);
    if (!stages.empty()) relaxation.collect(stages.back().tolerance);
    return relaxation.result();
}

}  // namespace scanmill
