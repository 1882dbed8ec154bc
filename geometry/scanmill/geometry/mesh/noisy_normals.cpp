// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/noisy_normals.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <mutex>
#include <numbers>
#include <numeric>
#include <optional>
#include <utility>

#include "scanmill/base/elementary.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/fit/jet.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/spatial/lists.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

using Matrix = Eigen::Matrix3d;

/// For each vertex the vertices at the other ends of its edges.
Lists<> neighbours_of(const TriangleMesh& mesh, std::span<const u32> opposite) {
    return {mesh.positions.size(), [&](auto&& add) {
                for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
                    if (opposite[half_edge] == half_edges::no_half_edge) continue;
                    const u32 a = half_edges::start(mesh, half_edge), b = half_edges::end(mesh, half_edge);
                    add(a, b);
                    if (opposite[half_edge] == half_edges::boundary) add(b, a);
                }
            }};
}

Lists<> triangles_of(const TriangleMesh& mesh) {
    return {mesh.positions.size(), [&](auto&& add) {
                for (u32 t = 0; t < mesh.triangles.size(); ++t)
                    for (const u32 vertex : mesh.triangles[t]) add(vertex, t);
            }};
}

// ---- noise

/// Distances of a vertex from two quadrics: those that best fit the vertices within two, and within three, edges.
struct FromQuadrics {
    double two = 0, three = 0;
    bool known = false;
};

/// The distance of the first offset from the quadric that fits all offsets best; empty if they do not determine one.
/// The first point pulls the quadric towards itself, which leaves only the share 1 - leverage of its variance; the
/// distance is corrected for this. The leverage of the middle of a disc of n points is 4 / n.
std::optional<double> distance_from_quadric(std::vector<Vec3> offsets) {
    constexpr std::size_t coefficients = 6;
    if (offsets.size() <= coefficients) return std::nullopt;
    std::sort(offsets.begin() + 1, offsets.end(), is_lower);
    const Jet jet = fit_jet(offsets);
    if (!jet.is_curved) return std::nullopt;
    return jet.offset.norm() / std::sqrt(1 - 4 / static_cast<double>(offsets.size()));
}

/// The distances are unknown unless every ring of neighbours has more vertices than the ring inside it. A ring that
/// does not grow shows that the surface ends or closes.
FromQuadrics distances_from_quadrics(const TriangleMesh& mesh, const Lists<>& neighbours, u32 vertex) {
    std::vector<u32> ring{vertex}, inner;  // sorted
    std::vector<Vec3> offsets{Vec3::Zero()};
    FromQuadrics result;
    for (int edges = 1; edges <= 3; ++edges) {
        std::vector<u32> around, next;
        for (const u32 v : ring) around.insert(around.end(), neighbours[v].begin(), neighbours[v].end());
        std::ranges::sort(around);
        around.erase(std::ranges::unique(around).begin(), around.end());
        std::ranges::copy_if(around, std::back_inserter(next), [&](u32 v) {
            return !std::ranges::binary_search(ring, v) && !std::ranges::binary_search(inner, v);
        });
        if (next.size() <= ring.size()) return {};
        for (const u32 v : next) offsets.push_back(mesh.positions[v] - mesh.positions[vertex]);
        inner = std::exchange(ring, std::move(next));
        if (edges == 1) continue;
        const std::optional<double> distance = distance_from_quadric(offsets);
        if (!distance) return {};
        (edges == 2 ? result.two : result.three) = *distance;
    }
    result.known = true;
    return result;
}

/// Distance of two triangles at edge (a, b) from a common plane; positive at a convex edge. The heights of four
/// coplanar points over any plane satisfy one linear equation. The distance is the residual of this equation for the
/// heights over the mean plane of the triangles, with coefficients of unit length.
double distance_from_plane(const Vec3& a, const Vec3& b, const Vec3& left, const Vec3& right) {
    const Vec3 edge = b - a, one = edge.cross(left - a), two = (right - a).cross(edge);
    const Vec3 normal = (one + two).normalized();
    const double area_left = one.dot(normal), area_right = two.dot(normal);
    const Vec3 across = left - right;
    const double area_a = across.cross(b - right).dot(normal), area_b = (a - right).cross(across).dot(normal);
    const double size = std::sqrt(area_left * area_left + area_right * area_right + area_a * area_a + area_b * area_b);
    // The signed volume (times 6) of the tetrahedron of the four points, divided by the length of the area
    // coefficients.
    return size > 0 ? -one.dot(right - a) / size : 0;
}

