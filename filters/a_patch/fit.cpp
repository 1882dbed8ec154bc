// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/fit.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <limits>

#include "a_patch/block_system.hpp"
#include "a_patch/outliers.hpp"
#include "a_patch/slope_dependence.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::a_patches {

namespace {

using Vector2 = Eigen::Vector2d;
using Matrix2 = Eigen::Matrix2d;

constexpr std::size_t chunk = 1024;       // points
constexpr std::size_t rows_at_once = 256;  // tetrahedra
constexpr int rounds = 3;
constexpr double most_regularisation = 200;
constexpr double at_vertex = 1e-9;  // barycentric
constexpr double least_gradient = 0.5;  // lower bound of |grad F|: F is steeper near the surface
constexpr double least_share = 0.1;   // smallest share of the default value at an apex that an edge's function keeps
constexpr int most_sweeps = 200;
constexpr double relaxation = 1.5;  // needs a third of the sweeps of a relaxation by 1
constexpr double enough = 1e-6;  // sweeps end when no slope changes more
constexpr double smaller = 0.6;
constexpr int most_reductions = 20;

// Signs.

/// The condition along · x >= least.
struct Limit {
    Vector2 along;
    double least;
};
using Limits = std::array<Limit, 4>;

bool is_within(const Limits& limits, const Vector2& x) {
    return std::ranges::all_of(limits, [&](const Limit& limit) {
        const double value = limit.along.dot(x);
        return value - limit.least >= -1e-12 * (std::abs(value) + std::abs(limit.least));
    });
}

/// The x within the limits for which x · matrix · x / 2 - right · x is smallest. Pre: 0 is within the limits.
Vector2 least_within(const Matrix2& matrix, const Vector2& right, const Limits& limits) {
    const Vector2 free = matrix.inverse() * right;
    if (is_within(limits, free)) return free;
    Vector2 best = Vector2::Zero();
    double least = 0;
    const auto offer = [&](const Vector2& x) {
        const double value = x.dot(matrix * x) / 2 - right.dot(x);
        if (value < least && is_within(limits, x)) {
            least = value;
            best = x;
        }
    };
    for (std::size_t i = 0; i < limits.size(); ++i) {
        const Limit& one = limits[i];
        const Vector2 toward = matrix.inverse() * one.along;
        const double length = one.along.dot(toward);
        if (!(length > 0)) continue;
        offer(free + toward * ((one.least - one.along.dot(free)) / length));
        for (std::size_t j = 0; j < i; ++j) {
            Matrix2 both;
            both << one.along.transpose(), limits[j].along.transpose();
            if (both.determinant() != 0) offer(both.inverse() * Vector2(one.least, limits[j].least));
        }
    }
    return best;
}

/// The pairs of edges on whose slopes one tetrahedron may depend.
std::vector<std::pair<u32, u32>> pairs_of(const Hull& hull) {
    std::vector<std::pair<u32, u32>> pairs;
    const auto add = [&](std::span<const u32> edges) {
        for (const u32 a : edges)
            for (const u32 b : edges) pairs.emplace_back(a, b);
    };
    for (const HullFace& face : hull.faces) add(face.edges);
    for (const HullEdge& edge : hull.edges) {
        if (!edge.is_smooth()) continue;
        std::array<u32, 6> both;
        std::ranges::copy(hull.faces[edge.first].edges, both.begin());
        std::ranges::copy(hull.faces[edge.second].edges, both.begin() + 3);
        add(both);
    }
    return pairs;
}

class Fitter {
public:
    Fitter(Hull& hull, Weights weights, const LocatedPoints& points, Curvature curvature, const FitParams& params,
           const std::function<std::vector<u32>(const PatchComplex&)>& violating_triangles, Execution& execution)
        : hull_(hull),
          weights_(std::move(weights)),
          points_(points.points),
          curvature_(curvature),
          params_(params),
          violating_triangles_(violating_triangles),
          execution_(execution),
          free_(free_directions(hull)),
          system_(hull.edges.size(), pairs_of(hull)) {}

    FitResult fitted() {
        for (const HullEdge& edge : hull_.edges) defaults_.push_back(edge.slopes[0]);
        set_limits();
        find_rows();
        for (std::size_t row = 0; row < weights_.patches.tets.size(); ++row)
            wrong_before_.push_back(wrong_signs(weights_.patches, row));
        changes_.assign(hull_.edges.size(), Vector2::Zero());
        regularisation_.assign(hull_.edges.size(), params_.regularisation);
        if (points_.empty()) return {std::move(weights_), std::nullopt};
        for (int round = 0; round < rounds; ++round) {
            system_.clear();
            std::array<BlockSystem, 2> halves{system_, system_};
            add_points(halves);
            for (const BlockSystem& half : halves) system_.add(half);
            set_scale();
            if (round == 0) set_regularisation(halves);
            add_priors();
            solve();
            set_slopes();
        }
        reduce_changes();
        return {std::move(weights_), median(std::vector(regularisation_))};
    }

private:
    struct Row {
        std::size_t tet, begin, end;  ///< a tetrahedron, and the range of the points in it
    };

