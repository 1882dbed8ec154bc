// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/normal_fit.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "a_patch/block_system.hpp"
#include "a_patch/normals.hpp"
#include "a_patch/outliers.hpp"
#include "a_patch/repair.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/distance/nearest_distances.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr std::size_t rows_at_once = 256;  // triangles
constexpr int rounds = 3;
constexpr std::array<double, 6> weights{1e-3, 1e-2, 0.1, 1, 10, 100};
constexpr double at_vertex = 1e-9;  // barycentric
constexpr double least_gradient = 0.5;  // lower bound of a gradient's length; it is the mean of three unit vectors
constexpr int most_halvings = 30;

class NormalFitter {
public:
    NormalFitter(PatchMesh& mesh, std::span<const Vec3> points, Execution& execution)
        : mesh_(mesh),
          execution_(execution),
          sectors_(sectors_of(mesh.mesh)),
          corners_(corners_of(sectors_)),
          system_(sectors_.size(), pairs()) {
        for (const auto& corners : corners_) given_.push_back(mesh.normals[corners[0] / 3][corners[0] % 3]);
        normals_ = given_;
        const Array<u32> opposites = half_edges::opposites(mesh.mesh);
        for (std::size_t half = 0; half < opposites.size(); half += 3)
            neighbours_.push_back({opposites[half] / 3, opposites[half + 1] / 3, opposites[half + 2] / 3});
        find_points(points);
    }

    void fit() {
        if (points_.empty()) return;
        for (int round = 0; round < rounds; ++round) {
            set_axes();
            std::array<BlockSystem, 2> halves{system_, system_};
            for (BlockSystem& half : halves) half.clear();
            add_points(halves);
            system_ = halves[0];
            system_.add(halves[1]);
            set_scale();
            if (round == 0)
                best_ = best_weights(
                    halves, points_.size(), weights,
                    [&](BlockSystem& half, double weight) {
                        for (u32 s = 0; s < half.size(); ++s) add_prior(half, s, weight);
                    },
                    [](std::vector<Vector2>&) {}, execution_);
            changes_.assign(sectors_.size(), Vector2::Zero());
            for (u32 s = 0; s < system_.size(); ++s) add_prior(system_, s, best_[s]);
            system_.solve(changes_, execution_);
            move();
        }
        for (std::size_t s = 0; s < corners_.size(); ++s)
            for (const u32 corner : corners_[s]) mesh_.normals[corner / 3][corner % 3] = normals_[s];
    }

private:
    using Vector2 = Eigen::Vector2d;
    using Axes = Eigen::Matrix<double, 3, 2>;

    /// A point over its nearest triangle. F is the sum of n · arm over the corners.
    /// The gradient of F is about the sum of n · share.
    struct Point {
        u32 triangle;
        std::array<Vec3, 3> arms;
        Vec3 shares;
    };

    std::vector<std::pair<u32, u32>> pairs() const {
        std::vector<std::pair<u32, u32>> pairs;
        for (const auto& of_triangle : sectors_.of_corner)
            for (const u32 a : of_triangle)
                for (const u32 b : of_triangle) pairs.emplace_back(a, b);
        return pairs;
    }

    void find_points(std::span<const Vec3> points) {
        const std::span positions = mesh_.mesh.positions.span();
        const std::span triangles = mesh_.mesh.triangles.span();
        const TriangleTree tree(positions, triangles, execution_.threads());
        const NearestDistances nearest = nearest_distances(points, tree, 0, execution_);
        std::vector<std::size_t> first(triangles.size() + 1, 0);
        const auto is_near = [&](std::size_t i) {
            const Triangle& t = triangles[nearest.triangles[i]];
            const Vec3 &a = positions[t[0]], &b = positions[t[1]], &c = positions[t[2]];
            const double radius = area_vector(a, b, c).norm() / ((b - a).norm() + (c - b).norm() + (a - c).norm());
            return nearest.distances[i] <= radius;
        };
        std::vector<u8> counts(points.size());
        for (std::size_t i = 0; i < points.size(); ++i) {
            counts[i] = is_near(i);
            first[nearest.triangles[i] + 1] += counts[i];
        }
        for (std::size_t f = 0; f < triangles.size(); ++f) first[f + 1] += first[f];
        points_.resize(first.back());
        first_ = first;
        for (std::size_t i = 0; i < points.size(); ++i) {
            if (!counts[i]) continue;
            const u32 f = nearest.triangles[i];
            points_[first[f]++] = over_triangle(f, points[i], tree.nearest_point(points[i], nearest.slots[i]));
        }
    }

