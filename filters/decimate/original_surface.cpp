// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/original_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <iostream>
#include <map>
#include <queue>
#include <tuple>

#include "scanmill/base/disjoint_sets.hpp"

#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/sharp_edges.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill::decimating {

constexpr double infinite_area = std::numeric_limits<double>::infinity();
using half_edges::after;
using half_edges::before;

OriginalSurface::OriginalSurface(const TriangleMesh& mesh, std::span<const u32> opposite, const FeatureScale& scale,
                                 unsigned threads)
    : mesh_(mesh),
      opposite_(opposite),
      first_(mesh.positions.size(), half_edges::boundary),
      classes_(mesh.positions.size(), VertexClass::smooth) {
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
        u32& first = first_[half_edges::start(mesh, half_edge)];
        if (first == half_edges::boundary || opposite[half_edge] == half_edges::boundary) first = half_edge;
    }
    const FacetNormals normals = facet_normals(mesh, opposite, threads);
    find_features(normals.unit, scale, threads);
    classify(scale);
}

void OriginalSurface::find_features(std::span<const Vec3> normals, const FeatureScale& scale, unsigned threads) {
    features_ = sharp_half_edges(mesh_, opposite_, normals, scale.sharp_angle + angle_tie, threads);
    for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge) {
        if (opposite_[half_edge] == half_edges::boundary) features_[half_edge] = true;
    }
}

Vec3 OriginalSurface::line_point(u32 vertex, u32 next, double distance, bool& is_closed) const {
    const u32 begin = vertex;
    for (;;) {
        const Vec3 step = position(next) - position(vertex);
        const double length = step.norm();
        if (length >= distance) return position(vertex) + distance / length * step;
        if (next == begin) is_closed = true;
        if (next == begin || line_counts_[next] != 2) return position(next);
        distance -= length;
        const auto [one, other] = line_neighbours(next);
        const u32 further = one == vertex ? other : one;
        vertex = next;
        next = further;
    }
}

void OriginalSurface::count_lines() {
    line_counts_.assign(first_.size(), 0);
    for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge) {
        if (!features_[half_edge]) continue;
        ++line_counts_[half_edges::start(mesh_, half_edge)];
        if (opposite_[half_edge] == half_edges::boundary) ++line_counts_[half_edges::end(mesh_, half_edge)];
    }
}

void OriginalSurface::prune(double reach) {
    // Branches from their free ends on, the shortest first, so that of two branches at a fork the longer one stays.
    struct Branch {
        double length;
        u32 end;
        bool operator>(const Branch& other) const {
            return length != other.length ? length > other.length : end > other.end;
        }
    };
    std::vector<u32> path;
    const auto follow = [&](u32 end) {
        path.clear();
        double length = 0;
        u32 vertex = end, last = ~u32(0);
        do {
            u32 next = ~u32(0), found = half_edges::boundary;
            for_each_line(vertex, [&](u32 half_edge, u32 other) {
                if (other != last) next = other, found = half_edge;
            });
            if (next == ~u32(0)) break;
            path.push_back(found);
            length += (position(next) - position(vertex)).norm();
            last = vertex;
            vertex = next;
        } while (line_counts_[vertex] == 2 && length < reach);
        return length;
    };
    std::priority_queue<Branch, std::vector<Branch>, std::greater<>> branches;
    for (u32 vertex = 0; vertex < first_.size(); ++vertex)
        if (line_counts_[vertex] == 1) branches.push({follow(vertex), vertex});
    while (!branches.empty()) {
        const Branch branch = branches.top();
        branches.pop();
        if (line_counts_[branch.end] != 1) continue;
        const double length = follow(branch.end);
        if (length >= reach) continue;
        if (length > branch.length) {  // it became longer when another was removed at its fork
            branches.push({length, branch.end});
            continue;
        }
        for (const u32 half_edge : path) {
            features_[half_edge] = features_[opposite_[half_edge]] = false;
            --line_counts_[half_edges::start(mesh_, half_edge)];
            --line_counts_[half_edges::end(mesh_, half_edge)];
        }
        const u32 fork_a = half_edges::start(mesh_, path.back()), fork_b = half_edges::end(mesh_, path.back());
        for (const u32 fork : {fork_a, fork_b})
            if (line_counts_[fork] == 1) branches.push({follow(fork), fork});
    }
}

