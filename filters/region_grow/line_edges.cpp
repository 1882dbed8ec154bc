// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/line_edges.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <iterator>

#include "scanmill/base/text.hpp"

namespace scanmill::growing {

namespace {

/// For each row of the cloud, its point.
Array<u32> points_of_rows(const DistinctPoints& points, std::size_t rows) {
    Array<u32> point_of_row(rows);
    for (u32 point = 0; point < points.size(); ++point) point_of_row[points.rows[point]] = point;
    for (const auto& [point, row] : points.repeats) point_of_row[row] = point;
    return point_of_row;
}

bool is_edge(const Surface& surface, u32 a, u32 b) {
    return surface.fans.left_of(a, b) != invalid_index || surface.fans.left_of(b, a) != invalid_index;
}

/// "3 segments of lines WHAT; the first is segment 4 of line 2 at (1, 2, 3)", in the units and origin of the frame.
std::string sentence(const std::vector<NamedSegment>& segments, std::string_view singular, std::string_view plural,
                     const Frame& frame) {
    constexpr std::size_t most_named = 3;
    std::vector<std::string> names;
    for (const NamedSegment& named : segments) {
        if (names.size() == most_named) break;
        const Vec3 at = frame.origin + named.middle;
        names.push_back(fmt::format("segment {} of line {} at ({:.6g}, {:.6g}, {:.6g})", named.segment, named.polyline,
                                    at.x(), at.y(), at.z()));
    }
    const bool all = names.size() == segments.size();
    return fmt::format("{} of lines {}: {}{}", count_text(segments.size(), "segment", "segments"),
                       by_count(segments.size(), singular, plural), enumerated(names), all ? "" : ", and others");
}

}  // namespace

std::vector<std::array<u32, 2>> edges_of(const PreparedLines& lines, const DistinctPoints& points) {
    const Array<u32> point_of_row = points_of_rows(points, lines.rows.size());
    std::vector<std::array<u32, 2>> edges;
    for (const auto& [a, b] : lines.segments) edges.push_back({point_of_row[a], point_of_row[b]});
    return edges;
}

Array<Edge> segments_in(const FinishedMesh& finished, const Surface& surface) {
    Array<Edge> edges;
    const auto& vertex = finished.vertex_of_point;
    for (u32 a = 0; a < surface.points.size(); ++a)
        for (u32 b : surface.fixed_edges.of(a))
            if (a < b && is_edge(surface, a, b)) edges.push_back(make_edge(vertex[a], vertex[b]));
    std::ranges::sort(edges);
    return edges;
}

void report_lines(const PreparedLines& lines, const Surface& surface, RegionGrowResult& result, Context& context) {
    const Array<u32> point_of_row = points_of_rows(surface.points, lines.rows.size());
    std::vector<NamedSegment> unused, crossed;  // missing: an end in no triangle, or the surface passes otherwise
    for (std::size_t i = 0; i < lines.segments.size(); ++i) {
        const u32 a = point_of_row[lines.segments[i][0]], b = point_of_row[lines.segments[i][1]];
        if (is_edge(surface, a, b)) continue;
        const bool is_unused = surface.fans.empty(a) || surface.fans.empty(b);
        (is_unused ? unused : crossed).push_back(lines.names[i]);
    }
    result.near_lines = lines.near_lines;
    result.unsupported_lines = lines.unsupported.size();
    result.crossing_lines = lines.crossing.size();
    result.missing_lines = unused.size() + crossed.size();
    result.line_segments = lines.segments.size() - result.missing_lines;
    const auto count = [&](std::string_view name, std::size_t value) {
        context.metric(name, static_cast<double>(value));
    };
    count("lines", result.line_segments);
    count("near-lines", result.near_lines);
    count("unsupported", result.unsupported_lines);
    count("crossing", result.crossing_lines);
    count("missing-lines", result.missing_lines);

    const Frame& frame = result.mesh.frame;
    if (!lines.unsupported.empty())
        context.warn(sentence(lines.unsupported, "has no scan point within 3 spacings and is left out",
                              "have no scan point within 3 spacings and are left out", frame));
    if (!lines.crossing.empty())
        context.warn(sentence(lines.crossing, "crosses a more certain segment and is left out",
                              "cross a more certain segment and are left out", frame));
    if (!unused.empty())
        context.doubt(sentence(unused, "is missing, because an end is in no triangle",
                               "are missing, because an end is in no triangle", frame));
    if (!crossed.empty())
        context.doubt(sentence(crossed, "is missing, because the surface is open there or passes it otherwise",
                               "are missing, because the surface is open there or passes them otherwise", frame));
}

}  // namespace scanmill::growing
