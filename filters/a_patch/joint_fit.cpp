// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/joint_fit.hpp"

#include <Eigen/Geometry>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <optional>

#include "a_patch/evening.hpp"
#include "a_patch/facet_height.hpp"
#include "a_patch/normals.hpp"
#include "a_patch/outliers.hpp"
#include "a_patch/refinement.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/spatial/lists.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

using Matrix = FacetHeight::Matrix;
using Numbers = FacetHeight::Numbers;
using Sparse = Eigen::SparseMatrix<double>;
using Vector = Eigen::VectorXd;

constexpr std::size_t chunk = 1024, facets_at_once = 256;
constexpr u32 none = ~u32(0);
constexpr double first_weight = 1e-3;
constexpr int first_steps = 2, last_steps = 3;
// Exponents of the square root of 10: every second one is tried, then those beside the best.
constexpr int least_exponent = -12, most_exponent = 0;
constexpr double ridge = 1e-9, most_ridge = 1e12;
constexpr double least_cosine_of_slope = 0.05;  // lower bound of denominators
constexpr double most_outside = 0.3;            // barycentric, of the foot of a point
constexpr double most_turn = 0.5, most_offset = 0.3;  // radians, and multiples of h
constexpr double least_turned_cosine = 0.5, least_normal_cosine = 0.25;
constexpr int most_halvings = 7, most_attempts = 3, most_refinements = 4;
// A triangle is too coarse if it has at least so many points, and their rms distance is larger than this multiple of
// the median triangle's and than this share of the mesh's.
constexpr std::size_t least_points = 8;
constexpr double coarse_factor = 1.5, coarse_share = 0.05;
constexpr double rounding = 1e-9;  // as a share of h; flat faces are exact
constexpr double sag_per_rms = 2.5;  // a mesh decimated within a distance has about 0.4 of it as rms distance
constexpr double enough = 1e-4;      // radians; steps end when no normal turns more

/// The numbers of a facet and their derivatives by the unknowns of its corners and edges.
struct Facet {
    FacetHeight height;
    Numbers at = Numbers::Zero();
    /// By row: the number. By column: offsets of the corners, in units of h (0 to 2); turns of the corners' normals (3
    /// + 2 * corner + axis); and slopes of the edges (9 to 11).
    Matrix by = Matrix::Zero();
    std::array<u32, FacetHeight::numbers> unknowns{};  ///< by column; `none` if it is fixed
};

struct Located {
    u32 facet, row;
};

class JointFitter {
public:
    JointFitter(PatchMesh& mesh, std::span<const Vec3> points, const PointTree& tree, const std::vector<bool>& is_fixed,
                double fairing, Execution& execution)
        : mesh_(mesh),
          points_(points),
          tree_(tree),
          is_fixed_(is_fixed),
          fairing_(fairing),
          execution_(execution) {}

    JointFit fit() {
        locate();
        if (located_.empty()) return result_;
        rms_of_mesh_ = rms_distance();
        most_sag_ = sag_per_rms * rms_of_mesh_;
        result_.flips = make_even(mesh_, free_unfixed(), is_fixed_, tree_, most_sag_, execution_);
        start();
        for (int step = 0; step < first_steps; ++step) solve(first_weight);
        result_.flips += flip_edges_again();
        start();
        solve(first_weight);
        locate();
        linearise();
        result_.weight = best_weight() * fairing_;
        solve_linearised(result_.weight);
        for (int round = 0; round < most_refinements; ++round) {
            const std::vector<u32> coarse = coarse_facets();
            if (coarse.empty()) break;
            refine(coarse);
        }
        for (int step = 1; step < last_steps && largest_turn_ > enough; ++step) solve(result_.weight);
        finish();
        return result_;
    }

    /// Bisects triangles of a mesh that was fitted, and fits it with the same weight.
    JointFit fit_again(const JointFit& before, std::span<const u32> triangles) {
        result_ = before;
        offsets_ = before.offsets;
        locate();
        if (located_.empty()) return result_;
        most_sag_ = sag_per_rms * rms_distance();
        refine(triangles);
        for (int step = 1; step < last_steps && largest_turn_ > enough; ++step) solve(result_.weight);
        finish();
        return result_;
    }

private:
    struct FitEdge {
        std::array<u32, 2> halves;  ///< the second is `boundary` at a boundary
        bool is_smooth;
    };