bool OriginalSurface::merge_small_faces(double least_area) {
    // A face: triangles connected across edges that are no features.
    const u32 triangles = static_cast<u32>(mesh_.triangles.size());
    DisjointSets faces(triangles);
    std::vector<u32> feature_edges;
    for (u32 half_edge = 0; half_edge < opposite_.size(); ++half_edge) {
        const u32 other = opposite_[half_edge];
        if (other == half_edges::boundary || other < half_edge) continue;
        if (features_[half_edge])
            feature_edges.push_back(half_edge);
        else
            faces.unite(half_edge / 3, other / 3);
    }
    if (feature_edges.empty()) return false;
    std::vector<double> areas(triangles, 0);
    for (u32 t = 0; t < triangles; ++t) {
        const Triangle& corners = mesh_.triangles[t];
        areas[faces.find(t)] += (position(corners[1]) - position(corners[0])).cross(position(corners[2]) - position(corners[0])).norm() / 2;
    }
    std::vector<std::pair<u32, u32>> borders;  // face, edge
    for (const u32 half_edge : feature_edges)
        for (const u32 side : {half_edge, opposite_[half_edge]})
            if (const u32 face = faces.find(side / 3); areas[face] < least_area) borders.emplace_back(face, side);
    std::ranges::sort(borders, {}, [&](const auto& border) { return std::tuple(areas[border.first], border.first, border.second); });
    bool is_changed = false;
    for (std::size_t begin = 0, end; begin < borders.size(); begin = end) {
        for (end = begin; end < borders.size() && borders[end].first == borders[begin].first;) ++end;
        const u32 face = borders[begin].first;
        if (areas[face] >= least_area || faces.find(face) != face) continue;
        std::map<u32, double> lengths;
        for (std::size_t i = begin; i < end; ++i) {
            const u32 side = borders[i].second, other = faces.find(opposite_[side] / 3);
            if (other != face && features_[side]) lengths[other] += (position(half_edges::end(mesh_, side)) - position(half_edges::start(mesh_, side))).norm();
        }
        if (lengths.empty()) continue;
        const u32 neighbour = std::ranges::max_element(lengths, {}, [](const auto& l) { return l.second; })->first;
        for (std::size_t i = begin; i < end; ++i) {
            const u32 side = borders[i].second;
            if (faces.find(opposite_[side] / 3) == neighbour) features_[side] = features_[opposite_[side]] = false;
        }
        const double area = areas[face] + areas[neighbour];
        faces.unite(face, neighbour);
        areas[face] = areas[neighbour] = infinite_area;
        areas[faces.find(face)] = area;
        is_changed = true;
    }
    return is_changed;
}

void OriginalSurface::classify(const FeatureScale& scale) {
    count_lines();
    prune(scale.reach);
    for (int round = 0; round < 10 && merge_small_faces(scale.reach * scale.reach); ++round) {
        count_lines();
        prune(scale.reach);
    }
    int dbg[5] = {};
    const double limit = scale.corner_angle + angle_tie;
    for (u32 vertex = 0; vertex < first_.size(); ++vertex) {
        if (line_counts_[vertex] == 0) continue;
        classes_[vertex] = VertexClass::corner;
        if (line_counts_[vertex] != 2) { ++dbg[std::min(line_counts_[vertex], u8(4))]; continue; }
        const Vec3& here = position(vertex);
        const auto [last, next] = line_neighbours(vertex);
        bool turns = angle_between(here - position(last), position(next) - here) > limit;
        if (turns) {
            bool is_closed = false;
            const Vec3 arriving = here - line_point(vertex, last, scale.reach, is_closed),
                       leaving = line_point(vertex, next, scale.reach, is_closed) - here;
            turns = !is_closed && angle_between(arriving, leaving) > limit;
        }
        if (turns) { ++dbg[2]; continue; }
        const bool on_boundary = opposite_[first_[vertex]] == half_edges::boundary;
        classes_[vertex] = on_boundary ? VertexClass::boundary : VertexClass::crease;
    }
    std::cerr << "corners k1 " << dbg[1] << " k2 " << dbg[2] << " k3 " << dbg[3] << " k4 " << dbg[4] << "\n";
}

