// SPDX-License-Identifier: GPL-3.0-or-later
/// No removal is left: on small meshes every triangulation of every hole is tried, in plain code.
///
/// A removal keeps the limits if a triangulation of the ring, on each side of the feature line, has
///  - no edge that the mesh has elsewhere, and no vertex with more edges than allowed;
///  - triangles within the normal deviation of the mean normal of the old ones, without angles below the least one;
///  - no neighbours folded onto each other and no intersections;
///  - new edges whose paths on the input, in the vertical plane through both ends, are within max-error, and triangles
///    within max-error of the removed vertices that lie between the paths of their edges.
#include <gmock/gmock.h>

#include <optional>

#include "decimate/decimator.hpp"
#include "filters/decimate/cases.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/mesh/creases.hpp"

namespace scanmill::test {
namespace {

using namespace decimating;

double length_off_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const double share = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - share * (b - a)).norm();
}

/// A small mesh, decimated, with the points that the result represents.
class Removals {
public:
    Removals(const TriangleMesh& mesh, double max_error, double least_angle_degrees, bool flips)
        : mesh_(mesh),
          opposite_(half_edges::opposites(mesh_)),
          creases_(find_creases(mesh_, opposite_, {0.7, {}, 4 * max_error}, Execution())),
          features_(mesh_, opposite_, creases_.sharp, {0.6, std::max(creases_.reach, 4 * max_error)}),
          lowest_(lowest_at_position(mesh_.positions.span())),
          original_(mesh_, opposite_, lowest_, features_),
          surface_(original_, EditableMesh(mesh_, opposite_), {}) {
        limits_.error = {max_error, max_error};
        limits_.angle_sine = std::sin(least_angle_degrees * std::numbers::pi / 180);
        limits_.flat_angle_sine = limits_.angle_sine;
        Execution execution;
        removed_ = Decimator(surface_, limits_, DecimateMode::direct, 0, execution).run(flips).removed;
        for (u32 row = 0; row < surface_.mesh().rows(); ++row)
            if (!surface_.mesh().is_empty(row)) rows_.push_back(row);
        for (u32 t = 0; t < mesh_.triangles.size(); ++t)
            for (const u32 vertex : mesh_.triangles[t]) triangles_at_[vertex].push_back(t);
    }

    std::size_t removed() const { return removed_; }
    std::size_t tried() const { return tried_; }

    /// A vertex that may still be removed.
    std::optional<u32> another() {
        for (u32 vertex = 0; vertex < mesh_.positions.size(); ++vertex)
            if (surface_.mesh().is_used(vertex) && features_.vertex_class(vertex) != VertexClass::corner &&
                is_removable(vertex))
                return vertex;
        return {};
    }

private:
    using Ring = std::vector<u32>;
    using Triangles = std::vector<Triangle>;
    struct Side {
        Ring ring{};  ///< the last edge, back to the first, is new on a line
        Vec3 up = Vec3::Zero();
        double least_sine = 1;
        std::vector<Vec3> points{};
    };

