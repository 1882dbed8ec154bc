// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/whole_lines.hpp"

#include <algorithm>
#include <array>
#include <functional>
#include <map>
#include <numeric>
#include <queue>
#include <set>
#include <span>
#include <tuple>
#include <utility>
#include <vector>

#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill::probing {

namespace {

/// A polyline that can be joined with others. A closed one does not repeat its first vertex.
struct Path {
    bool closed = false, is_open_crease = false, is_left_out = false;
    Array<u32> vertices;
    Array<Vec3> left, right;  ///< by segment
    double length = 0;
    u32 row = 0;

    u32 end(bool last) const { return last ? vertices.back() : vertices.front(); }

    /// The surface on the left is then on the right.
    void reverse() {
        std::ranges::reverse(vertices);
        std::ranges::reverse(left);
        std::ranges::reverse(right);
        std::swap(left, right);
    }

    /// Pre: `next` begins where this path ends.
    void append(const Path& next) {
        vertices.insert(vertices.end(), next.vertices.begin() + 1, next.vertices.end());
        left.insert(left.end(), next.left.begin(), next.left.end());
        right.insert(right.end(), next.right.begin(), next.right.end());
        length += next.length;
    }
};

Path path_of(const FeatureGraph& graph, u32 row) {
    const FeaturePolyline& line = graph.polylines[row];
    Path path;
    path.closed = line.closed;
    path.is_open_crease = line.type == FeatureType::crease && !line.closed;
    path.row = row;
    path.vertices.assign(graph.vertices.begin() + line.begin, graph.vertices.begin() + line.end);
    const u32 segments = line.end - line.begin - (line.closed ? 0 : 1);
    for (u32 i = 0; i < segments; ++i) {
        path.left.push_back(graph.left_normals[line.begin + i]);
        path.right.push_back(graph.right_normals[line.begin + i]);
        if (path.is_open_crease)
            path.length += (graph.positions[path.vertices[i + 1]] - graph.positions[path.vertices[i]]).norm();
    }
    return path;
}

/// The order of cells, which does not depend on their addresses.
struct Before {
    bool operator()(const Array<u32>* one, const Array<u32>* other) const { return *one < *other; }
};

class Network {
public:
    Network(const FeatureGraph& graph, double error) : positions_(graph.positions), shortest_(2 * error) {
        for (u32 row = 0; row < graph.polylines.size(); ++row) paths_.push_back(path_of(graph, row));
        ends_.resize(graph.positions.size());
        is_fixed_.resize(graph.positions.size());
        for (const Path& path : paths_) {
            if (path.is_open_crease) add_ends(path.row);
            const u32 skipped = path.is_open_crease ? 1 : 0;
            for (std::size_t i = skipped; i + skipped < path.vertices.size(); ++i) is_fixed_[path.vertices[i]] = true;
        }
    }

    /// Returns the number of creases left out.
    std::size_t clean(const Context& context) {
        for (u32 row = 0; row < paths_.size(); ++row) queue(row);
        std::size_t left_out = open_cells(context, true);  // before joins would make one closed crease of a ring
        for (u32 vertex = 0; vertex < ends_.size(); ++vertex) join_at(vertex);
        left_out += cut_branches();
        while (const std::size_t opened = open_cells(context)) left_out += opened + cut_branches();
        return left_out;
    }

    const std::vector<Path>& paths() const { return paths_; }

private:
    void add_ends(u32 row) {
        for (const bool last : {false, true}) ends_[paths_[row].end(last)].push_back(row);
    }
    void remove_ends(u32 row) {
        for (const bool last : {false, true}) {
            std::vector<u32>& here = ends_[paths_[row].end(last)];
            here.erase(std::ranges::find(here, row));
        }
    }

    bool is_short(const Path& path) const {
        return path.is_open_crease && !path.is_left_out && path.length < shortest_;
    }
    /// The order is by length; ties: the higher row first.
    std::pair<double, u32> key_of(u32 row) const { return {paths_[row].length, ~row}; }
    void queue(u32 row) {
        if (is_short(paths_[row])) short_.insert(key_of(row));
    }

    bool is_free(u32 vertex) const { return ends_[vertex].size() == 1 && !is_fixed_[vertex]; }

    std::size_t cut_branches() {
        std::size_t left_out = 0;
        while (!short_.empty()) {
            const u32 row = ~short_.begin()->second;
            short_.erase(short_.begin());
            const u32 a = paths_[row].end(false), b = paths_[row].end(true);
            if (a != b && !is_free(a) && !is_free(b)) continue;
            ++left_out;
            leave_out(row);
        }
        return left_out;
    }