    void refine(std::span<const u32> triangles) {
        result_.bisected += bisect(mesh_, triangles);
        result_.flips += flip_edges_again();
        start();
        solve(result_.weight);
    }

    std::size_t flip_edges_again() {
        is_fixed_.resize(mesh_.mesh.positions.size(), false);
        return flip_edges(mesh_, is_fixed_, most_sag_);
    }

    /// Triangles whose points have a larger rms distance from the surface than those of most triangles have: they are
    /// too large for the shape there. On exactly flat faces most distances are 0, so a share of the mesh's counts, too.
    std::vector<u32> coarse_facets() {
        locate();
        const std::vector<double> residuals = residuals_of_points();
        const std::vector<double> most = outlier_limits(residuals);
        std::vector<double> rms(mesh_.mesh.triangles.size(), 0), known;
        for (u32 f = 0; f < rms.size(); ++f) {
            std::size_t count = 0;
            double squares = 0;
            for (std::size_t i = first_[f]; i < first_[f + 1]; ++i) {
                if (residuals[i] == no_distance) continue;
                ++count;
                const double distance = std::min(residuals[i], most[f]);
                squares += distance * distance;
            }
            if (count < least_points) continue;
            rms[f] = std::sqrt(squares / static_cast<double>(count));
            known.push_back(rms[f]);
        }
        if (known.empty()) return {};
        const double limit =
            std::max({coarse_share * rms_of_mesh_, coarse_factor * quantile(known, 0.5), rounding * size_});
        std::vector<u32> coarse;
        for (u32 f = 0; f < rms.size(); ++f)
            if (rms[f] > limit) coarse.push_back(f);
        return coarse;
    }

    // State.

    /// Numbers sectors, edges and unknowns; forgets bends.
    void start() {
        const TriangleMesh& mesh = mesh_.mesh;
        sectors_ = sectors_of(mesh);
        corners_ = corners_of(sectors_);
        normals_.clear();
        for (const auto& corners : corners_) normals_.push_back(mesh_.normals[corners[0] / 3][corners[0] % 3]);
        const Array<u32> opposites = half_edges::opposites(mesh);
        edges_.clear();
        edge_of_.assign(opposites.size(), 0);
        for (u32 half = 0; half < opposites.size(); ++half) {
            const u32 other = opposites[half];
            if (other != half_edges::boundary && other < half) continue;
            const Edge edge = make_edge(half_edges::start(mesh, half), half_edges::end(mesh, half));
            const bool is_smooth = other != half_edges::boundary && !std::ranges::binary_search(mesh.sharp_edges, edge);
            edge_of_[half] = static_cast<u32>(edges_.size());
            if (other != half_edges::boundary) edge_of_[other] = edge_of_[half];
            edges_.push_back({{half, other}, is_smooth});
        }
        bends_.assign(edges_.size(), Vec3::Zero());
        offsets_.resize(mesh.positions.size(), 0);
        area_ = 0;
        for (const Triangle& t : mesh.triangles) area_ += area_vector(mesh.positions.span(), t).norm() / 2;
        size_ = std::sqrt(4 * area_ / (std::sqrt(3.0) * static_cast<double>(mesh.triangles.size())));
        locate();
        number_unknowns();
    }

    std::vector<bool> free_unfixed() const {
        std::vector<bool> is_free = free_vertices(mesh_);
        for (std::size_t v = 0; v < is_free.size(); ++v) is_free[v] = is_free[v] && !is_fixed_[v];
        return is_free;
    }

