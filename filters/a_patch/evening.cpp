// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/evening.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <set>
#include <tuple>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/lists.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr int rounds = 2, most_passes = 12;
constexpr double least_excess = 3.14e-3;  // radians by which the sum of two angles must exceed 180 degrees
constexpr double least_turn_cosine = 0.5, least_normal_cosine = 0.3;
constexpr double most_sag_factor = 4;
constexpr u32 least_triangles = 4;
constexpr std::size_t nearest_points = 4;

/// Positions in the order of `mesh.mesh.positions`, which they replace at the end of a move.
using Positions = std::vector<Vec3>;

Vec3 unit_normal(std::span<const Vec3> positions, const Triangle& t) { return area_vector(positions, t).normalized(); }

struct Candidate {
    double order;  // rises with the sum of the opposite angles
    Edge edge;
    u32 half;
    bool operator<(const Candidate& other) const {
        return std::tuple(-order, edge, half) < std::tuple(-other.order, other.edge, other.half);
    }
};

Lists<> triangles_around(const TriangleMesh& mesh) {
    return Lists<>(mesh.positions.size(), [&](auto&& add) {
        for (u32 f = 0; f < mesh.triangles.size(); ++f)
            for (const u32 v : mesh.triangles[f]) add(v, f);
    });
}

class Flipper {
public:
    Flipper(PatchMesh& mesh, const std::vector<bool>& is_fixed, double most_sag)
        : mesh_(mesh),
          is_fixed_(is_fixed),
          most_sag_(most_sag),
          triangles_(mesh.mesh.triangles.begin(), mesh.mesh.triangles.end()) {}

    std::size_t flip() {
        std::size_t all = 0;
        for (int pass = 0; pass < most_passes; ++pass) {
            const std::size_t flipped = flip_once();
            if (flipped == 0) break;
            mesh_.mesh.triangles = Array<Triangle>(triangles_.begin(), triangles_.end());
            all += flipped;
        }
        return all;
    }

private:
    const Vec3& at(u32 vertex) const { return mesh_.mesh.positions[vertex]; }

    std::size_t flip_once() {
        opposites_ = half_edges::opposites(mesh_.mesh);
        around_ = triangles_around(mesh_.mesh);
        count_.clear();
        for (std::size_t v = 0; v < mesh_.mesh.positions.size(); ++v)
            count_.push_back(static_cast<u32>(around_[v].size()));
        std::vector<Candidate> candidates;
        for (u32 half = 0; half < opposites_.size(); ++half)
            if (const double order = order_of(half); order > -1) {
                const Edge edge = make_edge(half_edges::start(mesh_.mesh, half), half_edges::end(mesh_.mesh, half));
                if (!std::ranges::binary_search(mesh_.mesh.sharp_edges, edge))
                    candidates.push_back({order, edge, half});
            }
        std::ranges::sort(candidates, std::less<>());
        std::vector<bool> is_changed(triangles_.size(), false);
        std::set<Edge> added;
        std::size_t flipped = 0;
        for (const Candidate& candidate : candidates) {
            const u32 f = candidate.half / 3, g = opposites_[candidate.half] / 3;
            if (is_changed[f] || is_changed[g] || !flip(candidate.half, added)) continue;
            is_changed[f] = is_changed[g] = true;
            ++flipped;
        }
        return flipped;
    }

    /// Rises with the sum of the angles opposite to an edge; -1 if that is at most 180 degrees.
    double order_of(u32 half) const {
        const u32 other = opposites_[half];
        if (other == half_edges::boundary || other < half) return -1;
        const Vec3 &a = at(half_edges::start(mesh_.mesh, half)), &b = at(half_edges::end(mesh_.mesh, half));
        std::array<double, 2> sine, cosine;
        for (std::size_t of = 0; of < 2; ++of) {
            const Vec3& c = at(half_edges::start(mesh_.mesh, half_edges::before(of == 0 ? half : other)));
            const Vec3 u = a - c, v = b - c;
            const double length = u.norm() * v.norm();
            sine[of] = u.cross(v).norm() / length;
            cosine[of] = u.dot(v) / length;
        }
        if (sine[0] * cosine[1] + cosine[0] * sine[1] >= -least_excess) return -1;
        return cosine[0] * cosine[1] - sine[0] * sine[1];  // cosine of the sum, which is above 180 degrees
    }