    void find_rows() {
        for (std::size_t begin = 0, end; begin < points_.size(); begin = end) {
            for (end = begin; end < points_.size() && points_[end].tet == points_[begin].tet;) ++end;
            rows_.push_back({points_[begin].tet, begin, end});
        }
    }

    struct Sample {
        double value;
        double slope;  ///< |grad F|
        /// Approximately the nearest point of the surface. For an outlier, a point on the way there.
        Barycentric foot;
        double distance() const { return std::abs(value) / slope; }
    };
    Sample sample(const PatchCell& cell, std::size_t point, double most) const {
        const Barycentric& at = points_[point].at;
        const double value = patch_value(weights_.patches.weights[points_[point].tet], at);
        const Vec3 gradient = cell.gradient(at);
        const double slope = std::max(least_gradient, gradient.norm());
        const double way = std::clamp(value / slope, -most, most);
        return {value, slope, cell.coordinates(cell.point(at) - way / slope * gradient)};
    }

    /// The contribution of the points in one tetrahedron to the system.
    struct Part {
        std::array<u32, SlopeDependence::most_edges> edges;
        std::size_t count;
        Eigen::Matrix<double, 10, 10> matrix;
        Eigen::Matrix<double, 10, 1> right;

        void add_to(BlockSystem& system) const {
            for (std::size_t a = 0; a < count; ++a) {
                const auto i = static_cast<Eigen::Index>(2 * a);
                system.right(edges[a]) += right.segment<2>(i);
                for (std::size_t b = 0; b < count; ++b)
                    system.block(edges[a], edges[b]) += matrix.block<2, 2>(i, static_cast<Eigen::Index>(2 * b));
            }
        }
    };

    /// Adds the contributions of the points. In every tetrahedron, the points go to the two halves alternately.
    void add_points(std::array<BlockSystem, 2>& halves) const {
        const std::vector<double> most = outlier_distances();
        using Parts = std::vector<std::array<Part, 2>>;
        for_each_in_order<Parts>(
            execution_.threads(), (rows_.size() + rows_at_once - 1) / rows_at_once,
            [&](std::size_t number, Parts& parts) {
                execution_.check_cancelled();
                parts.clear();
                for (std::size_t r = number * rows_at_once; r < std::min(rows_.size(), (number + 1) * rows_at_once);
                     ++r)
                    parts.push_back(parts_of(rows_[r], most[weights_.patches.triangles[rows_[r].tet]]));
            },
            [&](std::size_t, const Parts& parts) {
                for (const auto& part : parts)
                    for (std::size_t half = 0; half < 2; ++half) part[half].add_to(halves[half]);
            });
    }

    std::array<Part, 2> parts_of(const Row& row, double most) const {
        const PatchCell cell(weights_.patches, row.tet);
        const SlopeDependence dependence(hull_, free_, weights_.patches, row.tet);
        Part none;
        none.count = dependence.count();
        none.matrix.setZero();
        none.right.setZero();
        Eigen::Matrix<double, 10, 1> before = Eigen::Matrix<double, 10, 1>::Zero(), line = before;
        for (std::size_t n = 0; n < none.count; ++n) {
            none.edges[n] = dependence.edge(n);
            before.segment<2>(static_cast<Eigen::Index>(2 * n)) = changes_[none.edges[n]];
        }
        std::array<Part, 2> parts{none, none};
        for (std::size_t p = row.begin; p < row.end; ++p) {
            // At the foot point F is 0, so the derivative of F / |grad F| only needs the derivative of F. At the point
            // itself, a flatter F would count as a smaller distance.
            const Sample here = sample(cell, p, most);
            const auto derivatives = dependence.derivatives(here.foot);
            for (std::size_t n = 0; n < none.count; ++n)
                line.segment<2>(static_cast<Eigen::Index>(2 * n)) = derivatives[n];
            const double distance = here.distance();
            const double weight = (distance > most ? most / distance : 1) / (here.slope * here.slope);
            Part& part = parts[p % 2];
            part.matrix.noalias() += (weight * line) * line.transpose();
            part.right += (weight * (line.dot(before) - here.value)) * line;
        }
        return parts;
    }

    /// Sets `scale_` to the mean diagonal element of the points' matrix over the free components.
    void set_scale() {
        double trace = 0, count = 0;
        for (u32 e = 0; e < system_.size(); ++e) {
            trace += system_.block(e, e).trace();
            count += free_[e].squaredNorm();
        }
        scale_ = trace > 0 ? trace / count : 1;
    }