/// Selects roughly every k-th vertex by a hash of the position.
bool is_sample(const Vec3& position, std::size_t k) {
    u64 hash = 0;
    for (const double coordinate : position)
        hash = (hash ^ std::bit_cast<u64>(coordinate + 0.0)) * 0x9e3779b97f4a7c15ull, hash ^= hash >> 32;
    return hash % k == 0;
}

double quantile(std::vector<double>& values, double share) {
    const auto at = values.begin() + std::llround(share * static_cast<double>(values.size() - 1));
    std::ranges::nth_element(values, at);
    return *at;
}

// ---- neighbourhoods

Matrix product(const Vec3& v) { return v * v.transpose(); }

/// Whether the second largest eigenvalue of a symmetric matrix M is at least `value`. This is equivalent to at most one
/// negative eigenvalue of M - value I. By Sylvester's law, the number of negative eigenvalues is the number of sign
/// changes in the sequence of leading minors.
bool middle_reaches(const Matrix& m, double value) {
    if (m.trace() < 2 * value) return false;
    const Matrix shifted = m - value * Matrix::Identity();
    const double first = shifted(0, 0), second = shifted.topLeftCorner<2, 2>().determinant(),
                 third = shifted.determinant();
    return (first < 0) + ((first < 0) != (second < 0)) + ((second < 0) != (third < 0)) <= 1;
}

/// Limits that follow from the noise.
struct Limits {
    double variance;  ///< variance of a vertex position
    double reliable;  ///< least λ of a reliable normal
    double visible;  ///< times √(n - 3): least λ at which a crease of the angle is visible

    Limits(double noise, double angle, std::size_t triangles) {
        const double z = std::sqrt(2 * elementary::log(1.5 * static_cast<double>(triangles)));
        variance = noise * noise;
        reliable = 2 * z * z * variance / (angle * angle);
        // Take n points of a disc with a crease through its middle. The crease adds about 0.28 λ tan²(angle / 2) to the
        // sum of squared distances from the best plane. Noise adds (n - 3) σ² with a standard deviation of √(2 (n - 3))
        // σ². The crease is visible if it adds at least 2 z of these standard deviations: each sum may be off by z.
        constexpr double of_a_crease = 1 - 64 / (9 * std::numbers::pi * std::numbers::pi);
        const auto [cosine, sine] = elementary::turn_of(std::min(angle, std::numbers::pi / 2) / 2);
        const double slope = sine / cosine;
        visible = 2 * z * std::numbers::sqrt2 * variance / (of_a_crease * slope * slope);
    }
};

struct Plane {
    Vec3 normal = Vec3::Zero();
    double error = std::numeric_limits<double>::infinity();  ///< mean square error of the slope
};

/// Nested neighbourhoods: the first n vertices for every n.
struct Neighbourhoods {
    std::vector<u32> vertices;
    /// best[n - 1]: the best plane of the first n, or more, vertices.
    std::vector<Plane> best;
    double radius = 0;  ///< squared radius of the largest neighbourhood
};

class Grower {
public:
    Grower(const TriangleMesh& mesh, const Lists<>& neighbours, std::span<const Vec3> areas, const Limits& limits)
        : mesh_(mesh),
          neighbours_(neighbours),
          areas_(areas),
          limits_(limits),
          reached_(mesh.positions.size(), 0) {}

    Neighbourhoods around(u32 centre) {
        Neighbourhoods result;
        Vec3 sum = Vec3::Zero(), outwards = Vec3::Zero();
        Matrix squares = Matrix::Zero();
        ++round_;
        waiting_.clear();
        reach(centre, centre);
        constexpr std::size_t most = 256;
        while (!waiting_.empty() && result.vertices.size() < most) {
            std::ranges::pop_heap(waiting_, after);
            const auto [distance, offset, vertex] = waiting_.back();
            waiting_.pop_back();
            result.vertices.push_back(vertex);
            result.radius = std::max(result.radius, distance);
            sum += offset;
            squares += product(offset);
            outwards += areas_[vertex];
            for (const u32 next : neighbours_[vertex])
                if (reached_[next] != round_) reach(next, centre);
            const auto n = static_cast<double>(result.vertices.size());
            const Matrix scatter = squares - product(sum) / n;
            result.best.push_back(plane_of(scatter, n, outwards));
            if (n > 3 && middle_reaches(scatter, std::max(limits_.reliable, limits_.visible * std::sqrt(n - 3)))) break;
        }
        for (std::size_t n = result.best.size(); n-- > 1;)
            if (result.best[n].error < result.best[n - 1].error) result.best[n - 1] = result.best[n];
        return result;
    }

private:
    struct Waiting {
        double distance;  ///< squared
        Vec3 offset;
        u32 vertex;
    };
    Plane plane_of(const Matrix& scatter, double n, const Vec3& outwards) const {
        if (n <= 3) return {};
        const Eigen::SelfAdjointEigenSolver<Matrix> solver(scatter);
        const double least = solver.eigenvalues()[0], middle = solver.eigenvalues()[1];
        if (!(middle > 0)) return {};
        const Vec3 normal = solver.eigenvectors().col(0);
        return {normal.dot(outwards) < 0 ? Vec3(-normal) : normal,
                (std::max(0.0, least - (n - 3) * limits_.variance) + limits_.variance) / middle};
    }
    static bool after(const Waiting& a, const Waiting& b) {
        return a.distance != b.distance ? a.distance > b.distance : is_lower(b.offset, a.offset);
    }
    void reach(u32 vertex, u32 centre) {
        reached_[vertex] = round_;
        const Vec3 offset = mesh_.positions[vertex] - mesh_.positions[centre];
        waiting_.push_back({offset.squaredNorm(), offset, vertex});
        std::ranges::push_heap(waiting_, after);
    }

