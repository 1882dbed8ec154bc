// SPDX-License-Identifier: GPL-3.0-or-later
#include "probe_compensate/touched_lines.hpp"

#include <algorithm>
#include <map>
#include <vector>

#include "scanmill/base/statistics.hpp"

namespace scanmill::compensating {

namespace {

/// Consecutive touches that are at least this many spacings apart have a gap between them.
constexpr double gap = 2;

/// The last touch of a line is joined to the first if they are nearer than this many spacings. The ends of a straight
/// line of three touches are 2 spacings apart, and those of a closed line 1.
constexpr double closing = 1.5;

/// Touches nearer than this many distances of neighbours are of one edge point. Where the line of a scan zigzags, two
/// of its reference points can belong to one point of the true edge, even in the wrong order.
constexpr double repeated = 0.25;

class LineMaker {
public:
    LineMaker(const Frame& frame, std::span<const LinePoint> points, std::optional<double> spacing)
        : points_(points),
          spacing_(spacing) {
        lines_.graph.frame = frame;
    }

    /// `sequence`: indices of the points of one feature.
    void add(std::vector<std::size_t> sequence) {
        std::vector<double> distances = distances_along(sequence);
        std::erase(distances, 0);
        if (distances.empty()) {
            ++lines_.lone;
            return;
        }
        const double spacing = spacing_ ? *spacing_ : median(distances);
        const double least = repeated * std::min(spacing, median(distances));
        std::vector<std::size_t> kept;
        const auto is_repeated = [&](std::size_t point, std::size_t other) {
            const double distance = (at(point) - at(other)).norm();
            return distance == 0 || distance < least;
        };
        const auto keep_better = [&](std::size_t& point, std::size_t other) {
            ++lines_.repeated;
            if (points_[other].is_exact && !points_[point].is_exact) point = other;
        };
        for (const std::size_t point : sequence)
            if (kept.empty() || !is_repeated(point, kept.back()))
                kept.push_back(point);
            else
                keep_better(kept.back(), point);
        while (kept.size() > 3 && is_repeated(kept.back(), kept.front())) {
            keep_better(kept.front(), kept.back());
            kept.pop_back();
        }
        sequence = std::move(kept);
        distances = distances_along(sequence);
        const std::size_t count = sequence.size();
        const double back = (at(sequence.front()) - at(sequence.back())).norm();
        const bool returns = count >= 3 && back > 0 && back < closing * spacing;

        const auto is_joined = [&](std::size_t i) { return i + 1 < count ? distances[i] < gap * spacing : returns; };
        std::size_t first_gap = 0;
        while (first_gap < count && is_joined(first_gap)) ++first_gap;
        if (first_gap == count) return add_line(sequence, true);
        std::vector<std::size_t> run;
        const std::size_t begin = returns ? first_gap + 1 : 0;  // a line that returns has no end between two gaps
        for (std::size_t i = begin; i < begin + count; ++i) {
            run.push_back(sequence[i % count]);
            if (is_joined(i % count)) continue;
            if (run.size() > 1)
                add_line(run, false);
            else
                ++lines_.lone;
            run.clear();
        }
    }

    TouchedLines finished() {
        FeatureGraph& graph = lines_.graph;
        const Array<Vec3> no_normals(vertices_.size(), Vec3(Vec3::Zero()));
        graph.left_normals = graph.right_normals = Buffer<Vec3>(no_normals);
        graph.positions = std::move(positions_);
        graph.vertices = std::move(vertices_);
        return std::move(lines_);
    }

private:
    const Vec3& at(std::size_t point) const { return points_[point].position; }

    std::vector<double> distances_along(std::span<const std::size_t> sequence) const {
        std::vector<double> distances;
        for (std::size_t i = 0; i + 1 < sequence.size(); ++i)
            distances.push_back((at(sequence[i + 1]) - at(sequence[i])).norm());
        return distances;
    }

    void add_line(std::span<const std::size_t> run, bool closed) {
        const auto begin = static_cast<u32>(vertices_.size());
        for (const std::size_t point : run) {
            vertices_.push_back(static_cast<u32>(positions_.size()));
            positions_.push_back(at(point));
            lines_.points.push_back(point);
        }
        lines_.graph.polylines.push_back({FeatureType::crease, closed, begin, static_cast<u32>(vertices_.size())});
    }

    std::span<const LinePoint> points_;
    std::optional<double> spacing_;
    TouchedLines lines_;
    Array<Vec3> positions_;
    Array<u32> vertices_;
};

}  // namespace

TouchedLines touched_lines(const Frame& frame, std::span<const LinePoint> points, std::optional<double> spacing) {
    std::map<double, std::size_t> line_of;
    std::vector<std::vector<std::size_t>> sequences;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const std::size_t line = line_of.emplace(points[i].feature, sequences.size()).first->second;
        if (line == sequences.size()) sequences.emplace_back();
        sequences[line].push_back(i);
    }
    LineMaker maker(frame, points, spacing);
    for (std::vector<std::size_t>& sequence : sequences) maker.add(std::move(sequence));
    return maker.finished();
}

}  // namespace scanmill::compensating