    /// By triangle: the distance beyond which its points are outliers. Points at a vertex do not count, because the
    /// surface passes through the vertices anyway.
    std::vector<double> outlier_distances() const {
        std::vector<double> found(points_.size());
        std::vector<u32> triangles(points_.size());
        for_each_chunk(execution_.threads(), rows_.size(), rows_at_once, [&](std::size_t begin, std::size_t end) {
            for (std::size_t r = begin; r < end; ++r) {
                const PatchCell cell(weights_.patches, rows_[r].tet);
                for (std::size_t p = rows_[r].begin; p < rows_[r].end; ++p) {
                    const bool is_vertex = points_[p].at.maxCoeff() > 1 - at_vertex;
                    found[p] = is_vertex ? no_distance : sample(cell, p, 0).distance();
                    triangles[p] = weights_.patches.triangles[rows_[r].tet];
                }
            }
        });
        std::vector<std::array<u32, 3>> neighbours(hull_.faces.size());
        for (u32 f = 0; f < hull_.faces.size(); ++f)
            for (std::size_t i = 0; i < 3; ++i) {
                const HullEdge& edge = hull_.edges[hull_.faces[f].edges[i]];
                neighbours[f][i] = edge.first == f ? edge.second : edge.first;
            }
        return a_patches::outlier_distances(found, triangles, neighbours);
    }

    void set_regularisation(const std::array<BlockSystem, 2>& halves) {
        std::vector<double> weights;
        for (double weight = params_.regularisation; weight < most_regularisation; weight *= 10)
            weights.push_back(weight);
        regularisation_ = best_weights(
            halves, points_.size(), weights,
            [&](BlockSystem& half, double weight) { half.add_to_diagonal(scale_ * weight); },
            [&](std::vector<Vector2>& changes) {
                for (u32 e = 0; e < changes.size(); ++e) move_within_limits(e, changes[e]);
            },
            execution_);
    }

    void add_priors() {
        for (u32 e = 0; e < system_.size(); ++e) system_.block(e, e).diagonal().array() += scale_ * regularisation_[e];
    }

    /// Limits each edge's changes so that its function keeps its sign, and a share of its value, at the apexes of the
    /// edge's triangles.
    void set_limits() {
        for (u32 e = 0; e < hull_.edges.size(); ++e) {
            const HullEdge& edge = hull_.edges[e];
            Limits limits;
            limits.fill({Vector2::Zero(), 0});
            std::size_t count = 0;
            for (const u32 f : {edge.first, edge.second}) {
                if (f == HullEdge::none) continue;
                for (const Side side : both_sides) {
                    const Vec3 apex = hull_.apex(f, side);
                    const double value = sign_of(side) * hull_.at_edge(f, hull_.number_in(e, f), apex);
                    limits[count++] = {sign_of(side) * (free_[e].transpose() * (apex - hull_.positions[edge.a])),
                                       (least_share - 1) * std::max(0.0, value)};
                }
            }
            limits_.push_back(limits);
        }
    }

    /// Finds the exact solution. If it violates limits, sweeps over the edges instead; each edge gets its best slope
    /// within its limits.
    void solve() {
        system_.solve(changes_, execution_);
        bool is_sound = true;
        for (u32 e = 0; e < system_.size(); ++e) is_sound = move_within_limits(e, changes_[e]) && is_sound;
        for (int sweep = 0; !is_sound && sweep < most_sweeps; ++sweep) {
            execution_.check_cancelled();
            double largest = 0;
            for (u32 e = 0; e < system_.size(); ++e) {
                const Matrix2& own = system_.block(e, e);
                const Vector2 right =
                    relaxation * system_.remainder(e, changes_) + (1 - relaxation) * (own * changes_[e]);
                const Vector2 x = least_within(own, right, limits_[e]);
                largest = std::max(largest, (x - changes_[e]).norm());
                changes_[e] = x;
            }
            if (largest < enough) break;
        }
    }

    /// Shortens an edge's change that is beyond the edge's limits. Returns whether the change was within them.
    bool move_within_limits(u32 e, Vector2& change) const {
        if (is_within(limits_[e], change)) return true;
        double share = 1;
        for (const Limit& limit : limits_[e]) {
            const double value = limit.along.dot(change);
            if (value < limit.least) share = std::min(share, limit.least / value);
        }
        change *= share;
        return false;
    }

    void set_slopes() {
        for (std::size_t e = 0; e < changes_.size(); ++e)
            if (!hull_.edges[e].is_sharp) hull_.edges[e].slopes.fill(defaults_[e] + free_[e] * changes_[e]);
        weights_ = make_weights(hull_, curvature_, execution_);
    }

