// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/creases.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <queue>
#include <utility>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/noisy_normals.hpp"
#include "scanmill/geometry/mesh/sharp_edges.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/lists.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr u32 none = ~u32(0);
/// An edge that continues a line has at least this share of the sharp angle: a turn that is divided among two edges
/// leaves half of it to one of them.
constexpr double weaker_share = 0.5;
/// Largest number of edges side by side among which the turn of a crease is divided.
constexpr double most_turns = 4;
/// Cosine of the largest angle between a line and the path over a gap: 60 degrees, as triangles' edges allow no finer
/// choice of direction.
constexpr double least_gap_cosine = 0.5;

/// The sharp and boundary edges of a mesh as lines.
class Lines {
public:
    Lines(const TriangleMesh& mesh, std::span<const u32> opposite, std::vector<bool>& sharp)
        : mesh_(mesh),
          opposite_(opposite),
          sharp_(sharp),
          edges_at_(mesh.positions.size(),
                    [&](auto&& add) {
                        for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
                            if (opposite[half_edge] == half_edges::no_half_edge) continue;
                            add(half_edges::start(mesh, half_edge), half_edge);
                            if (is_boundary(half_edge)) add(half_edges::end(mesh, half_edge), half_edge);
                        }
                    }),
          counts_(mesh.positions.size(), 0) {
        for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
            if (opposite[half_edge] == half_edges::no_half_edge || !is_line(half_edge)) continue;
            ++counts_[half_edges::start(mesh, half_edge)];
            if (is_boundary(half_edge)) ++counts_[half_edges::end(mesh, half_edge)];
        }
    }

    /// Continues lines from their free ends along edges where the normals differ by more than `angle`. The direction of
    /// a line is that of its last part, which is at least `reach` long.
    void extend(std::span<const Vec3> normals, double angle, double reach) {
        for (const u32 end : free_ends()) {
            for (u32 vertex = end; counts_[vertex] == 1;) {
                const Vec3 forward = direction_at(vertex, reach);
                u32 best = none;
                double largest = angle;
                for (const u32 edge : edges_at_[vertex]) {
                    if (is_line(edge) || !(step(vertex, edge).dot(forward) > 0)) continue;
                    const double turn = angle_between(normals[edge / 3], normals[opposite_[edge] / 3]);
                    if (!(turn > largest || (turn == largest && best != none &&
                                             is_lower(position(other(vertex, edge)), position(other(vertex, best))))))
                        continue;
                    best = edge;
                    largest = turn;
                }
                if (best == none) break;
                add(best);
                vertex = other(vertex, best);
            }
        }
    }

    /// Joins free ends that few edges connect, the shortest path first.
    void bridge(double reach) {
        std::vector<Gap> gaps;
        const std::vector<u32> ends = free_ends();
        Array<Vec3> forward(mesh_.positions.size(), Vec3(Vec3::Zero()));
        for (const u32 end : ends) forward[end] = direction_at(end, reach);
        for (const u32 end : ends) {
            Gap gap{0, end, end, {}};
            find_gaps(gap, forward, gaps);
        }
        std::ranges::sort(gaps, [&](const Gap& a, const Gap& b) {
            if (a.length != b.length) return a.length < b.length;
            if (a.begin != b.begin) return is_lower(position(a.begin), position(b.begin));
            return is_lower(position(a.end), position(b.end));
        });
        for (const Gap& gap : gaps) {
            if (counts_[gap.begin] != 1 || counts_[gap.end] != 1) continue;
            u32 vertex = gap.begin;
            bool is_free = true;
            for (const u32 edge : gap.path) {
                vertex = other(vertex, edge);
                is_free = is_free && (vertex == gap.end || counts_[vertex] == 0);
            }
            if (!is_free) continue;
            for (const u32 edge : gap.path) add(edge);
        }
    }

    /// Removes lines that meet neither other lines nor the boundary if all of their edges together are shorter than
    /// `length`. Edges of `exact` stay, and lines end where they meet one.
    void drop_isolated(double length, std::span<const Edge> exact) {
        std::vector<bool> ends(mesh_.positions.size(), false);
        for (const Edge& edge : exact) ends[edge[0]] = ends[edge[1]] = true;
        const auto is_exact = [&](u32 half_edge) {
            const u32 start = half_edges::start(mesh_, half_edge), end = half_edges::end(mesh_, half_edge);
            return ends[start] && ends[end] && std::ranges::binary_search(exact, make_edge(start, end));
        };
        // An edge belongs to the component of its half-edge. Those of a vertex are joined.
        DisjointSets components(opposite_.size());
        std::vector<u32> edges, first_at(mesh_.positions.size(), none);
        for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge) {
            if (opposite_[half_edge] == half_edges::no_half_edge || !is_line(half_edge)) continue;
            if (is_exact(half_edge)) continue;
            if (!is_boundary(half_edge) && half_edge > opposite_[half_edge]) continue;
            edges.push_back(half_edge);
            for (const u32 vertex : {half_edges::start(mesh_, half_edge), half_edges::end(mesh_, half_edge)}) {
                if (ends[vertex]) continue;
                if (first_at[vertex] == none) first_at[vertex] = half_edge;
                components.unite(first_at[vertex], half_edge);
            }
        }
        std::vector<double> lengths(opposite_.size(), 0);
        for (const u32 edge : edges)
            lengths[components.find(edge)] +=
                is_boundary(edge) ? length : step(half_edges::start(mesh_, edge), edge).norm();
        for (const u32 edge : edges)
            if (lengths[components.find(edge)] < length) remove(edge);
    }

    /// Removes lines and branches with a free end that are shorter than `length`, the shortest first. So the longer of
    /// two branches at a fork continues the line.
    void prune(double length) {
        struct Branch {
            double length;
            u32 end;
        };
        const auto is_after = [&](const Branch& a, const Branch& b) {
            return a.length != b.length ? a.length > b.length : is_lower(position(b.end), position(a.end));
        };
        std::priority_queue<Branch, std::vector<Branch>, decltype(is_after)> branches(is_after);
        std::vector<u32> path;
        for (const u32 end : free_ends()) branches.push({follow(end, length, path), end});
        while (!branches.empty()) {
            const Branch branch = branches.top();
            branches.pop();
            if (counts_[branch.end] != 1) continue;
            const double now = follow(branch.end, length, path);
            if (!(now < length)) continue;
            if (now > branch.length) {  // another branch at its fork was removed
                branches.push({now, branch.end});
                continue;
            }
            for (const u32 edge : path) remove(edge);
            std::vector<u32> rest;
            for (const u32 end : {half_edges::start(mesh_, path.back()), half_edges::end(mesh_, path.back())})
                if (counts_[end] == 1) branches.push({follow(end, length, rest), end});
        }
    }

    /// Joins every face smaller than `least_area` to the neighbour with the longest common border. A face is a set of
    /// triangles connected across edges that are not sharp. Returns whether lines were removed.
    bool merge_faces(double least_area) {
        const u32 triangles = static_cast<u32>(mesh_.triangles.size());
        DisjointSets faces(triangles);
        std::vector<u32> edges;
        for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge) {
            const u32 beyond = opposite_[half_edge];
            if (beyond >= half_edges::no_half_edge || beyond < half_edge) continue;
            if (sharp_[half_edge])
                edges.push_back(half_edge);
            else
                faces.unite(half_edge / 3, beyond / 3);
        }
        if (edges.empty()) return false;
        std::vector<double> areas(triangles, 0);
        for (u32 t = 0; t < triangles; ++t)
            areas[faces.find(t)] += area_vector(mesh_.positions, mesh_.triangles[t]).norm() / 2;
        struct Border {
            double area;
            u32 face, half_edge;
            auto operator<=>(const Border&) const = default;
        };
        std::vector<Border> borders;
        for (const u32 edge : edges)
            for (const u32 side : {edge, opposite_[edge]}) {
                const u32 face = faces.find(side / 3);
                if (areas[face] < least_area) borders.push_back({areas[face], face, side});
            }
        std::ranges::sort(borders);
        bool is_changed = false;
        for (std::size_t begin = 0, end = 0; begin < borders.size(); begin = end) {
            const Border& first = borders[begin];
            while (end < borders.size() && borders[end].face == first.face) ++end;
            if (faces.find(first.face) != first.face || areas[first.face] != first.area)
                continue;  // the face has grown
            std::map<u32, double> lengths;
            for (std::size_t i = begin; i < end; ++i) {
                const u32 side = borders[i].half_edge, neighbour = faces.find(opposite_[side] / 3);
                if (neighbour != first.face) lengths[neighbour] += step(half_edges::start(mesh_, side), side).norm();
            }
            if (lengths.empty()) continue;
            const u32 longest =
                std::ranges::max_element(lengths, {}, [](const auto& entry) { return entry.second; })->first;
            for (std::size_t i = begin; i < end; ++i) {
                const u32 side = borders[i].half_edge;
                if (sharp_[side] && faces.find(opposite_[side] / 3) == longest) remove(side);
            }
            const double area = areas[first.face] + areas[longest];
            faces.unite(first.face, longest);
            areas[faces.find(first.face)] = area;
            is_changed = true;
        }
        return is_changed;
    }

    void remove_smaller(double size) {
        do prune(size);
        while (merge_faces(size * size));
    }

