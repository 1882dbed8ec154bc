// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/lines.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <string_view>

#include "probe_planner/whole_lines.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/spatial/angle.hpp"

namespace scanmill::probing {

namespace {

constexpr u32 reach = 2;  ///< segments of a window on either side

std::string_view name_of(FeatureType type) {
    return type == FeatureType::crease ? "crease" : type == FeatureType::hole ? "hole" : "outer boundary";
}

void require_unit(const Vec3& normal, u32 line, u32 segment, const char* side) {
    constexpr double most = 1e-3;
    if (!normal.allFinite())
        throw Error("the {} normal of segment {} of line {} is not finite", side, segment, line)
            .hint(
                "make the features again from a mesh without NaN: use the filter `features`, or region-grow's port "
                "`features`");
    if (std::abs(normal.norm() - 1) > most)
        throw Error("the {} normal of segment {} of line {} has the length {:.6g}; a unit normal has 1", side, segment,
                    line, normal.norm())
            .hint("make the features again: use the filter `features`, or region-grow's port `features`");
}

/// Throws Error unless the arrays of all lines fit, also of lines that are not chosen: whether lines meet depends on
/// all of them.
void require_consistent(const FeatureGraph& graph) {
    if (graph.left_normals.size() != graph.vertices.size() || graph.right_normals.size() != graph.vertices.size())
        throw Error("the features have {} left and {} right normals for {} vertices of lines",
                    graph.left_normals.size(), graph.right_normals.size(), graph.vertices.size())
            .hint(damaged);
    for (u32 row = 0; row < graph.polylines.size(); ++row) {
        const FeaturePolyline& polyline = graph.polylines[row];
        const u32 least = polyline.closed ? 3 : 2;
        if (polyline.begin > polyline.end || polyline.end > graph.vertices.size() ||
            polyline.end - polyline.begin < least)
            throw Error("line {} names the vertices {} to {} of {}; a line needs at least {}", row, polyline.begin,
                        polyline.end, graph.vertices.size(), least)
                .hint(damaged);
        for (u32 i = polyline.begin; i < polyline.end; ++i)
            if (graph.vertices[i] >= graph.positions.size())
                throw Error("line {} names the point {}; there are {}", row, graph.vertices[i], graph.positions.size())
                    .hint(damaged);
    }
}

/// Pre: require_consistent().
Line read_line(const FeatureGraph& graph, u32 row) {
    const FeaturePolyline& polyline = graph.polylines[row];
    Line line;
    line.row = row;
    line.type = polyline.type;
    line.closed = polyline.closed;
    if (line.is_boundary() && !line.closed)
        throw Error("line {} is an open {} with {} vertices; boundaries of a mesh are closed", row, name_of(line.type),
                    polyline.end - polyline.begin)
            .hint("make the features again from a mesh, or probe only creases: `features: creases`");
    for (u32 i = polyline.begin; i < polyline.end; ++i) {
        const u32 vertex = graph.vertices[i];
        if (!graph.positions[vertex].allFinite())
            throw Error("vertex {} of line {} is not finite", i - polyline.begin, row)
                .hint("make the features again from a mesh without NaN");
        line.points.push_back(graph.positions[vertex]);
    }
    const u32 segments = line.vertices() - (line.closed ? 0 : 1);
    line.arcs.push_back(0);
    for (u32 segment = 0; segment < segments; ++segment) {
        const Vec3 along = line.end_of(segment) - line.points[segment];
        const double length = along.norm();
        if (!(length > 0))
            throw Error("segment {} of line {} has the length 0: both ends are at ({:.6g}, {:.6g}, {:.6g})", segment,
                        row, line.points[segment].x(), line.points[segment].y(), line.points[segment].z())
                .hint("remove repeated points from the scan, or repeated vertices from the mesh");
        line.directions.push_back(along / length);
        line.lengths.push_back(length);
        line.arcs.push_back(line.arcs.back() + length);
        const Vec3 &left = graph.left_normals[polyline.begin + segment],
                   &right = graph.right_normals[polyline.begin + segment];
        if (left == Vec3::Zero())
            throw Error("segment {} of line {} has no normal on its left", segment, row)
                .hint("the surface is on the left of a line: make the features again from a mesh");
        require_unit(left, row, segment, "left");
        line.left.push_back(left);
        line.right.push_back(Vec3::Zero());
        if (right == Vec3::Zero()) continue;
        require_unit(right, row, segment, "right");
        constexpr double least_angle = 1e-6;
        if (angle_between(left, right) < least_angle)
            throw Error(
                "the normals on both sides of segment {} of line {} are equal (0 deg between them): there is no "
                "edge",
                segment, row)
                .hint("find the features with a sharp-angle above 0");
        if (std::abs(right.dot(line.directions.back())) < sqrt_half) line.right.back() = right;
    }
    return line;
}

/// Returns the vertex `steps` segments after a vertex, or before it if `steps` is negative. The ends of an open line
/// are the limits.
Vec3 beside(const Line& line, u32 vertex, int steps) {
    const auto count = static_cast<int>(line.vertices());
    const int at = static_cast<int>(vertex) + steps;
    if (line.closed) return line.points[static_cast<std::size_t>((at % count + count) % count)];
    return line.points[static_cast<std::size_t>(std::clamp(at, 0, count - 1))];
}

/// Whether the line turns by more than 45 degrees between two chords.
bool is_turn(const Vec3& before, const Vec3& after) {
    return before.dot(after) < sqrt_half * before.norm() * after.norm();
}

void find_stops(const FeatureGraph& graph, std::vector<Line>& lines) {
    std::vector<u32> uses(graph.positions.size());
    for (const FeaturePolyline& polyline : graph.polylines)
        for (u32 i = polyline.begin; i < polyline.end; ++i) ++uses[graph.vertices[i]];
    std::vector<bool> is_corner(graph.positions.size());
    for (const u32 corner : graph.corners)
        if (corner < is_corner.size()) is_corner[corner] = true;
    for (Line& line : lines) {
        line.stops.assign(line.vertices(), false);
        const FeaturePolyline& polyline = graph.polylines[line.row];
        for (u32 i = 0; i < line.vertices(); ++i) {
            const u32 vertex = graph.vertices[polyline.begin + i];
            if (uses[vertex] > 1) line.stops[i] = true;
            if (!is_corner[vertex]) continue;
            const int chord = reach;
            const Vec3 before = line.points[i] - beside(line, i, -chord),
                       after = beside(line, i, chord) - line.points[i];
            if (is_turn(before, after)) line.stops[i] = true;
        }
    }
}

bool is_chosen(FeatureType type, const LineChoice& choice) {
    if (type == FeatureType::crease) return choice.creases;
    return type == FeatureType::hole ? choice.holes : choice.boundaries;
}

std::vector<Line> read_lines(const FeatureGraph& graph, const LineChoice& choice) {
    std::vector<Line> lines;
    for (u32 row = 0; row < graph.polylines.size(); ++row)
        if (is_chosen(graph.polylines[row].type, choice)) lines.push_back(read_line(graph, row));
    find_stops(graph, lines);
    return lines;
}

/// Throws Error: no line of the features is chosen, or all chosen creases were left out.
[[noreturn]] void refuse_empty(const FeatureGraph& features, std::size_t left_out) {
    std::array<std::size_t, 3> counts{};
    for (const FeaturePolyline& line : features.polylines) ++counts[static_cast<std::size_t>(line.type)];
    throw Error("there is no line to probe: the features have {}, {} and {}{}",
                count_text(counts[0], "outer boundary", "outer boundaries"), count_text(counts[1], "hole", "holes"),
                count_text(counts[2], "crease", "creases"),
                left_out == 0 ? "" : ", of which none is part of a line of twice the scanner-error")
        .hint(features.polylines.empty() ? "a closed mesh without sharp edges has no features; lower `sharp-angle` in "
                                           "the filter that finds them"
              : left_out > 0 ? "a finer scan with smaller voxels and a smaller scanner-error has longer edges"
                             : "`features: all` probes every line");
}

}  // namespace

ChosenLines chosen_lines(const FeatureGraph& features, const LineChoice& choice, double error, const Context& context) {
    require_consistent(features);
    ChosenLines chosen{read_lines(features, choice), 0};  // before any join, so errors name the rows of the features
    if (choice.creases) {
        const WholeLines whole = whole_lines(features, error, context);
        chosen = {read_lines(whole.features, choice), whole.left_out};
        for (Line& line : chosen.lines) line.row = whole.rows[line.row];
    }
    if (chosen.lines.empty()) refuse_empty(features, chosen.left_out);
    return chosen;
}

Window window_round(const Line& line, u32 segment, const Vec3& point) {
    // A window covers at most half of a closed line.
    const u32 widest = line.closed ? std::min(reach, (line.segments() - 1) / 4) : reach;
    for (u32 most = widest;; --most) {
        Window window;
        u32 first = segment, last = segment;
        for (u32 step = 0; step < most && !line.stops[first]; ++step) {
            const std::optional<u32> next = line.before(first);
            if (!next) break;
            first = *next;
        }
        for (u32 step = 0; step < most && !line.stops[(last + 1) % line.vertices()]; ++step) {
            const std::optional<u32> next = line.after(last);
            if (!next) break;
            last = *next;
        }
        window.start = line.points[first];
        window.end = line.end_of(last);
        for (u32 at = first;; at = *line.after(at)) {
            window.segments.push_back(at);
            window.length += line.lengths[at];
            if (at == last) break;
        }
        if (most == 0 || !is_turn(point - window.start, window.end - point)) return window;
    }
}

Vec3 mean_normal(const Line& line, const Window& window, const Array<Vec3>& normals) {
    Vec3 sum = Vec3::Zero();
    for (const u32 segment : window.segments) sum += line.lengths[segment] * normals[segment];
    return sum;
}

}  // namespace scanmill::probing
