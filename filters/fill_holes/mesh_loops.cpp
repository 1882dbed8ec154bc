// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill_holes/mesh_loops.hpp"

#include <algorithm>
#include <limits>
#include <unordered_set>

#include "scanmill/base/disjoint_sets.hpp"

namespace scanmill {

namespace {

constexpr u32 invalid_index = ~u32(0);

}  // namespace

MeshLoops::MeshLoops(const TriangleMesh& mesh) : mesh_(mesh), opposite_(half_edges::opposites(mesh)) {
    for (u32 h = 0; h < opposite_.size(); ++h)
        if (opposite_[h] == half_edges::boundary) outgoing_.push_back(h);
    link_fans();
    separate_loops();
}

/// Links each boundary half-edge to the next one. At a vertex with several fans, the boundary continues in the next
/// fan, so it does not cross the gap between two fans.
void MeshLoops::link_fans() {
    std::vector<u32> by_vertex(outgoing_);
    std::ranges::stable_sort(by_vertex, {}, [&](u32 h) { return start(h); });
    for (std::size_t first = 0, last; first < by_vertex.size(); first = last) {
        for (last = first + 1; last < by_vertex.size() && start(by_vertex[last]) == start(by_vertex[first]);) ++last;
        for (std::size_t i = first; i < last; ++i)
            next_[incoming(by_vertex[i], [](u32) {})] = by_vertex[i + 1 < last ? i + 1 : first];
    }
}

void MeshLoops::separate_loops() {
    std::unordered_set<u32> visited;
    for (const u32 first : outgoing_) {
        if (visited.contains(first)) continue;
        std::vector<u32> path;
        std::unordered_map<u32, std::size_t> at;  // by vertex: its position in the path
        for (u32 h = first; visited.insert(h).second; h = next_.at(h)) {
            if (const auto found = at.find(start(h)); found != at.end()) {
                const auto begin = path.begin() + static_cast<std::ptrdiff_t>(found->second);
                loops_.emplace_back(begin, path.end());
                path.erase(begin, path.end());
                for (const u32 cut : loops_.back()) at.erase(start(cut));
            }
            at[start(h)] = path.size();
            path.push_back(h);
        }
        loops_.push_back(std::move(path));
    }
    for (std::vector<u32>& loop : loops_) {
        std::ranges::rotate(loop, std::ranges::min_element(loop));
        for (std::size_t i = 0; i < loop.size(); ++i) {
            const u32 after = loop[(i + 1) % loop.size()];
            next_[loop[i]] = after;
            before_[after] = loop[i];
        }
    }
    std::ranges::sort(loops_, {}, [](const std::vector<u32>& loop) { return loop.front(); });
}

double length_of(const TriangleMesh& mesh, std::span<const u32> loop) {
    double length = 0;
    for (const u32 h : loop)
        length += (mesh.positions[half_edges::end(mesh, h)] - mesh.positions[half_edges::start(mesh, h)]).norm();
    return length;
}

Cutout::Cutout(const TriangleMesh& mesh, const MeshLoops& boundary, std::span<const u32> loop) {
    std::vector<u32> rows;
    std::unordered_set<u32> at_loop;  // half-edges that start at a vertex of the loop, in its cycle of fans
    for (const u32 h : loop)
        boundary.around(h, [&](u32 around) {
            rows.push_back(around / 3);
            at_loop.insert(around);
        });
    std::ranges::sort(rows);
    rows.erase(std::ranges::unique(rows).begin(), rows.end());
    const auto local = [&](u32 h) {
        const auto found = std::ranges::lower_bound(rows, h / 3);
        return found == rows.end() || *found != h / 3 ? half_edges::boundary
                                                      : static_cast<u32>(found - rows.begin()) * 3 + h % 3;
    };
    const u32 count = static_cast<u32>(3 * rows.size());
    const auto global = [&](u32 h) { return 3 * rows[h / 3] + h % 3; };
    part.opposite.resize(count);
    for (u32 h = 0; h < count; ++h) {
        const u32 other = boundary.opposite()[global(h)];
        part.opposite[h] = other == half_edges::boundary ? other : local(other);
    }
    part.before_on_boundary.assign(count, half_edges::boundary);
    DisjointSets corners(count);  // sets of corners at one vertex
    for (u32 h = 0; h < count; ++h) {
        if (part.opposite[h] != half_edges::boundary) {
            corners.unite(h, half_edges::after(part.opposite[h]));
        } else if (at_loop.contains(global(h))) {
            part.before_on_boundary[h] = local(boundary.before(global(h)));
            corners.unite(h, half_edges::after(part.before_on_boundary[h]));
        } else {
            u32 in = half_edges::before(h);
            while (part.opposite[in] != half_edges::boundary) in = half_edges::before(part.opposite[in]);
            part.before_on_boundary[h] = in;
        }
    }
    std::vector<u32> number(count, invalid_index);
    part.triangles.resize(rows.size());
    for (u32 h = 0; h < count; ++h) {
        u32& vertex = number[corners.find(h)];
        if (vertex == invalid_index) {
            vertex = static_cast<u32>(vertices.size());
            vertices.push_back(half_edges::start(mesh, global(h)));
            part.positions.push_back(mesh.positions[vertices.back()]);
        }
        part.triangles[h / 3][h % 3] = vertex;
    }
    part.loop = local(loop.front());
}

}  // namespace scanmill
