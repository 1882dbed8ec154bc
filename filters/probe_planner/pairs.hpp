// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Pairs of boundary lines along one edge: reference_points.hpp states the rules.

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "probe_planner/lines.hpp"

namespace scanmill::probing {

/// A segment of a line by the numbers of both.
struct Place {
    u32 line, segment;
    auto operator<=>(const Place&) const = default;
};

/// Consecutive boundary segments along one edge: with a normal on both sides, or with a match.
struct Run {
    std::vector<u32> sides;
    double length = 0;
};

/// Boundary segments are sides. Two sides match if they lie along one edge: of region-grow's two patches at an edge at
/// least one has the normal of the other beyond its boundary.
class Pairs {
public:
    explicit Pairs(const std::vector<Line>& lines);

    std::size_t count() const { return paired_lines_.size(); }
    const std::optional<Place>& partner(u32 line, u32 segment) const { return partners_[line][segment]; }
    bool is_left_out(u32 line, u32 segment) const { return left_out_[line][segment]; }

    /// The largest distance between the middles of segments of two lines that match: twice the median segment length.
    double reach_of(u32 one, u32 other) const;

private:
    static constexpr u32 none = ~u32(0);

    const Line& line_of(u32 side) const { return lines_[sides_[side].line]; }
    double length_of(u32 side) const { return line_of(side).lengths[sides_[side].segment]; }
    bool has_right(u32 side) const { return line_of(side).has_right(sides_[side].segment); }

    bool is_far_along(u32 a, u32 b, double distance) const;
    bool may_match(u32 a, u32 b, double squared_distance) const;
    void find_matches();
    /// Runs end at corners, and where the matching line changes.
    void find_runs(u32 number);
    void pair_runs();

    const std::vector<Line>& lines_;
    std::vector<Place> sides_;  ///< of boundary segments, line after line
    std::vector<u32> first_side_;  ///< by line
    std::vector<std::vector<double>> sorted_lengths_;  ///< by line
    std::vector<Run> runs_;
    std::vector<u32> run_of_, matches_;  ///< by side
    mutable std::map<std::pair<u32, u32>, double> reaches_;
    std::set<std::pair<u32, u32>> paired_lines_;
    std::vector<std::vector<std::optional<Place>>> partners_;  ///< by line and segment
    std::vector<std::vector<bool>> left_out_;
};

}  // namespace scanmill::probing