private:
    /// A path from one free end to another.
    struct Gap {
        double length;
        u32 begin, end;
        std::vector<u32> path;  ///< edges
    };

    const Vec3& position(u32 vertex) const { return mesh_.positions[vertex]; }
    bool is_boundary(u32 half_edge) const { return opposite_[half_edge] == half_edges::boundary; }
    bool is_line(u32 half_edge) const { return sharp_[half_edge] || is_boundary(half_edge); }
    u32 other(u32 vertex, u32 half_edge) const {
        const u32 start = half_edges::start(mesh_, half_edge);
        return start == vertex ? half_edges::end(mesh_, half_edge) : start;
    }
    Vec3 step(u32 vertex, u32 half_edge) const { return position(other(vertex, half_edge)) - position(vertex); }

    void add(u32 edge) { change(edge, true, 1); }
    void remove(u32 edge) { change(edge, false, ~u32(0)); }
    void change(u32 edge, bool is_sharp, u32 change) {
        sharp_[edge] = sharp_[opposite_[edge]] = is_sharp;
        counts_[half_edges::start(mesh_, edge)] += change;
        counts_[half_edges::end(mesh_, edge)] += change;
    }

    /// Ends of lines that meet no other line, by position.
    std::vector<u32> free_ends() const {
        std::vector<u32> ends;
        for (u32 vertex = 0; vertex < counts_.size(); ++vertex)
            if (counts_[vertex] == 1) ends.push_back(vertex);
        std::ranges::stable_sort(ends, [&](u32 a, u32 b) { return is_lower(position(a), position(b)); });
        return ends;
    }

    /// Follows a line from a free end until it is `reach` long, ends or meets another line. Sets `path` to its edges
    /// and returns its length.
    double follow(u32 end, double reach, std::vector<u32>& path) const {
        path.clear();
        double length = 0;
        u32 vertex = end;
        do {
            u32 next = none;
            for (const u32 edge : edges_at_[vertex])
                if (is_line(edge) && (path.empty() || other(vertex, edge) != other(vertex, path.back()))) next = edge;
            if (next == none) break;
            path.push_back(next);
            length += step(vertex, next).norm();
            vertex = other(vertex, next);
        } while (counts_[vertex] == 2 && length < reach);
        return length;
    }

    /// The direction in which a line arrives at its free end.
    Vec3 direction_at(u32 end, double reach) const {
        std::vector<u32> path;
        follow(end, reach, path);
        u32 vertex = end;
        for (const u32 edge : path) vertex = other(vertex, edge);
        return (position(end) - position(vertex)).normalized();
    }

    /// Adds the paths that continue `gap` to another free end. `forward`: by free end the direction of its line.
    void find_gaps(Gap& gap, const Array<Vec3>& forward, std::vector<Gap>& gaps) const {
        const u32 vertex = gap.end;
        for (const u32 edge : edges_at_[vertex]) {
            if (is_line(edge)) continue;
            const u32 next = other(vertex, edge);
            const Vec3 across = position(next) - position(gap.begin);
            const double least = least_gap_cosine * across.norm();
            if (next == gap.begin || counts_[next] > 1 || !(across.dot(forward[gap.begin]) >= least)) continue;
            gap.path.push_back(edge);
            gap.end = next;
            const double length = std::exchange(gap.length, gap.length + step(vertex, edge).norm());
            if (counts_[next] == 0) {
                if (gap.path.size() < most_gap_edges) find_gaps(gap, forward, gaps);
            } else if (-across.dot(forward[next]) >= least) {
                gaps.push_back(gap);
            }
            gap.path.pop_back();
            gap.end = vertex;
            gap.length = length;
        }
    }

    const TriangleMesh& mesh_;
    std::span<const u32> opposite_;
    std::vector<bool>& sharp_;
    Lists<> edges_at_;  ///< by vertex: a half-edge of each of its edges
    Array<u32> counts_;  ///< by vertex: number of its sharp and boundary edges
};

