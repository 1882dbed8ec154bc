// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_planner/pairs.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill::probing {

Pairs::Pairs(const std::vector<Line>& lines, const Context& context) : lines_(lines) {
    partners_.resize(lines.size());
    left_out_.resize(lines.size());
    first_segment_.resize(lines.size());
    bool any_right = false;
    for (u32 number = 0; number < lines.size(); ++number) {
        const Line& line = lines[number];
        partners_[number].resize(line.segments());
        left_out_[number].resize(line.segments());
        first_segment_[number] = static_cast<u32>(segments_.size());
        std::vector<double> lengths(line.lengths.begin(), line.lengths.end());
        std::ranges::sort(lengths);
        sorted_lengths_.push_back(std::move(lengths));
        if (!line.is_boundary()) continue;
        for (u32 segment = 0; segment < line.segments(); ++segment) {
            segments_.push_back({number, segment});
            any_right = any_right || line.has_right(segment);
        }
    }
    if (!any_right) return;
    find_matches(context);
    run_of_.assign(segments_.size(), none);
    for (u32 number = 0; number < lines.size(); ++number)
        if (lines[number].is_boundary()) find_runs(number);
    pair_runs();
}

double Pairs::reach_of(u32 one, u32 other) const {
    const auto key = std::minmax(one, other);
    const auto found = reaches_.find(key);
    if (found != reaches_.end()) return found->second;
    std::vector<double> lengths;
    std::ranges::merge(sorted_lengths_[one], sorted_lengths_[other], std::back_inserter(lengths));
    return reaches_[key] = 2 * lengths[lengths.size() / 2];
}

bool Pairs::is_far_along(u32 a, u32 b, double distance) const {
    const Line& line = line_of(a);
    double along = std::abs(line.middle_arc(segments_[a].segment) - line.middle_arc(segments_[b].segment));
    if (line.closed) along = std::min(along, line.arcs.back() - along);
    return along > distance;
}

bool Pairs::may_match(u32 a, u32 b, double squared_distance) const {
    if (!has_right(a) && !has_right(b)) return false;
    const double d = reach_of(segments_[a].line, segments_[b].line);
    if (squared_distance > d * d) return false;
    if (segments_[a].line == segments_[b].line && !is_far_along(a, b, 4 * d)) return false;
    const Line &one = line_of(a), &other = line_of(b);
    const u32 i = segments_[a].segment, j = segments_[b].segment;
    const double cosine_30 = std::sqrt(0.75);
    return one.directions[i].dot(other.directions[j]) <= -sqrt_half &&
           (!has_right(b) || one.left[i].dot(other.right[j]) >= cosine_30) &&
           (!has_right(a) || one.right[i].dot(other.left[j]) >= cosine_30);
}

void Pairs::find_matches(const Context& context) {
    double farthest = 0;
    for (u32 line = 0; line < lines_.size(); ++line)
        if (const auto& lengths = sorted_lengths_[line]; lines_[line].is_boundary())
            farthest = std::max(farthest, 2 * lengths[lengths.size() / 2]);
    Array<Vec3> middles(segments_.size());
    for (u32 number = 0; number < segments_.size(); ++number)
        middles[number] = line_of(number).middle(segments_[number].segment);
    const TriangleTree tree = tree_of_points(middles, 1);
    matches_.assign(segments_.size(), none);
    Array<u32> near;
    for (u32 number = 0; number < segments_.size(); ++number) {
        constexpr u32 between_checks = 256;
        if (number % between_checks == 0) context.check_cancelled();
        near.clear();
        BoundingBox box;
        box.low = middles[number].array() - farthest;
        box.high = middles[number].array() + farthest;
        tree.meeting(box, near);
        std::ranges::sort(near);
        double least = std::numeric_limits<double>::infinity();
        for (const u32 other : near) {
            const double squared = (middles[other] - middles[number]).squaredNorm();
            if (other == number || squared >= least || !may_match(number, other, squared)) continue;
            least = squared;
            matches_[number] = other;
        }
    }
}

void Pairs::find_runs(u32 line_number) {
    const Line& line = lines_[line_number];
    const auto number_of = [&](u32 segment) { return first_segment_[line_number] + segment; };
    const auto is_member = [&](u32 number) { return has_right(number) || matches_[number] != none; };
    const auto line_matched = [&](u32 number) {
        return matches_[number] == none ? none : segments_[matches_[number]].line;
    };
    const auto ends_between = [&](u32 matched, u32 number) {
        const u32 next = line_matched(number);
        return matched != none && next != none && matched != next;
    };
    u32 first = 0;  // a closed line is walked from the beginning of a run
    for (u32 i = 0; i < line.segments(); ++i) {
        const u32 before = number_of((i + line.segments() - 1) % line.segments());
        if (line.stops[i] || !is_member(before) || ends_between(line_matched(before), number_of(i))) {
            first = i;
            break;
        }
    }
    bool goes_on = false;
    u32 matched = none;
    for (u32 step = 0; step < line.segments(); ++step) {
        const u32 segment = (first + step) % line.segments(), number = number_of(segment);
        goes_on = goes_on && is_member(number) && !line.stops[segment] && !ends_between(matched, number);
        if (!is_member(number)) continue;
        if (!goes_on) {
            runs_.emplace_back();
            matched = none;
            goes_on = true;
        }
        if (line_matched(number) != none) matched = line_matched(number);
        runs_.back().segments.push_back(number);
        runs_.back().length += length_of(number);
        run_of_[number] = static_cast<u32>(runs_.size() - 1);
    }
}

void Pairs::pair_runs() {
    std::map<std::pair<u32, u32>, std::pair<double, double>> matched;  // matched lengths in both runs, by pair of runs
    for (u32 number = 0; number < segments_.size(); ++number) {
        if (matches_[number] == none) continue;
        const u32 run = run_of_[number], other = run_of_[matches_[number]];
        if (other == none) continue;
        auto& [first, second] = matched[std::minmax(run, other)];
        (run <= other ? first : second) += length_of(number);
    }
    for (const auto& [runs, lengths] : matched) {
        const Run &kept = runs_[runs.first], &other = runs_[runs.second];
        const bool is_first_shorter = kept.length <= other.length;
        const double shorter = std::min(kept.length, other.length);
        if ((is_first_shorter ? lengths.first : lengths.second) < shorter / 2) continue;
        paired_lines_.insert({segments_[kept.segments[0]].line, segments_[other.segments[0]].line});
        for (const u32 number : kept.segments) {
            const u32 match = matches_[number];
            if (match == none || run_of_[match] != runs.second) continue;
            if (runs.first != runs.second || number < match)
                partners_[segments_[number].line][segments_[number].segment] = segments_[match];
        }
        for (const u32 number : other.segments) {
            const u32 match = matches_[number];
            if (match == none || run_of_[match] != runs.first) continue;
            if (runs.first != runs.second || match < number)
                left_out_[segments_[number].line][segments_[number].segment] = true;
        }
    }
}

}  // namespace scanmill::probing