    /// Whether every point is nearer to the polyline than `shortest_`. Consecutive points are near consecutive
    /// segments, so the search for a segment begins at the last one and goes outwards.
    bool are_near(std::span<const u32> points, std::span<const u32> polyline) const {
        const std::size_t segments = polyline.size() - 1;
        const auto is_near = [&](const Vec3& point, std::size_t i) {
            const Vec3 &a = positions_[polyline[i]], &b = positions_[polyline[i + 1]];
            return (point - nearest_on_segment(point, a, b)).norm() < shortest_;
        };
        std::size_t at = 0;
        for (const u32 vertex : points) {
            const Vec3& point = positions_[vertex];
            bool found = false;
            for (std::size_t away = 0; !found && away < segments; ++away) {
                if (at + away < segments && is_near(point, at + away)) {
                    found = true;
                    at += away;
                } else if (away <= at && is_near(point, at - away)) {
                    found = true;
                    at -= away;
                }
            }
            if (!found) return false;
        }
        return true;
    }

    /// The vertices of the creases that lead from `vertex` to one another.
    Array<u32> vertices_of(std::span<const u32> way, u32 vertex) const {
        Array<u32> all{vertex};
        for (const u32 row : way) {
            if (paths_[row].end(false) == vertex)
                all.insert(all.end(), paths_[row].vertices.begin() + 1, paths_[row].vertices.end());
            else
                all.insert(all.end(), paths_[row].vertices.rbegin() + 1, paths_[row].vertices.rend());
            vertex = all.back();
        }
        return all;
    }

    /// A crease and the shortest way round it as ascending rows; empty if they are no cell.
    Array<u32> cell_of(u32 row) const {
        const Path& path = paths_[row];
        const u32 from = path.end(false), to = path.end(true);
        if (from == to) return path.length < 2 * shortest_ ? Array<u32>{row} : Array<u32>{};
        using Reached = std::tuple<double, u32, u32>;  // length, vertex, row of the crease to it
        std::priority_queue<Reached, std::vector<Reached>, std::greater<>> next;
        std::map<u32, u32> came_by;
        const double most = path.length + 2 * shortest_;
        next.emplace(0, from, row);
        while (!next.empty()) {
            const auto [length, vertex, by] = next.top();
            next.pop();
            if (!came_by.emplace(vertex, by).second) continue;
            if (vertex == to) break;
            for (const u32 other : ends_[vertex]) {
                const double further = length + paths_[other].length;
                if (other != row && further < most) next.emplace(further, other_end(other, vertex), other);
            }
        }
        Array<u32> cell;
        if (!came_by.contains(to)) return cell;
        for (u32 vertex = to; vertex != from; vertex = other_end(cell.back(), vertex))
            cell.push_back(came_by.at(vertex));
        const Array<u32> way = vertices_of(cell, to);
        if (!are_near(path.vertices, way) || !are_near(way, path.vertices)) return {};
        cell.push_back(row);
        std::ranges::sort(cell);
        return cell;
    }

    u32 other_end(u32 row, u32 vertex) const {
        return paths_[row].end(false) == vertex ? paths_[row].end(true) : paths_[row].end(false);
    }

    /// Whether nothing else meets the creases of the cell.
    bool is_ring(std::span<const u32> cell) const {
        return std::ranges::all_of(cell, [&](u32 row) {
            return std::ranges::all_of(std::array{paths_[row].end(false), paths_[row].end(true)},
                                       [&](u32 vertex) { return ends_[vertex].size() == 2 && !is_fixed_[vertex]; });
        });
    }