/// By triangle, whether it is at most two triangles away from a part of a crease whose turn is divided: an edge where
/// the normals differ by at most the sharp angle, but by more than its part for the largest number of edges.
std::vector<bool> near_divided(const TriangleMesh& mesh, std::span<const u32> opposite, std::span<const Vec3> normals,
                               double sharp_angle) {
    std::vector<bool> is_near(mesh.positions.size(), false), found(mesh.triangles.size(), false);
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
        const u32 other = opposite[half_edge];
        if (other > half_edge) continue;
        const double angle = angle_between(normals[half_edge / 3], normals[other / 3]);
        if (angle > sharp_angle / most_turns && !(angle > sharp_angle + angle_tie))
            is_near[half_edges::start(mesh, half_edge)] = is_near[half_edges::end(mesh, half_edge)] = true;
    }
    for (int rounds = 0; rounds < 2; ++rounds) {
        for (u32 t = 0; t < mesh.triangles.size(); ++t)
            found[t] = std::ranges::any_of(mesh.triangles[t], [&](u32 vertex) { return is_near[vertex]; });
        for (u32 t = 0; t < mesh.triangles.size(); ++t)
            if (found[t])
                for (const u32 vertex : mesh.triangles[t]) is_near[vertex] = true;
    }
    return found;
}

}  // namespace