    bool exists(u32 c, u32 d, const std::set<Edge>& added) const {
        if (added.contains(make_edge(c, d))) return true;
        return std::ranges::any_of(around_[c], [&](u32 f) {
            const Triangle& t = mesh_.mesh.triangles[f];  // as they were before this pass
            return std::ranges::find(t, d) != t.end();
        });
    }

    double sag(u32 u, u32 v, const Vec3& of_u, const Vec3& of_v) const {
        return std::abs((of_u - of_v).dot(at(v) - at(u))) / 8;
    }

    bool flip(u32 half, std::set<Edge>& added) {
        const u32 other = opposites_[half], f = half / 3, g = other / 3;
        // Corners of f: i, j, c. Corners of g: j, i, d.
        const u32 at_i = half % 3, at_j = half_edges::after(half) % 3, at_c = half_edges::before(half) % 3,
                  at_d = half_edges::before(other) % 3;
        const u32 i = triangles_[f][at_i], j = triangles_[f][at_j], c = triangles_[f][at_c], d = triangles_[g][at_d];
        const Vec3 of_i = mesh_.normals[f][at_i], of_j = mesh_.normals[f][at_j], of_c = mesh_.normals[f][at_c],
                   of_d = mesh_.normals[g][at_d];
        if (is_fixed_[i] || is_fixed_[j] || is_fixed_[c] || is_fixed_[d]) return false;
        if (c == d || count_[i] <= least_triangles || count_[j] <= least_triangles || exists(c, d, added)) return false;
        if (sag(c, d, of_c, of_d) > std::max(most_sag_factor * sag(i, j, of_i, of_j), most_sag_)) return false;
        const Triangle one{c, d, j}, second{d, c, i};
        const Vec3 n = unit_normal(mesh_.mesh.positions, one), m = unit_normal(mesh_.mesh.positions, second);
        if (!(n.dot(m) >= least_turn_cosine)) return false;
        for (const double cosine : {n.dot(of_c), n.dot(of_d), n.dot(of_j), m.dot(of_d), m.dot(of_c), m.dot(of_i)})
            if (!(cosine >= least_normal_cosine)) return false;
        triangles_[f] = one;
        mesh_.normals[f] = {of_c, of_d, of_j};
        triangles_[g] = second;
        mesh_.normals[g] = {of_d, of_c, of_i};
        --count_[i];
        --count_[j];
        ++count_[c];
        ++count_[d];
        added.insert(make_edge(c, d));
        return true;
    }

    PatchMesh& mesh_;
    const std::vector<bool>& is_fixed_;
    double most_sag_;
    std::vector<Triangle> triangles_;  ///< after the flips of this pass
    Array<u32> opposites_;
    Lists<> around_;
    std::vector<u32> count_;  ///< of triangles, by vertex
};

/// The normals of a mesh as it was, at any point near it.
class NormalField {
public:
    NormalField(const PatchMesh& mesh, unsigned threads)
        : positions_(mesh.mesh.positions.begin(), mesh.mesh.positions.end()),
          triangles_(mesh.mesh.triangles.begin(), mesh.mesh.triangles.end()),
          normals_(mesh.normals),
          tree_(positions_, triangles_, threads) {}

    Vec3 at(const Vec3& point) const {
        const NearestTriangle nearest = tree_.nearest(point);
        const Triangle& t = triangles_[nearest.triangle];
        const Vec3 foot = tree_.nearest_point(point, nearest.slot), normal = area_vector(positions_, t);
        Vec3 sum = Vec3::Zero();
        for (std::size_t i = 0; i < 3; ++i)
            sum +=
                std::max(0.0, area_vector(foot, positions_[t[(i + 1) % 3]], positions_[t[(i + 2) % 3]]).dot(normal)) *
                normals_[nearest.triangle][i];
        return sum.normalized();
    }

private:
    std::vector<Vec3> positions_;
    std::vector<Triangle> triangles_;
    CornerNormals normals_;
    TriangleTree tree_;
};