    void number_unknowns() {
        const std::vector<bool> is_free = free_unfixed();
        std::vector<bool> has_points(mesh_.mesh.positions.size(), false);
        for (const Located& each : located_)
            for (const u32 v : mesh_.mesh.triangles[each.facet]) has_points[v] = true;
        result_.unseen = static_cast<std::size_t>(std::ranges::count(has_points, false));
        unknowns_ = 0;
        const auto take = [&](bool is_unknown, u32 count) {
            if (!is_unknown) return none;
            unknowns_ += count;
            return unknowns_ - count;
        };
        offset_of_.clear();
        turn_of_.clear();
        slope_of_.clear();
        for (std::size_t v = 0; v < is_free.size(); ++v) offset_of_.push_back(take(is_free[v] && has_points[v], 1));
        for (u32 s = 0; s < normals_.size(); ++s)
            turn_of_.push_back(take(sectors_.is_whole[s] && normals_[s] != Vec3::Zero(), 2));
        for (const FitEdge& edge : edges_) slope_of_.push_back(take(edge.is_smooth, 1));
        std::vector<Eigen::Triplet<double>> entries;
        for (u32 f = 0; f < mesh_.mesh.triangles.size(); ++f) {
            const auto all = unknowns_of(f);
            for (const u32 a : all)
                for (const u32 b : all)
                    if (a != none && b != none && a >= b)
                        entries.emplace_back(static_cast<int>(a), static_cast<int>(b), 0);
        }
        for (u32 i = 0; i < unknowns_; ++i) entries.emplace_back(static_cast<int>(i), static_cast<int>(i), 0);
        pattern_.resize(unknowns_, unknowns_);
        pattern_.setFromTriplets(entries.begin(), entries.end());
        pattern_.makeCompressed();
    }

    std::array<u32, FacetHeight::numbers> unknowns_of(u32 f) const {
        std::array<u32, FacetHeight::numbers> all;
        for (std::size_t i = 0; i < 3; ++i) {
            all[i] = offset_of_[mesh_.mesh.triangles[f][i]];
            const u32 turn = turn_of_[sectors_.of_corner[f][i]];
            all[3 + 2 * i] = turn;
            all[4 + 2 * i] = turn == none ? none : turn + 1;
            all[9 + i] = slope_of_[edge_of_[3 * f + i]];
        }
        return all;
    }

    // Points.