Creases find_creases(const TriangleMesh& mesh, std::span<const u32> opposite, const CreaseParams& params,
                     const Execution& execution) {
    Creases result;
    FacetNormals own = facet_normals(mesh, opposite, execution.threads());
    result.without_area = own.without_area;
    result.noise = params.noise ? *params.noise : vertex_noise(mesh, opposite, execution);
    const double error = params.noise || result.noise > 0 ? result.noise : sampling_error(mesh);
    // Without noise, triangles that bridge no crease keep their normals, which saves most of the time.
    std::vector<bool> candidates;
    if (error > result.noise) candidates = near_divided(mesh, opposite, own.unit, params.sharp_angle);
    NoisyNormals reliable = noisy_normals(mesh, opposite, own.unit, error, params.sharp_angle, execution, candidates);
    result.normals = std::move(reliable.unit);
    result.reach = reliable.reach;
    result.unreliable = reliable.unreliable;
    result.own_normals = std::move(own.unit);
    result.sharp =
        sharp_half_edges(mesh, opposite, result.normals, params.sharp_angle + angle_tie, execution.threads());
    if (!(result.reach > 0 || params.least_size > 0)) return result;
    execution.check_cancelled();
    Lines lines(mesh, opposite, result.sharp);
    if (result.reach > 0) {
        lines.extend(result.normals, weaker_share * params.sharp_angle + angle_tie, result.reach / 2);
        lines.bridge(result.reach / 2);
        lines.drop_isolated(result.reach, params.exact_declared ? mesh.sharp_edges.span() : std::span<const Edge>());
    }
    if (params.least_size > 0) lines.remove_smaller(params.least_size);
    return result;
}

double sampling_error(const TriangleMesh& mesh) {
    constexpr double share = 1. / 12;
    const Column* column = mesh.vertex_columns.find("bin-size");
    if (column == nullptr || column->components() != 1) return 0;
    std::vector<double> sizes;
    for (std::size_t row = 0; row < column->rows(); ++row)
        if (const double size = column->number(row); size > 0 && std::isfinite(size)) sizes.push_back(size);
    return sizes.empty() ? 0 : share * median(sizes);
}

}  // namespace scanmill