    /// Returns the number of creases left out.
    std::size_t open_cells(const Context& context, bool only_rings = false) {
        std::set<Array<u32>> cells;
        for (u32 row = 0; row < paths_.size(); ++row) {
            context.check_cancelled();
            if (paths_[row].is_open_crease)
                if (Array<u32> cell = cell_of(row); !cell.empty() && (!only_rings || is_ring(cell)))
                    cells.insert(std::move(cell));
        }
        std::map<u32, std::set<const Array<u32>*, Before>> cells_of;  // by crease
        for (const Array<u32>& cell : cells)
            for (const u32 row : cell) cells_of[row].insert(&cell);

        std::vector<bool> is_beside(ends_.size());  // vertices of creases that were left out
        std::vector<bool> is_side(paths_.size());  // creases that never were in two cells
        for (const auto& [row, its] : cells_of) is_side[row] = its.size() == 1;
        using Key = std::tuple<bool, bool, double, u32>;
        std::set<Key, std::greater<>> free;
        const auto key = [&](u32 row) {
            const Path& path = paths_[row];
            return Key(is_side[row], is_beside[path.end(false)] || is_beside[path.end(true)], path.length, row);
        };
        for (const auto& [row, its] : cells_of)
            if (is_side[row]) free.insert(key(row));
        Array<u32> opened;
        while (!free.empty()) {
            const u32 row = std::get<u32>(*free.begin());
            free.erase(free.begin());
            const Array<u32>& cell = **cells_of[row].begin();
            opened.push_back(row);
            for (const u32 each : cell) {
                free.erase(key(each));
                cells_of[each].erase(&cell);
            }
            for (const u32 vertex : {paths_[row].end(false), paths_[row].end(true)}) {
                for (const u32 each : ends_[vertex]) free.erase(key(each));
                is_beside[vertex] = true;
            }
            const auto refresh = [&](u32 each) {
                const auto its = cells_of.find(each);
                if (its != cells_of.end() && its->second.size() == 1) free.insert(key(each));
            };
            for (const u32 each : cell) refresh(each);
            for (const u32 vertex : {paths_[row].end(false), paths_[row].end(true)})
                for (const u32 each : ends_[vertex]) refresh(each);
        }
        for (const u32 row : opened) take_out(row);  // all of them before any join
        for (const u32 row : opened) settle_ends(row);
        return opened.size();
    }

    void leave_out(u32 row) {
        take_out(row);
        settle_ends(row);
    }
    void take_out(u32 row) {
        short_.erase(key_of(row));
        remove_ends(row);
        paths_[row].is_left_out = true;
        paths_[row].is_open_crease = false;
    }
    void settle_ends(u32 row) {
        for (const bool last : {false, true}) {
            const u32 vertex = paths_[row].end(last);
            join_at(vertex);
            for (const u32 other : ends_[vertex]) queue(other);  // it may have a free end now
        }
    }

    void join_at(u32 vertex) {
        if (ends_[vertex].size() != 2 || is_fixed_[vertex]) return;
        const u32 first = std::min(ends_[vertex][0], ends_[vertex][1]),
                  second = std::max(ends_[vertex][0], ends_[vertex][1]);
        short_.erase(key_of(first));
        short_.erase(key_of(second));
        remove_ends(first);
        if (first == second) {  // both ends of one crease
            Path& path = paths_[first];
            path.closed = true;
            path.is_open_crease = false;
            path.vertices.pop_back();
            for (const u32 each : path.vertices) is_fixed_[each] = true;
            return;
        }
        remove_ends(second);
        Path &path = paths_[first], &other = paths_[second];
        const bool begins_here = path.end(false) == vertex;
        if (begins_here) path.reverse();
        if (other.end(false) != vertex) other.reverse();
        path.append(other);
        if (begins_here) path.reverse();
        other.is_left_out = true;
        other.is_open_crease = false;
        is_fixed_[vertex] = true;
        add_ends(first);
        queue(first);
    }

    const Buffer<Vec3>& positions_;
    double shortest_;
    std::vector<Path> paths_;
    std::vector<std::vector<u32>> ends_;  ///< by vertex: rows of the open creases that end there
    std::vector<bool> is_fixed_;  ///< by vertex: whether a line passes it
    std::set<std::pair<double, u32>> short_;
};

}  // namespace

WholeLines whole_lines(const FeatureGraph& features, double error, const Context& context) {
    Network network(features, error);
    WholeLines result;
    result.left_out = network.clean(context);
    if (result.left_out == 0) {
        result.features = features;
        result.rows.resize(features.polylines.size());
        std::iota(result.rows.begin(), result.rows.end(), 0u);
        return result;
    }
    FeatureGraph& graph = result.features;
    graph.frame = features.frame;
    graph.positions = features.positions;
    graph.corners = features.corners;
    Array<u32> vertices;
    Array<Vec3> left, right;
    for (const Path& path : network.paths()) {
        if (path.is_left_out) continue;
        const u32 begin = static_cast<u32>(vertices.size());
        vertices.insert(vertices.end(), path.vertices.begin(), path.vertices.end());
        left.insert(left.end(), path.left.begin(), path.left.end());
        right.insert(right.end(), path.right.begin(), path.right.end());
        left.resize(vertices.size(), Vec3::Zero());
        right.resize(vertices.size(), Vec3::Zero());
        result.rows.push_back(path.row);
        graph.polylines.push_back(
            {features.polylines[path.row].type, path.closed, begin, static_cast<u32>(vertices.size())});
    }
    graph.vertices = Buffer<u32>(std::move(vertices));
    graph.left_normals = Buffer<Vec3>(std::move(left));
    graph.right_normals = Buffer<Vec3>(std::move(right));
    return result;
}

}  // namespace scanmill::probing