    /// Finds the nearest triangle of every point. Leaves out points beyond the boundary and those that are too far
    /// away.
    void locate() {
        const TriangleMesh& mesh = mesh_.mesh;
        const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), execution_.threads());
        std::vector<u32> facets(points_.size(), none);
        std::vector<double> squares(points_.size());
        for_each_chunk(execution_.threads(), points_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            u32 hint = NearestTriangle::none;
            for (std::size_t i = begin; i < end; ++i) {
                const NearestTriangle nearest = tree.nearest(points_[i], hint);
                hint = nearest.slot;
                squares[i] = nearest.squared_distance;
                const Triangle& t = mesh.triangles[nearest.triangle];
                const double longest = std::max({(mesh.positions[t[1]] - mesh.positions[t[0]]).squaredNorm(),
                                                 (mesh.positions[t[2]] - mesh.positions[t[1]]).squaredNorm(),
                                                 (mesh.positions[t[0]] - mesh.positions[t[2]]).squaredNorm()});
                if (nearest.squared_distance > longest) continue;
                facets[i] = nearest.triangle;
            }
        });
        const Lists<> rows(mesh.triangles.size(), [&](auto&& add) {
            for (u32 i = 0; i < facets.size(); ++i)
                if (facets[i] != none) add(facets[i], i);
        });
        located_.clear();
        first_.clear();
        squared_distances_ = 0;
        for (u32 f = 0; f < mesh.triangles.size(); ++f) {
            first_.push_back(located_.size());
            for (const u32 row : rows[f]) {
                located_.push_back({f, row});
                squared_distances_ += squares[row];
            }
        }
        first_.push_back(located_.size());
    }

    double rms_distance() const {
        return std::sqrt(squared_distances_ / static_cast<double>(std::max<std::size_t>(1, located_.size())));
    }

    /// The half of the points to which a position belongs: cells of edge h go to one of the halves, by chance.
    std::size_t half_of(const Vec3& p) const {
        u64 mixed = 0x9E3779B97F4A7C15ULL;
        for (int axis = 0; axis < 3; ++axis) {
            const auto cell = static_cast<std::int64_t>(std::floor(p[axis] / size_ + 0.37));
            mixed ^= static_cast<u64>(cell) + 0x9E3779B97F4A7C15ULL + (mixed << 6) + (mixed >> 2);
            mixed = (mixed ^ (mixed >> 30)) * 0xBF58476D1CE4E5B9ULL;
            mixed = (mixed ^ (mixed >> 27)) * 0x94D049BB133111EBULL;
            mixed ^= mixed >> 31;
        }
        return mixed & 1;
    }

    // The linear system.

    static std::array<Vec3, 2> axes_of(const Vec3& normal) {
        const auto [u, v] = directions_across(normal);
        return {u, v};
    }

    Facet facet(u32 f) const {
        const TriangleMesh& mesh = mesh_.mesh;
        const Triangle& t = mesh.triangles[f];
        Facet result{FacetHeight({mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]})};
        const FacetHeight& height = result.height;
        const Vec3& up = height.normal();
        const auto steep = [](double cosine) {
            return std::abs(cosine) < least_cosine_of_slope ? std::copysign(least_cosine_of_slope, cosine) : cosine;
        };
        /// The derivative of -(m · e) / (m · up) by a change x of m.
        const auto change = [&](const Vec3& m, const Vec3& e, const Vec3& x) {
            const double cosine = steep(m.dot(up));
            return -x.dot(e) / cosine + m.dot(e) * x.dot(up) / (cosine * cosine);
        };
        std::array<Vec3, 3> normals;
        std::array<std::array<Vec3, 2>, 3> axes;
        for (std::size_t i = 0; i < 3; ++i) {
            normals[i] = normals_[sectors_.of_corner[f][i]];
            if (normals[i] == Vec3::Zero()) normals[i] = up;
            axes[i] = axes_of(normals[i]);
            const auto corner = static_cast<Eigen::Index>(i);
            result.by(corner, corner) = size_ / steep(normals[i].dot(up));
            for (std::size_t e = 0; e < 2; ++e) {
                const auto row = static_cast<Eigen::Index>(3 + 2 * i + e);
                result.at[row] = -normals[i].dot(height.axes()[e]) / steep(normals[i].dot(up));
                for (std::size_t a = 0; a < 2; ++a)
                    result.by(row, static_cast<Eigen::Index>(3 + 2 * i + a)) =
                        change(normals[i], height.axes()[e], axes[i][a]);
            }
        }
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = next(i);
            const u32 edge = edge_of_[3 * f + i];
            const Vec3 across = height.across(i), m = (normals[i] + normals[j]) / 2 + bends_[edge];
            const auto row = static_cast<Eigen::Index>(9 + i);
            result.at[row] = -m.dot(across) / steep(m.dot(up));
            for (std::size_t a = 0; a < 2; ++a)
                for (const std::size_t end : {i, j})
                    result.by(row, static_cast<Eigen::Index>(3 + 2 * end + a)) = change(m, across, axes[end][a] / 2);
            if (edges_[edge].is_smooth) result.by(row, row) = change(m, across, direction_of_bend(edge));
        }
        result.unknowns = unknowns_of(f);
        return result;
    }

    /// The direction across a smooth edge in which its gradient changes.
    Vec3 direction_of_bend(u32 edge) const {
        const auto [half, other] = edges_[edge].halves;
        const TriangleMesh& mesh = mesh_.mesh;
        const Vec3 along = mesh.positions[half_edges::end(mesh, half)] - mesh.positions[half_edges::start(mesh, half)];
        const auto normal = [&](u32 f) { return area_vector(mesh.positions.span(), mesh.triangles[f]).normalized(); };
        return along.cross(normal(half / 3) + normal(other / 3)).normalized();
    }

    struct Sample {
        Numbers basis;
        double height;  ///< distance of the point from the triangle, along its normal
        double cosine;  ///< cosine of the angle between surface and triangle there
        bool is_inside;
    };
    Sample sample(const Facet& facet, const Vec3& point) const {
        const auto at = facet.height.in_plane(point);
        const auto [least, most] = facet.height.range_of_shares(at);
        if (least < -most_outside || most > 1 + most_outside) return {{}, 0, 0, false};
        const FacetHeight::Basis basis = facet.height.basis(at);
        const double x = basis.slopes[0].dot(facet.at), y = basis.slopes[1].dot(facet.at);
        return {basis.height, facet.height.normal().dot(point - facet.height.origin()),
                1 / std::sqrt(1 + x * x + y * y), true};
    }

    /// The system of the points of one half, or of the bending: u · matrix u / 2 - right · u is minimised.
    struct Part {
        Sparse matrix;
        Vector right;
        double count = 0;
    };

    struct Contribution {
        std::array<u32, FacetHeight::numbers> unknowns;
        std::array<Matrix, 3> matrix;
        std::array<Numbers, 3> right;
        std::array<double, 2> count;
    };

    /// Distances of the located points from the surface; `no_distance` for points beside their triangle.
    std::vector<double> residuals_of_points() const {
        const std::size_t facets = mesh_.mesh.triangles.size();
        std::vector<double> residuals(located_.size());
        for_each_chunk(execution_.threads(), facets, facets_at_once, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (u32 f = static_cast<u32>(begin); f < end; ++f) {
                if (first_[f] == first_[f + 1]) continue;
                const Facet here = facet(f);
                for (std::size_t i = first_[f]; i < first_[f + 1]; ++i) {
                    const Sample each = sample(here, points_[located_[i].row]);
                    residuals[i] =
                        each.is_inside ? std::abs(each.basis.dot(here.at) - each.height) * each.cosine : no_distance;
                }
            }
        });
        return residuals;
    }

    void linearise() {
        const std::size_t facets = mesh_.mesh.triangles.size();
        const std::vector<double> residuals = residuals_of_points();
        const std::vector<double> most = outlier_limits(residuals);
        for (Part* part : {&halves_[0], &halves_[1], &plate_}) {
            part->matrix = pattern_;
            part->right = Vector::Zero(unknowns_);
            part->count = 0;
        }
        using Contributions = std::vector<Contribution>;
        for_each_in_order<Contributions>(
            execution_.threads(), (facets + facets_at_once - 1) / facets_at_once,
            [&](std::size_t number, Contributions& all) {
                execution_.check_cancelled();
                all.clear();
                for (std::size_t f = number * facets_at_once; f < std::min(facets, (number + 1) * facets_at_once); ++f)
                    all.push_back(contribution(static_cast<u32>(f), residuals, most[f]));
            },
            [&](std::size_t, const Contributions& all) {
                for (const Contribution& each : all) add(each);
            });
    }

    /// By facet: the distance beyond which its points count less.
    std::vector<double> outlier_limits(std::span<const double> residuals) const {
        std::vector<u32> facets;
        for (const Located& each : located_) facets.push_back(each.facet);
        std::vector<std::array<u32, 3>> neighbours(mesh_.mesh.triangles.size());
        for (u32 f = 0; f < neighbours.size(); ++f)
            for (u32 i = 0; i < 3; ++i) {
                const auto [half, other] = edges_[edge_of_[3 * f + i]].halves;
                const u32 beyond = half == 3 * f + i ? other : half;
                neighbours[f][i] = beyond == half_edges::boundary ? none : beyond / 3;
            }
        return outlier_distances(residuals, facets, neighbours);
    }

    Contribution contribution(u32 f, std::span<const double> residuals, double most) const {
        const Facet here = facet(f);
        Contribution result;
        result.unknowns = here.unknowns;
        std::array<Matrix, 3> matrix;
        std::array<Numbers, 3> right;
        for (std::size_t part = 0; part < 3; ++part) {
            matrix[part].setZero();
            right[part].setZero();
        }
        result.count = {0, 0};
        for (std::size_t i = first_[f]; i < first_[f + 1]; ++i) {
            if (residuals[i] == no_distance) continue;
            const Vec3& point = points_[located_[i].row];
            const Sample each = sample(here, point);
            const std::size_t half = half_of(point);
            const double weight = (residuals[i] > most ? most / residuals[i] : 1) * each.cosine * each.cosine;
            matrix[half].noalias() += weight * each.basis * each.basis.transpose();
            right[half] += weight * (each.height - each.basis.dot(here.at)) * each.basis;
            ++result.count[half];
        }
        matrix[2] = here.height.bending();
        right[2] = -matrix[2] * here.at;
        for (std::size_t part = 0; part < 3; ++part) {
            result.matrix[part].noalias() = here.by.transpose() * matrix[part] * here.by;
            result.right[part] = here.by.transpose() * right[part];
        }
        return result;
    }

    void add(const Contribution& each) {
        const std::array<Part*, 3> parts{&halves_[0], &halves_[1], &plate_};
        for (int a = 0; a < FacetHeight::numbers; ++a) {
            const u32 row = each.unknowns[static_cast<std::size_t>(a)];
            if (row == none) continue;
            for (std::size_t part = 0; part < 3; ++part) parts[part]->right[row] += each.right[part][a];
            for (int b = 0; b < FacetHeight::numbers; ++b) {
                const u32 column = each.unknowns[static_cast<std::size_t>(b)];
                if (column == none || column > row) continue;
                const int *begin = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[column],
                          *end = pattern_.innerIndexPtr() + pattern_.outerIndexPtr()[column + 1];
                const auto at = std::lower_bound(begin, end, static_cast<int>(row)) - pattern_.innerIndexPtr();
                for (std::size_t part = 0; part < 3; ++part)
                    parts[part]->matrix.valuePtr()[at] += each.matrix[part](a, b);
            }
        }
        for (std::size_t half = 0; half < 2; ++half) halves_[half].count += each.count[half];
    }

    /// The unknowns that minimise the energy with one half of the points, or with both.
    Vector minimum(std::span<const std::size_t> halves, double weight) const {
        if (unknowns_ == 0) return Vector();
        Sparse matrix = pattern_;
        Vector right = Vector::Zero(unknowns_);
        double count = 0;
        for (const std::size_t half : halves) count += halves_[half].count;
        const double of_points = count > 0 ? area_ / count : 0;
        for (const std::size_t half : halves) {
            matrix += of_points * halves_[half].matrix;
            right += of_points * halves_[half].right;
        }
        const double of_plate = weight * size_ * size_ * size_ * size_;
        matrix += of_plate * plate_.matrix;
        right += of_plate * plate_.right;
        const double of_ridge = ridge * area_ * size_ * size_ / static_cast<double>(mesh_.mesh.positions.size());
        Eigen::SimplicialLLT<Sparse, Eigen::Lower> solver;
        solver.analyzePattern(matrix);
        for (double factor = 1; factor <= most_ridge; factor *= 1000) {
            Sparse with_ridge = matrix;
            for (u32 i = 0; i < unknowns_; ++i) with_ridge.coeffRef(i, i) += factor * of_ridge;
            solver.factorize(with_ridge);
            if (solver.info() != Eigen::Success) continue;
            const Vector found = solver.solve(right);
            if (found.allFinite()) return found;
        }
        return Vector::Zero(unknowns_);  // rounding leaves nothing of triangles that are this thin
    }

    /// The sum of the squared distances of the points of a half from the surface with these unknowns, up to a constant.
    double misfit(std::size_t half, const Vector& unknowns) const {
        return unknowns.dot(halves_[half].matrix.selfadjointView<Eigen::Lower>() * unknowns) -
               2 * halves_[half].right.dot(unknowns);
    }

    /// Pre: linearise().
    double best_weight() {
        if (halves_[0].count == 0 || halves_[1].count == 0) return first_weight;
        std::array<std::optional<double>, most_exponent - least_exponent + 1> found;
        const auto weight_of = [](int exponent) {
            double weight = exponent % 2 == 0 ? 1 : 1 / std::sqrt(10.0);
            for (int i = exponent / 2; i < 0; ++i) weight /= 10;
            return weight;
        };
        const auto measure = [&](std::span<const int> exponents) {
            std::vector<double> misfits(2 * exponents.size());
            for_each_chunk(execution_.threads(), misfits.size(), 1, [&](std::size_t begin, std::size_t end) {
                for (std::size_t i = begin; i < end; ++i) {
                    execution_.check_cancelled();
                    const std::size_t half = i % 2;
                    misfits[i] = misfit(1 - half, minimum(std::array{half}, weight_of(exponents[i / 2])));
                }
            });
            for (std::size_t i = 0; i < exponents.size(); ++i)
                found[static_cast<std::size_t>(exponents[i] - least_exponent)] = misfits[2 * i] + misfits[2 * i + 1];
        };
        const auto best = [&] {
            int at = least_exponent;
            for (int exponent = least_exponent; exponent <= most_exponent; ++exponent) {
                const auto& here = found[static_cast<std::size_t>(exponent - least_exponent)];
                const auto& least = found[static_cast<std::size_t>(at - least_exponent)];
                if (here && (!least || *here < *least)) at = exponent;
            }
            return at;
        };
        std::vector<int> exponents;
        for (int exponent = least_exponent; exponent <= most_exponent; exponent += 2) exponents.push_back(exponent);
        measure(exponents);
        const int middle = best();
        exponents.clear();
        for (const int exponent : {middle - 1, middle + 1})
            if (exponent >= least_exponent && exponent <= most_exponent) exponents.push_back(exponent);
        measure(exponents);
        return weight_of(best());
    }

    // Steps.

    void solve(double weight) {
        locate();
        linearise();
        solve_linearised(weight);
    }

    void solve_linearised(double weight) {
        execution_.check_cancelled();
        move(minimum(std::array<std::size_t, 2>{0, 1}, weight));
    }

    /// Changes positions, normals and bends, except where triangles would fold: there the changes are halved.
    void move(const Vector& unknowns) {
        TriangleMesh& mesh = mesh_.mesh;
        const std::vector<Vec3> old(mesh.positions.begin(), mesh.positions.end()), old_normals = normals_;
        std::vector<double> share(old.size(), 1);
        std::vector<int> halvings(old.size(), 0);
        std::vector<Vec3> positions = old;
        const auto value = [&](u32 unknown) { return unknown == none ? 0.0 : unknowns[unknown]; };
        const auto set = [&] {
            for (u32 v = 0; v < old.size(); ++v) {
                const double offset = std::clamp(value(offset_of_[v]), -most_offset, most_offset) * size_ * share[v];
                positions[v] = offset == 0 ? old[v] : Vec3(old[v] + offset * normal_of_vertex_[v]);
            }
            for (u32 s = 0; s < normals_.size(); ++s) {
                normals_[s] = old_normals[s];
                if (turn_of_[s] == none) continue;
                const auto axes = axes_of(old_normals[s]);
                Vec3 turn = unknowns[turn_of_[s]] * axes[0] + unknowns[turn_of_[s] + 1] * axes[1];
                if (turn.norm() > most_turn) turn *= most_turn / turn.norm();
                normals_[s] = (old_normals[s] + share[sectors_.vertex[s]] * turn).normalized();
            }
        };
        normal_of_vertex_.assign(old.size(), Vec3::Zero());
        for (u32 s = 0; s < normals_.size(); ++s) normal_of_vertex_[sectors_.vertex[s]] = normals_[s];
        const auto cosine_at = [&](u32 f, const Vec3& normal, std::span<const Vec3> normals) {
            double least = 1;
            for (const u32 s : sectors_.of_corner[f])
                if (normals[s] != Vec3::Zero()) least = std::min(least, normals[s].dot(normal));
            return least;
        };
        for (;;) {
            set();
            std::vector<bool> is_wrong(old.size(), false);
            bool has_wrong = false;
            for (u32 f = 0; f < mesh.triangles.size(); ++f) {
                const Triangle& t = mesh.triangles[f];
                const Vec3 before = area_vector(old, t).normalized(), after = area_vector(positions, t).normalized();
                const double least = std::min(least_normal_cosine, cosine_at(f, before, old_normals));
                if (after.dot(before) >= least_turned_cosine && cosine_at(f, after, normals_) >= least) continue;
                for (const u32 v : t) {
                    if (share[v] == 0) continue;
                    is_wrong[v] = has_wrong = true;
                }
            }
            if (!has_wrong) break;
            for (std::size_t v = 0; v < old.size(); ++v)
                if (is_wrong[v]) share[v] = ++halvings[v] > most_halvings ? 0 : share[v] / 2;
        }
        for (u32 v = 0; v < old.size(); ++v) offsets_[v] += normal_of_vertex_[v].dot(positions[v] - old[v]);
        for (u32 e = 0; e < edges_.size(); ++e) {
            if (slope_of_[e] == none) continue;
            const u32 half = edges_[e].halves[0];
            const double least = std::min(share[half_edges::start(mesh, half)], share[half_edges::end(mesh, half)]);
            bends_[e] += std::clamp(unknowns[slope_of_[e]], -most_turn, most_turn) * least * direction_of_bend(e);
        }
        largest_turn_ = 0;
        for (u32 s = 0; s < normals_.size(); ++s)
            largest_turn_ = std::max(largest_turn_, (normals_[s] - old_normals[s]).norm());
        mesh.positions = Array<Vec3>(positions.begin(), positions.end());
        for (u32 s = 0; s < normals_.size(); ++s)
            for (const u32 corner : corners_[s]) mesh_.normals[corner / 3][corner % 3] = normals_[s];
    }

    void finish() {
        mesh_.bends.clear();
        mesh_.bisected.clear();
        for (u32 e = 0; e < edges_.size(); ++e) {
            const u32 half = edges_[e].halves[0];
            if (bends_[e] != Vec3::Zero())
                mesh_.bends.emplace(make_edge(half_edges::start(mesh_.mesh, half), half_edges::end(mesh_.mesh, half)),
                                    bends_[e]);
        }
        double squares = 0;
        result_.offset_max = 0;
        for (const double offset : offsets_) {
            squares += offset * offset;
            result_.offset_max = std::max(result_.offset_max, std::abs(offset));
        }
        result_.offset_rms = std::sqrt(squares / static_cast<double>(offsets_.size()));
        result_.offsets = offsets_;
    }

    PatchMesh& mesh_;
    std::span<const Vec3> points_;
    const PointTree& tree_;
    std::vector<bool> is_fixed_;  ///< by vertex
    double fairing_;
    Execution& execution_;
    JointFit result_;
    double rms_of_mesh_ = 0, most_sag_ = 0, squared_distances_ = 0;

    Sectors sectors_;
    std::vector<std::vector<u32>> corners_;
    std::vector<Vec3> normals_;  ///< by sector
    std::vector<FitEdge> edges_;
    std::vector<u32> edge_of_;  ///< by half-edge
    std::vector<Vec3> bends_;  ///< by edge, see PatchMesh::bends
    std::vector<double> offsets_;  ///< by vertex
    std::vector<Vec3> normal_of_vertex_;
    double area_ = 0, size_ = 0, largest_turn_ = 0;

    std::vector<Located> located_;  ///< by facet
    std::vector<std::size_t> first_;  ///< by facet: the first of its points in `located_`

    u32 unknowns_ = 0;
    std::vector<u32> offset_of_, turn_of_, slope_of_;  ///< by vertex, sector and edge: the first unknown, or `none`
    Sparse pattern_;
    std::array<Part, 2> halves_;
    Part plate_;
};