    /// Marks the changed edges that cause violations; violations that the default slopes had do not count.
    std::vector<bool> wrong_edges() const {
        std::vector<bool> is_wrong(changes_.size(), false);
        const auto add = [&](u32 e) { is_wrong[e] = changes_[e] != Vector2::Zero(); };
        for (std::size_t row = 0; row < wrong_before_.size(); ++row) {
            if (wrong_signs(weights_.patches, row) <= wrong_before_[row]) continue;
            const SlopeDependence dependence(hull_, free_, weights_.patches, row);
            for (std::size_t n = 0; n < dependence.count(); ++n) add(dependence.edge(n));
        }
        for (const u32 f : violating_triangles_(weights_.patches))
            for (const u32 e : hull_.faces[f].edges) add(e);
        return is_wrong;
    }

    void reduce_changes() {
        for (int round = 0;; ++round) {
            execution_.check_cancelled();
            const std::vector<bool> is_wrong = wrong_edges();
            if (std::ranges::find(is_wrong, true) == is_wrong.end()) return;
            for (std::size_t e = 0; e < changes_.size(); ++e)
                if (is_wrong[e]) changes_[e] *= round < most_reductions ? smaller : 0;
            set_slopes();
        }
    }

    Hull& hull_;
    Weights weights_;
    const std::vector<LocatedPoints::Point>& points_;
    Curvature curvature_;
    FitParams params_;
    std::vector<double> regularisation_;  ///< by edge
    double scale_ = 1;
    const std::function<std::vector<u32>(const PatchComplex&)>& violating_triangles_;
    Execution& execution_;
    std::vector<Directions> free_;
    BlockSystem system_;
    std::vector<Vec3> defaults_;
    std::vector<Limits> limits_;
    std::vector<Row> rows_;
    std::vector<std::size_t> wrong_before_;
    std::vector<Vector2> changes_;
};

}  // namespace

LocatedPoints locate(const PatchComplex& patches, std::span<const Vec3> points, Execution& execution) {
    const PatchSurface surface(patches, execution.threads());
    constexpr u32 none = ~u32(0);
    std::vector<u32> tets(points.size());
    for_each_chunk(execution.threads(), points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) tets[i] = surface.locate(points[i]).value_or(none);
    });
    std::vector<std::size_t> first(patches.tets.size() + 1, 0);
    for (const u32 tet : tets)
        if (tet != none) ++first[tet + 1];
    for (std::size_t tet = 0; tet < patches.tets.size(); ++tet) first[tet + 1] += first[tet];
    LocatedPoints located;
    located.points.resize(first.back());
    located.left_out = points.size() - located.points.size();
    for (u32 i = 0; i < points.size(); ++i)
        if (tets[i] != none) located.points[first[tets[i]]++] = {i, tets[i], Barycentric::Zero()};
    for_each_chunk(execution.threads(), located.points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t i = begin; i < end; ++i) {
            auto& point = located.points[i];
            point.at = surface.cell(point.tet).coordinates(points[point.row]);
        }
    });
    return located;
}

FitResult fit(Hull& hull, Weights weights, const LocatedPoints& points, Curvature curvature, const FitParams& params,
              const std::function<std::vector<u32>(const PatchComplex&)>& violating_triangles, Execution& execution) {
    return Fitter(hull, std::move(weights), points, curvature, params, violating_triangles, execution).fitted();
}

PointDistances distances(const Hull& hull, const PatchComplex& patches, std::span<const Vec3> points,
                         const LocatedPoints& located, Execution& execution) {
    const PatchSurface surface(patches, execution.threads());
    const TriangleTree mesh(hull.positions, hull.triangles, execution.threads());
    PointDistances result{std::vector<double>(located.points.size()), std::vector<double>(located.points.size())};
    for_each_chunk(execution.threads(), located.points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        u32 hint = NearestTriangle::none;
        for (std::size_t i = begin; i < end; ++i) {
            const auto& point = located.points[i];
            const Vec3& p = points[point.row];
            const NearestTriangle nearest = mesh.nearest(p, hint);
            hint = nearest.slot;
            result.to_mesh[i] = std::sqrt(nearest.squared_distance);
            if (const auto foot = surface.foot(p, mesh.nearest_point(p, hint))) {
                result.to_surface[i] = std::abs(foot->distance);
            } else {
                // There is no foot point near the boundary of an open surface.
                const PatchCell cell = surface.cell(point.tet);
                result.to_surface[i] = std::abs(cell.value(p)) / std::max(least_gradient, cell.gradient(p).norm());
            }
        }
    });
    return result;
}

}  // namespace scanmill::a_patches