    Point over_triangle(u32 f, const Vec3& point, const Vec3& foot) const {
        const Triangle& t = mesh_.mesh.triangles[f];
        const std::array<Vec3, 3> p{mesh_.mesh.positions[t[0]], mesh_.mesh.positions[t[1]], mesh_.mesh.positions[t[2]]};
        const Vec3 across = area_vector(p[0], p[1], p[2]);
        Point result{f, {}, {}};
        for (std::size_t i = 0; i < 3; ++i)
            result.shares[static_cast<Eigen::Index>(i)] = std::clamp(
                across.dot((p[(i + 1) % 3] - foot).cross(p[(i + 2) % 3] - foot)) / across.squaredNorm(), 0.0, 1.0);
        const Vec3& s = result.shares;
        const double middle = s.prod() / 2;
        for (std::size_t i = 0; i < 3; ++i) {
            Vec3& arm = result.arms[i];
            const double own = s[static_cast<Eigen::Index>(i)];
            arm = own * (point - foot);
            for (const std::size_t j : {(i + 1) % 3, (i + 2) % 3})
                arm += (own * own * s[static_cast<Eigen::Index>(j)] + middle) * (p[j] - p[i]);
        }
        return result;
    }

    /// The value of F, and the length of its gradient or least_gradient if that is larger.
    std::pair<double, double> value(const Point& point) const {
        double value = 0;
        Vec3 gradient = Vec3::Zero();
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& n = normals_[sectors_.of_corner[point.triangle][i]];
            value += n.dot(point.arms[i]);
            gradient += n * point.shares[static_cast<Eigen::Index>(i)];
        }
        return {value, std::max(least_gradient, gradient.norm())};
    }

    /// By triangle: the distance beyond which its points are outliers. Points at a vertex do not count, because the
    /// surface passes through the vertices anyway.
    std::vector<double> outlier_distances() const {
        std::vector<double> found;
        std::vector<u32> triangles;
        for (const Point& point : points_) {
            const auto [value, slope] = this->value(point);
            found.push_back(point.shares.maxCoeff() > 1 - at_vertex ? no_distance : std::abs(value) / slope);
            triangles.push_back(point.triangle);
        }
        return a_patches::outlier_distances(found, triangles, neighbours_);
    }

    /// Sets, for each normal, the two directions along which it changes.
    void set_axes() {
        axes_.clear();
        for (const Vec3& n : normals_) {
            Axes axes = Axes::Zero();
            if (n != Vec3::Zero()) {
                axes.col(0) = perpendicular(n);
                axes.col(1) = n.cross(axes.col(0));
            }
            axes_.push_back(axes);
        }
    }

    /// The contribution of the points over one triangle to the system.
    struct Part {
        Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
        Eigen::Matrix<double, 6, 1> right = Eigen::Matrix<double, 6, 1>::Zero();
    };

    /// Adds the contributions of the points. In every triangle, the points go to the two halves alternately.
    void add_points(std::array<BlockSystem, 2>& halves) const {
        const std::vector<double> most = outlier_distances();
        using Parts = std::vector<std::array<Part, 2>>;
        const std::size_t triangles = mesh_.mesh.triangles.size();
        for_each_in_order<Parts>(
            execution_.threads(), (triangles + rows_at_once - 1) / rows_at_once,
            [&](std::size_t number, Parts& parts) {
                execution_.check_cancelled();
                parts.clear();
                for (std::size_t f = number * rows_at_once; f < std::min(triangles, (number + 1) * rows_at_once); ++f)
                    parts.push_back(parts_of(f, most[f]));
            },
            [&](std::size_t number, const Parts& parts) {
                for (std::size_t n = 0; n < parts.size(); ++n)
                    for (std::size_t half = 0; half < 2; ++half)
                        add(halves[half], number * rows_at_once + n, parts[n][half]);
            });
    }

    void add(BlockSystem& system, std::size_t f, const Part& part) const {
        for (std::size_t a = 0; a < 3; ++a) {
            const u32 row = sectors_.of_corner[f][a];
            const auto i = static_cast<Eigen::Index>(2 * a);
            system.right(row) += part.right.segment<2>(i);
            for (std::size_t b = 0; b < 3; ++b)
                system.block(row, sectors_.of_corner[f][b]) +=
                    part.matrix.block<2, 2>(i, static_cast<Eigen::Index>(2 * b));
        }
    }

    std::array<Part, 2> parts_of(std::size_t f, double most) const {
        std::array<Part, 2> parts;
        Eigen::Matrix<double, 6, 1> line;
        for (std::size_t p = first_[f]; p < first_[f + 1]; ++p) {
            const Point& point = points_[p];
            const auto [value, slope] = this->value(point);
            for (std::size_t i = 0; i < 3; ++i)
                line.segment<2>(static_cast<Eigen::Index>(2 * i)) =
                    axes_[sectors_.of_corner[f][i]].transpose() * point.arms[i];
            const double distance = std::abs(value) / slope;
            const double weight = (distance > most ? most / distance : 1) / (slope * slope);
            parts[p % 2].matrix.noalias() += (weight * line) * line.transpose();
            parts[p % 2].right -= weight * value * line;
        }
        return parts;
    }

    /// Sets `scale_` to the mean diagonal element of the points' matrix over the free components.
    void set_scale() {
        double trace = 0, count = 0;
        for (u32 s = 0; s < system_.size(); ++s) {
            trace += system_.block(s, s).trace();
            count += axes_[s].squaredNorm();
        }
        scale_ = trace > 0 ? trace / count : 1;
    }

    void add_prior(BlockSystem& system, u32 s, double weight) const {
        system.block(s, s).diagonal().array() += scale_ * weight;
        system.right(s) += scale_ * weight * (axes_[s].transpose() * (given_[s] - normals_[s]));
    }

    void move() {
        const std::vector<Vec3> of_triangles = triangle_normals(mesh_.mesh);
        for (std::size_t s = 0; s < corners_.size(); ++s) {
            if (changes_[s] == Vector2::Zero()) continue;
            const std::vector<Vec3> around = normals_at(corners_[s], of_triangles);
            for (int halvings = 0; halvings < most_halvings; ++halvings, changes_[s] /= 2) {
                const Vec3 turned = (normals_[s] + axes_[s] * changes_[s]).normalized();
                if (opposes(turned, around)) continue;
                normals_[s] = turned;
                break;
            }
        }
    }

    PatchMesh& mesh_;
    Execution& execution_;
    Sectors sectors_;
    std::vector<std::vector<u32>> corners_;
    BlockSystem system_;
    std::vector<std::array<u32, 3>> neighbours_;  ///< by triangle
    std::vector<Vec3> given_, normals_;
    std::vector<Axes> axes_;
    std::vector<Point> points_;  ///< ordered by triangle
    std::vector<std::size_t> first_;
    std::vector<Vector2> changes_;
    std::vector<double> best_;  ///< by sector: the weight it chose
    double scale_ = 1;
};

}  // namespace

void fit_normals(PatchMesh& mesh, std::span<const Vec3> points, Execution& execution) {
    NormalFitter(mesh, points, execution).fit();
}

}  // namespace scanmill::a_patches