void move_vertices(PatchMesh& mesh, const std::vector<bool>& is_free, const PointTree& points,
                   const NormalField& field) {
    const std::span triangles = mesh.mesh.triangles.span();
    Positions positions(mesh.mesh.positions.begin(), mesh.mesh.positions.end());
    const Lists<> around = triangles_around(mesh.mesh);
    double edges = 0;
    for (const Triangle& t : triangles) edges += (positions[t[1]] - positions[t[0]]).norm();
    const double mean_edge = edges / static_cast<double>(triangles.size());
    NeighbourBuffer buffer;
    for (u32 v = 0; v < positions.size(); ++v) {
        if (!is_free[v] || around[v].empty()) continue;
        const Vec3 old = positions[v];
        Vec3 normal = Vec3::Zero(), sum = Vec3::Zero();
        double weights = 0;
        std::vector<Vec3> before;
        for (const u32 f : around[v]) {
            const Triangle& t = triangles[f];
            for (std::size_t i = 0; i < 3; ++i)
                if (t[i] == v) normal = mesh.normals[f][i];
            const Vec3 area = area_vector(positions, t);
            const double weight = std::sqrt(area.norm());
            sum += weight * (positions[t[0]] + positions[t[1]] + positions[t[2]]) / 3;
            weights += weight;
            before.push_back(area.normalized());
        }
        const Vec3 way = sum / weights - old;
        Vec3 moved = old + (way - normal * normal.dot(way)) / 2;
        const Vec3 turned = field.at(moved);
        double height = 0, total = 0;
        bool is_near = false;
        for (const Neighbour& each : points.nearest_to(moved, nearest_points, buffer)) {
            const double distance = std::sqrt(each.squared), weight = 1 / std::max(distance, 1e-9 * mean_edge);
            is_near = is_near || distance <= mean_edge;
            height += weight * (points.positions()[each.index] - moved).dot(turned);
            total += weight;
        }
        if (!is_near) continue;
        moved += turned * (height / total);
        positions[v] = moved;
        for (std::size_t i = 0; i < before.size(); ++i) {
            const u32 f = around[v][i];
            const Vec3 after = unit_normal(positions, triangles[f]);
            bool fits = after.dot(before[i]) >= least_turn_cosine;
            for (std::size_t corner = 0; corner < 3; ++corner) {
                const Vec3& there = triangles[f][corner] == v ? turned : mesh.normals[f][corner];
                fits = fits && (there == Vec3::Zero() ||
                                after.dot(there) >= std::min(least_normal_cosine, before[i].dot(there)));
            }
            if (fits) continue;
            positions[v] = old;
            break;
        }
        if (positions[v] == old) continue;
        for (const u32 f : around[v])
            for (std::size_t i = 0; i < 3; ++i)
                if (triangles[f][i] == v) mesh.normals[f][i] = turned;
    }
    mesh.mesh.positions = Array<Vec3>(positions.begin(), positions.end());
}

}  // namespace

std::vector<bool> free_vertices(const PatchMesh& mesh) {
    std::vector<bool> is_free(mesh.mesh.positions.size(), true);
    for (const Edge& edge : mesh.mesh.sharp_edges)
        for (const u32 v : edge) is_free[v] = false;
    const Array<u32> opposites = half_edges::opposites(mesh.mesh);
    for (u32 half = 0; half < opposites.size(); ++half) {
        const u32 v = half_edges::start(mesh.mesh, half);
        if (mesh.normals[half / 3][half % 3] == Vec3::Zero()) is_free[v] = false;
        if (opposites[half] == half_edges::boundary) is_free[v] = is_free[half_edges::end(mesh.mesh, half)] = false;
    }
    return is_free;
}

std::size_t flip_edges(PatchMesh& mesh, const std::vector<bool>& is_fixed, double most_sag) {
    return Flipper(mesh, is_fixed, most_sag).flip();
}

std::size_t make_even(PatchMesh& mesh, const std::vector<bool>& is_free, const std::vector<bool>& is_fixed,
                      const PointTree& points, double most_sag, Execution& execution) {
    const NormalField field(mesh, execution.threads());
    std::size_t flips = 0;
    for (int round = 0; round < rounds; ++round) {
        execution.check_cancelled();
        flips += flip_edges(mesh, is_fixed, most_sag);
        move_vertices(mesh, is_free, points, field);
    }
    return flips;
}

}  // namespace scanmill::a_patches