    const TriangleMesh& mesh_;
    const Lists<>& neighbours_;
    std::span<const Vec3> areas_;
    const Limits& limits_;
    std::vector<u32> reached_;  ///< by vertex: the last round that reached it
    u32 round_ = 0;
    std::vector<Waiting> waiting_;
};

/// A pool of growers, one for each block of work that runs at the same time. A new grower costs an array over all
/// vertices.
class Growers {
public:
    explicit Growers(std::function<std::unique_ptr<Grower>()> make) : make_(std::move(make)) {}

    std::unique_ptr<Grower> take() {
        const std::scoped_lock lock(mutex_);
        if (idle_.empty()) return make_();
        std::unique_ptr<Grower> grower = std::move(idle_.back());
        idle_.pop_back();
        return grower;
    }
    void give_back(std::unique_ptr<Grower> grower) {
        const std::scoped_lock lock(mutex_);
        idle_.push_back(std::move(grower));
    }

private:
    std::function<std::unique_ptr<Grower>()> make_;
    std::mutex mutex_;
    std::vector<std::unique_ptr<Grower>> idle_;
};

Matrix scatter_of(const TriangleMesh& mesh, const Triangle& triangle) {
    const auto& p = mesh.positions;
    const Vec3 middle = (p[triangle[0]] + p[triangle[1]] + p[triangle[2]]) / 3;
    Matrix scatter = Matrix::Zero();
    for (const u32 vertex : triangle) scatter += product(p[vertex] - middle);
    return scatter;
}

/// The vertices of the triangles, and all vertices up to two edges away from them.
std::vector<u32> near_vertices(const TriangleMesh& mesh, const Lists<>& neighbours, std::span<const u32> triangles) {
    std::vector<u32> found;
    std::vector<bool> is_found(mesh.positions.size(), false);
    const auto add = [&](u32 vertex) {
        if (!is_found[vertex]) found.push_back(vertex);
        is_found[vertex] = true;
    };
    for (const u32 t : triangles) std::ranges::for_each(mesh.triangles[t], add);
    for (std::size_t begin = 0, rounds = 0; rounds < 2; ++rounds) {
        const std::size_t end = found.size();
        for (; begin < end; ++begin) std::ranges::for_each(neighbours[found[begin]], add);
    }
    return found;
}

}  // namespace

double vertex_noise(const TriangleMesh& mesh, std::span<const u32> opposite, const Execution& execution) {
    const Lists<> neighbours = neighbours_of(mesh, opposite);
    const std::size_t count = mesh.positions.size();
    constexpr std::size_t enough = 5'000;
    const std::size_t k = std::max<std::size_t>(1, count / enough);
    Array<FromQuadrics> from_quadrics(count);
    constexpr std::size_t chunk = 1 << 12;
    for_each_chunk(execution.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t v = begin; v < end; ++v)
            if (is_sample(mesh.positions[v], k))
                from_quadrics[v] = distances_from_quadrics(mesh, neighbours, static_cast<u32>(v));
    });
    std::vector<double> two, three;
    for (const FromQuadrics& distances : from_quadrics) {
        if (!distances.known) continue;
        two.push_back(distances.two);
        three.push_back(distances.three);
    }
    if (two.empty() || quantile(three, 0.25) > std::numbers::sqrt2 * quantile(two, 0.25)) return 0;

    std::vector<double> errors;
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
        const u32 other = opposite[half_edge];
        if (other >= half_edges::no_half_edge) continue;
        const u32 start = half_edges::start(mesh, half_edge);
        if (!from_quadrics[start].known) continue;
        const double from_plane =
            distance_from_plane(mesh.positions[start], mesh.positions[half_edges::end(mesh, half_edge)],
                                mesh.positions[half_edges::end(mesh, half_edges::after(half_edge))],
                                mesh.positions[half_edges::end(mesh, half_edges::after(other))]);
        errors.push_back(std::copysign(std::min(std::abs(from_plane), from_quadrics[start].two), from_plane));
    }
    if (errors.empty()) return 0;
    constexpr double median_of_the_smaller = 0.3757;  // median of min(|x|, |y|) for standard normal x and y
    const double concave = -quantile(errors, 0.25), convex = quantile(errors, 0.75);
    const double noise = std::min(concave, convex) / median_of_the_smaller;
    constexpr double rounding = 1e-9;
    return noise > rounding * bounding_box(mesh.positions.span()).diagonal() ? noise : 0;
}