/// Fixes the vertices of triangles that intersect each other. Returns whether one was not fixed before.
bool fix_crossing(const TriangleMesh& mesh, std::vector<bool>& is_fixed, Execution& execution) {
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), execution.threads());
    const SelfIntersections found = self_intersections(mesh.positions.span(), mesh.triangles.span(), tree, execution);
    bool has_new = false;
    for (const auto& pair : found.pairs)
        for (const u32 f : pair)
            for (const u32 v : mesh.triangles[f]) {
                if (v >= is_fixed.size()) continue;  // added by the fit
                has_new = has_new || !is_fixed[v];
                is_fixed[v] = true;
            }
    return has_new;
}

/// Fits the mesh with `fit`. Corners of triangles that intersect are fixed from the start; where others intersect after
/// the fit, their corners are fixed and it is repeated.
template <class Fit>
JointFit fit_without_crossing(PatchMesh& mesh, std::span<const Vec3> points, double fairing, Execution& execution,
                              Fit&& fit) {
    const PointTree tree(points, execution.threads());
    std::vector<bool> is_fixed(mesh.mesh.positions.size(), false);
    fix_crossing(mesh.mesh, is_fixed, execution);
    for (int attempt = 1;; ++attempt) {
        PatchMesh fitted = mesh;
        JointFitter fitter(fitted, points, tree, is_fixed, fairing, execution);
        const JointFit result = fit(fitter);
        if (fix_crossing(fitted.mesh, is_fixed, execution) && attempt < most_attempts) continue;
        mesh = std::move(fitted);
        return result;
    }
}

}  // namespace

JointFit fit_jointly(PatchMesh& mesh, std::span<const Vec3> points, double fairing, Execution& execution) {
    return fit_without_crossing(mesh, points, fairing, execution, [](JointFitter& fitter) { return fitter.fit(); });
}

JointFit fit_refined(PatchMesh& mesh, std::span<const u32> triangles, std::span<const Vec3> points,
                     const JointFit& before, Execution& execution) {
    return fit_without_crossing(mesh, points, 1, execution,
                                [&](JointFitter& fitter) { return fitter.fit_again(before, triangles); });
}

}  // namespace scanmill::a_patches