    const Vec3& at(u32 vertex) const { return mesh_.positions[vertex]; }
    Vec3 normal(const Triangle& t) const { return (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])); }
    double least_sine(const Triangle& t) const {
        double least = 1;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 u = at(t[(i + 1) % 3]) - at(t[i]), v = at(t[(i + 2) % 3]) - at(t[i]);
            const double sine = u.cross(v).norm() / (u.norm() * v.norm());
            // The sine of the least angle is the least of the three.
            least = std::min(least, sine);
        }
        return least;
    }
    bool is_edge(u32 a, u32 b) const {
        return std::ranges::any_of(rows_, [&](u32 row) {
            const Triangle t = surface_.mesh().triangle(row);
            return std::ranges::find(t, a) != t.end() && std::ranges::find(t, b) != t.end();
        });
    }

    /// The walk over the triangles of the input from one vertex to the other, in the plane through both and `up`.
    bool is_path_within(u32 from, u32 to, const Vec3& up) const {
        const Vec3 along = at(to) - at(from), sideways = up.cross(along);
        const auto height = [&](u32 vertex) { return sideways.dot(at(vertex) - at(from)); };
        const auto cut = [&](u32 right, u32 left) {
            const double share = height(right) / (height(right) - height(left));
            return Vec3(at(right) + share * (at(left) - at(right)));
        };
        u32 right = 0, left = 0, inside = ~u32(0);
        double farthest = 0;
        for (const u32 t : triangles_at_.at(from)) {
            Triangle corners = mesh_.triangles[t];
            while (corners[0] != from) std::ranges::rotate(corners, corners.begin() + 1);
            if (corners[1] == to || corners[2] == to) return true;
            if (!(height(corners[1]) < 0 && height(corners[2]) >= 0)) continue;
            const double reach = (cut(corners[1], corners[2]) - at(from)).dot(along);
            if (reach <= farthest) continue;
            farthest = reach;
            right = corners[1];
            left = corners[2];
            inside = t;
        }
        if (inside == ~u32(0)) return false;
        for (std::size_t steps = 0; steps < mesh_.triangles.size(); ++steps) {
            if (is_feature(right, left)) return false;
            if (length_off_segment(cut(right, left), at(from), at(to)) > limits_.error.outside) return false;
            u32 next = ~u32(0), apex = 0;
            for (const u32 t : triangles_at_.at(right)) {
                const Triangle& corners = mesh_.triangles[t];
                if (t == inside || std::ranges::find(corners, left) == corners.end()) continue;
                next = t;
                for (const u32 vertex : corners)
                    if (vertex != right && vertex != left) apex = vertex;
            }
            inside = next;
            if (apex == to) return true;
            (height(apex) < 0 ? right : left) = apex;
        }
        return false;
    }
    bool is_feature(u32 a, u32 b) const {
        for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge)
            if (make_edge(half_edges::start(mesh_, half_edge), half_edges::end(mesh_, half_edge)) == make_edge(a, b))
                return features_.is_feature(half_edge);
        return false;
    }

    /// Whether the triangle (positions i < k < j of the ring) is within the limits.
    bool is_allowed(const Side& side, u32 i, u32 k, u32 j) const {
        const Triangle t{side.ring[i], side.ring[k], side.ring[j]};
        const Vec3 n = normal(t).normalized();
        if (!(n.dot(side.up) >= limits_.normal_cosine)) return false;
        if (least_sine(t) < std::min(limits_.angle_sine, side.least_sine * (1 - 1e-9))) return false;
        const u32 size = static_cast<u32>(side.ring.size());
        const auto is_left = [&](u32 from, u32 to, const Vec3& p) {
            if (to == from + 1) return true;
            if (from == 0 && to + 1 == size) return false;
            return side.up.cross(at(side.ring[to]) - at(side.ring[from])).dot(p - at(side.ring[from])) >= 0;
        };
        return std::ranges::all_of(side.points, [&](const Vec3& p) {
            if (!is_left(i, k, p) || !is_left(k, j, p) || is_left(i, j, p)) return true;
            return (p - nearest_on_triangle(p, at(t[0]), at(t[1]), at(t[2]))).norm() <= limits_.error.outside;
        });
    }

    /// All triangulations of the ring from i to j whose triangles and edges are allowed.
    std::vector<Triangles> triangulations(const Side& side, u32 i, u32 j) const {
        if (j == i + 1) return {{}};
        const bool is_outer = i == 0 && j + 1 == side.ring.size();
        if (!is_outer && (is_edge(side.ring[i], side.ring[j]) || !is_path_within(side.ring[i], side.ring[j], side.up)))
            return {};
        std::vector<Triangles> all;
        for (u32 k = i + 1; k < j; ++k) {
            if (!is_allowed(side, i, k, j)) continue;
            for (const Triangles& one : triangulations(side, i, k))
                for (const Triangles& other : triangulations(side, k, j)) {
                    Triangles joined = one;
                    joined.insert(joined.end(), other.begin(), other.end());
                    joined.push_back({side.ring[i], side.ring[k], side.ring[j]});
                    all.push_back(std::move(joined));
                }
        }
        return all;
    }

    bool is_removable(u32 vertex) {
        // The ring in order.
        std::map<u32, u32> next;
        std::set<u32> star, ends;
        for (const u32 row : rows_) {
            Triangle t = surface_.mesh().triangle(row);
            if (std::ranges::find(t, vertex) == t.end()) continue;
            while (t[0] != vertex) std::ranges::rotate(t, t.begin() + 1);
            next[t[1]] = t[2];
            star.insert(row);
            ends.insert(t[2]);
        }
        u32 begin = next.begin()->first;
        for (const auto& [from, to] : next)
            if (!ends.contains(from)) begin = from;
        Ring ring{begin};
        while (next.contains(ring.back()) && next[ring.back()] != begin) ring.push_back(next[ring.back()]);
        if (ring.size() > 9) return false;

        std::vector<Side> sides;
        const VertexClass kind = features_.vertex_class(vertex);
        if (kind == VertexClass::smooth) {
            sides.push_back({ring});
        } else {
            std::vector<u32> line{vertex};
            const auto line_ends = surface_.line_ends(vertex, [&](u32 passed) { line.push_back(passed); });
            if (is_edge(line_ends[0], line_ends[1])) return false;
            for (const u32 passed : line)
                if (length_off_segment(at(passed), at(line_ends[0]), at(line_ends[1])) > limits_.error.outside)
                    return false;
            std::size_t a = static_cast<std::size_t>(std::ranges::find(ring, line_ends[0]) - ring.begin()),
                        b = static_cast<std::size_t>(std::ranges::find(ring, line_ends[1]) - ring.begin());
            if (a > b) std::swap(a, b);
            sides.push_back({Ring(ring.begin() + static_cast<long>(a), ring.begin() + static_cast<long>(b) + 1)});
            if (kind == VertexClass::crease) {
                Ring other(ring.begin() + static_cast<long>(b), ring.end());
                other.insert(other.end(), ring.begin(), ring.begin() + static_cast<long>(a) + 1);
                sides.push_back({other});
            }
        }
        for (Side& side : sides) {
            if (side.ring.size() < 3) return false;
            for (const u32 row : star) {
                Triangle t = surface_.mesh().triangle(row);
                while (t[0] != vertex) std::ranges::rotate(t, t.begin() + 1);
                const auto from = std::ranges::find(side.ring, t[1]), to = std::ranges::find(side.ring, t[2]);
                if (from == side.ring.end() || to == side.ring.end()) continue;
                const bool wraps = kind == VertexClass::smooth && from + 1 == side.ring.end();
                if (!wraps && from + 1 != to) continue;
                side.up += normal(t);
                side.least_sine = std::min(side.least_sine, least_sine(t));
                surface_.for_each_point(row, [&](u32 point) { side.points.push_back(surface_.point(point)); });
            }
            side.up.normalize();
            if (kind == VertexClass::smooth) side.points.push_back(at(vertex));
        }
        ++tried_;
        std::vector<Triangles> all{{}};
        for (const Side& side : sides) {
            std::vector<Triangles> joined;
            for (const Triangles& triangles : triangulations(side, 0, static_cast<u32>(side.ring.size()) - 1))
                for (Triangles sum : all) {
                    sum.insert(sum.end(), triangles.begin(), triangles.end());
                    joined.push_back(std::move(sum));
                }
            all = std::move(joined);
        }
        return std::ranges::any_of(all, [&](const Triangles& made) { return is_valid(vertex, star, made); });
    }

    /// Whether the new triangles are a surface with the rest.
    bool is_valid(u32 vertex, const std::set<u32>& star, const Triangles& made) const {
        Triangles rest, after = made;
        for (const u32 row : rows_)
            if (!star.contains(row)) rest.push_back(surface_.mesh().triangle(row));
        after.insert(after.end(), rest.begin(), rest.end());
        std::map<Edge, std::vector<Triangle>> edges;
        std::map<u32, std::set<u32>> neighbours, before;
        for (const Triangle& t : after)
            for (std::size_t i = 0; i < 3; ++i) {
                edges[make_edge(t[i], t[(i + 1) % 3])].push_back(t);
                neighbours[t[i]].insert({t[(i + 1) % 3], t[(i + 2) % 3]});
            }
        for (const u32 row : rows_) {
            const Triangle t = surface_.mesh().triangle(row);
            for (std::size_t i = 0; i < 3; ++i) before[t[i]].insert({t[(i + 1) % 3], t[(i + 2) % 3]});
        }
        for (const auto& [other, around] : neighbours)
            if (around.size() > limits_.max_valence && around.size() > before[other].size()) return false;
        for (const Triangle& t : made) {
            for (std::size_t i = 0; i < 3; ++i)
                for (const Triangle& other : edges[make_edge(t[i], t[(i + 1) % 3])])
                    if (normal(t).normalized().dot(normal(other).normalized()) < std::cos(170 * std::numbers::pi / 180))
                        return false;
            for (const Triangle& other : after)
                if (other != t && triangles_intersect(mesh_.positions.span(), t, other)) return false;
        }
        return !neighbours.contains(vertex) && edges.size() + 2 >= after.size();
    }

    TriangleMesh mesh_;
    Array<u32> opposite_;
    Creases creases_;
    FeatureNetwork features_;
    Array<u32> lowest_;
    OriginalSurface original_;
    Surface surface_;
    Limits limits_;
    std::vector<u32> rows_;
    std::map<u32, std::vector<u32>> triangles_at_;
    std::size_t removed_ = 0, tried_ = 0;
};