NoisyNormals noisy_normals(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const Vec3> own,
                           double noise, double angle, const Execution& execution,
                           const std::vector<bool>& candidates) {
    NoisyNormals result{Array<Vec3>(own.begin(), own.end())};
    if (!(noise > 0)) return result;
    const Limits limits(noise, angle, mesh.triangles.size());
    std::vector<u32> unreliable;
    for (u32 t = 0; t < mesh.triangles.size(); ++t)
        if ((candidates.empty() || candidates[t]) && own[t] != Vec3::Zero() &&
            !half_edges::has_repeated_vertex(mesh.triangles[t]) &&
            !middle_reaches(scatter_of(mesh, mesh.triangles[t]), limits.reliable))
            unreliable.push_back(t);
    result.unreliable = unreliable.size();
    if (unreliable.empty()) return result;

    constexpr double not_wanted = -1;
    std::vector<double> errors(mesh.triangles.size(), not_wanted);
    for (const u32 t : unreliable) {
        const Eigen::SelfAdjointEigenSolver<Matrix> solver(scatter_of(mesh, mesh.triangles[t]), Eigen::EigenvaluesOnly);
        const double middle = solver.eigenvalues()[1];
        errors[t] = middle > 0 ? limits.variance / middle : std::numeric_limits<double>::infinity();
    }
    const Lists<> neighbours = neighbours_of(mesh, opposite), triangles_at = triangles_of(mesh);
    const Array<Vec3> areas = vertex_area_vectors(mesh);
    const std::vector<u32> centres = near_vertices(mesh, neighbours, unreliable);
    constexpr u32 outside = ~u32(0);
    std::vector<u32> rank(mesh.positions.size(), outside);  // of every vertex in the current neighbourhood
    std::vector<double> radii;  // squared
    const auto offer = [&](const Neighbourhoods& found) {
        radii.push_back(found.radius);
        for (u32 i = 0; i < found.vertices.size(); ++i) rank[found.vertices[i]] = i;
        for (const u32 vertex : found.vertices)
            for (const u32 t : triangles_at[vertex]) {
                const auto& [a, b, c] = mesh.triangles[t];
                if (a != vertex || rank[b] == outside || rank[c] == outside) continue;
                const Plane& plane = found.best[std::max({rank[a], rank[b], rank[c]})];
                const bool is_better =
                    plane.error < errors[t] || (plane.error == errors[t] && plane.normal != Vec3::Zero() &&
                                                is_lower(plane.normal, result.unit[t]));
                if (!is_better) continue;
                errors[t] = plane.error;
                result.unit[t] = plane.normal;
            }
        for (const u32 vertex : found.vertices) rank[vertex] = outside;
    };
    constexpr std::size_t block = 1 << 10;
    using Block = std::vector<Neighbourhoods>;
    Growers growers([&] { return std::make_unique<Grower>(mesh, neighbours, areas, limits); });
    for_each_in_order<Block>(
        execution.threads(), (centres.size() + block - 1) / block,
        [&](std::size_t i, Block& found) {
            execution.check_cancelled();
            found.clear();
            std::unique_ptr<Grower> grower = growers.take();
            for (std::size_t c = i * block; c < std::min(centres.size(), (i + 1) * block); ++c)
                found.push_back(grower->around(centres[c]));
            growers.give_back(std::move(grower));
        },
        [&](std::size_t, Block& found) { std::ranges::for_each(found, offer); });
    result.reach = 2 * std::sqrt(quantile(radii, 0.5));
    return result;
}

}  // namespace scanmill
