// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Finds pairs of boundary lines along one edge. reference_points.hpp states the rules.

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "probe_planner/lines.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::probing {

/// A segment, by the indices of its line and of the segment in the line.
struct SegmentIndex {
    u32 line, segment;
};

/// Consecutive boundary segments of one line. Each has a normal on both sides, or a match.
struct Run {
    std::vector<u32> segments;  ///< numbers among all boundary segments
    double length = 0;
};

/// Finds boundary segments that match, that is, lie along one edge of the part. Two patches of region-grow end at such
/// an edge. At least one of them has the other patch's normal beyond its boundary. Boundary segments are numbered line
/// after line.
class Pairs {
public:
    /// Cost: O(n log n) for n segments of about equal length.
    Pairs(const std::vector<Line>& lines, const Context& context);

    std::size_t count() const { return paired_lines_.size(); }
    const std::optional<SegmentIndex>& partner(u32 line, u32 segment) const { return partners_[line][segment]; }
    bool is_left_out(u32 line, u32 segment) const { return left_out_[line][segment]; }

    /// The largest distance between the middles of matching segments of two lines: twice the median segment length.
    double reach_of(u32 one, u32 other) const;

private:
    static constexpr u32 none = ~u32(0);

    const Line& line_of(u32 number) const { return lines_[segments_[number].line]; }
    double length_of(u32 number) const { return line_of(number).lengths[segments_[number].segment]; }
    bool has_right(u32 number) const { return line_of(number).has_right(segments_[number].segment); }

    bool is_far_along(u32 a, u32 b, double distance) const;
    bool may_match(u32 a, u32 b, double squared_distance) const;
    void find_matches(const Context& context);
    /// Runs end at corners, and where the matching line changes.
    void find_runs(u32 line_number);
    void pair_runs();

    const std::vector<Line>& lines_;
    std::vector<SegmentIndex> segments_;  ///< of boundaries, line after line
    std::vector<u32> first_segment_;  ///< by line: number of its first boundary segment
    std::vector<std::vector<double>> sorted_lengths_;  ///< by line
    std::vector<Run> runs_;
    std::vector<u32> run_of_, matches_;  ///< by number of a boundary segment
    mutable std::map<std::pair<u32, u32>, double> reaches_;
    std::set<std::pair<u32, u32>> paired_lines_;
    std::vector<std::vector<std::optional<SegmentIndex>>> partners_;  ///< by line and segment
    std::vector<std::vector<bool>> left_out_;
};

}  // namespace scanmill::probing