TEST(DecimateMaximal, NoRemovalIsLeftThatKeepsTheLimits) {
    std::size_t removed = 0, tried = 0;
    for (std::uint64_t seed = 0; seed < 6; ++seed) {
        Random random(seed);
        const double noise = random.uniform(0.001, 0.05);
        const TriangleMesh meshes[] = {bumpy_sphere(4, noise, seed), bumpy_grid(12, 12, 4 * noise, seed),
                                       gridded_cube(5), cylinder(1, 2, 20, 4, 2)};
        for (const TriangleMesh& mesh : meshes) {
            ASSERT_LE(mesh.positions.size(), 200u);
            const double diagonal = surface_box(mesh).diagonal();
            for (const double share : {0.001, 0.01, 0.03})
                for (const double angle : {1.0, 15.0}) {
                    Removals removals(mesh, share * diagonal, angle, seed % 2 == 0);
                    const std::optional<u32> another = removals.another();
                    EXPECT_FALSE(another) << "vertex " << *another << " of " << mesh.positions.size() << ", seed "
                                          << seed << ", max-error " << share << " of the diagonal, angle " << angle;
                    removed += removals.removed();
                    tried += removals.tried();
                }
        }
    }
    EXPECT_GT(removed, 1000u);
    EXPECT_GT(tried, 1000u);
}

}  // namespace
}  // namespace scanmill::test