std::array<u32, 2> OriginalSurface::line_neighbours(u32 vertex) const {
    std::array<u32, 2> found{};
    std::size_t count = 0;
    for_each_line(vertex, [&](u32, u32 other) {
        if (count < 2) found[count++] = other;
    });
    return found;
}

bool OriginalSurface::add_path(u32 from, u32 to, const Vec3& up, const SignedErrors& limits,
                               SignedErrors& errors) const {
    const Vec3 a = position(from), along = position(to) - a;
    const double length = along.squaredNorm();
    const Vec3 sideways = up.cross(along);
    const auto side = [&](u32 vertex) { return sideways.dot(position(vertex) - a); };
    /// Of the point where the edge crosses the plane; false beyond the limits.
    const auto add_crossing = [&](u32 right, u32 left, double right_side, double left_side) {
        const Vec3 crossing = position(right) + right_side / (right_side - left_side) * (position(left) - position(right));
        const double share = std::clamp((crossing - a).dot(along) / length, 0.0, 1.0);
        const Vec3 off = crossing - a - share * along;
        const double distance = off.norm();
        const bool is_outside = off.dot(up) >= 0;
        if (distance > (is_outside ? limits.outside : limits.inside)) return false;
        errors.add(distance, is_outside);
        return true;
    };

    // The triangle at `from` into which the plane leads towards `to`, of several the one with the farthest crossing.
    u32 crossed = half_edges::boundary;
    double farthest = 0;
    u32 half_edge = first_[from];
    do {
        const u32 edge = after(half_edge);  // opposite to `from`, from right to left if the plane crosses it
        const u32 right = half_edges::start(mesh_, edge), left = half_edges::end(mesh_, edge);
        if (right == to || left == to) return true;  // an edge of the original
        const double right_side = side(right), left_side = side(left);
        if (right_side < 0 && left_side >= 0) {
            const Vec3 crossing =
                position(right) + right_side / (right_side - left_side) * (position(left) - position(right));
            const double share = (crossing - a).dot(along);
            if (share > farthest) {
                farthest = share;
                crossed = edge;
            }
        }
        half_edge = opposite_[before(half_edge)];
    } while (half_edge != half_edges::boundary && half_edge != first_[from]);
    if (crossed == half_edges::boundary) return false;

    u32 right = half_edges::start(mesh_, crossed), left = half_edges::end(mesh_, crossed);
    double right_side = side(right), left_side = side(left);
    for (std::size_t steps = 0; steps < mesh_.triangles.size(); ++steps) {
        if (features_[crossed] || !add_crossing(right, left, right_side, left_side)) return false;
        const u32 beyond = opposite_[crossed];  // from left to right
        const u32 apex = half_edges::start(mesh_, before(beyond));
        if (apex == to) return true;
        const double apex_side = side(apex);
        if (apex_side < 0) {
            crossed = before(beyond);  // from the apex, now on the right, to the left vertex
            right = apex;
            right_side = apex_side;
        } else {
            crossed = after(beyond);  // from the right vertex to the apex
            left = apex;
            left_side = apex_side;
        }
    }
    return false;
}

}  // namespace scanmill::decimating
