// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/robust_box.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace scanmill {

namespace {

constexpr std::size_t points_per_stray = 500;
constexpr double widening = 0.25;  // fraction of the diagonal

/// The coordinate of the entry with this rank, counted from 0, when entries are sorted by `sign` times the coordinate.
/// Partitions the entries at this rank.
template <class Entries>
double ranked(Entries& entries, std::size_t rank, double sign) {
    const auto nth = entries.begin() + static_cast<std::ptrdiff_t>(rank);
    std::nth_element(entries.begin(), nth, entries.end(),
                     [sign](const auto& a, const auto& b) { return sign * a.coordinate < sign * b.coordinate; });
    return nth->coordinate;
}

/// An order of the pieces that soon visits every part of the file. Neighbours in a file are neighbours in space, so few
/// pieces then show the extent of the scan.
Array<std::size_t> spread_order(std::size_t pieces) {
    Array<std::size_t> order;
    for (std::size_t step = std::bit_ceil(pieces); step > 0; step /= 2)
        for (std::size_t piece = step == std::bit_ceil(pieces) ? 0 : step; piece < pieces; piece += 2 * step)
            order.push_back(piece);
    return order;
}

/// Whether at least k + 1 points are within an eighth of the diagonal D of every side of the box. If so, no point is
/// stray: the box [a, b] lacks at most D/8 on every side, so its diagonal is at least D - sqrt(3) D/4 > D/2. Q is wider
/// by more than a quarter of D/2 on every side and contains all points.
bool has_no_stray(const PositionPieces& pieces, const BoundingBox& all) {
    const std::size_t needed = pieces.begin.back() / points_per_stray + 1;
    const double diagonal = all.diagonal();
    if (needed == 1) return true;
    if (!std::isfinite(diagonal)) return false;
    const Vec3 low = all.low.array() + diagonal / 8, high = all.high.array() - diagonal / 8;
    std::array<std::size_t, 6> near{};
    Array<Vec3> buffer;
    for (const std::size_t piece : spread_order(pieces.begin.size() - 1)) {
        for (const Vec3& p : pieces.read(piece, buffer)) {
            const bool is_finite = p[0] * 0 + p[1] * 0 + p[2] * 0 == 0;
            for (std::size_t i = 0; i < 3; ++i) {
                const auto axis = static_cast<int>(i);
                near[2 * i] += is_finite & (p[axis] <= low[axis]);
                near[2 * i + 1] += is_finite & (p[axis] >= high[axis]);
            }
        }
        if (std::ranges::min(near) >= needed) return true;
    }
    return false;
}

/// The lowest and the highest coordinates along each axis.
class Extremes {
public:
    /// Keeps at least the `positions` / 500 + 1 lowest and highest coordinates per axis.
    explicit Extremes(std::size_t positions) : wanted_(positions / points_per_stray + 1) {}

    void add(std::span<const Vec3> positions) {
        std::size_t candidates = 0;
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Vec3& p = positions[i];
            // Nearly all positions are between the limits. The test has no branches and is false for NaN.
            const bool is_between = (p[0] >= low_limit_[0]) & (p[0] <= high_limit_[0]) & (p[1] >= low_limit_[1]) &
                                    (p[1] <= high_limit_[1]) & (p[2] >= low_limit_[2]) & (p[2] <= high_limit_[2]);
            if (is_between) continue;
            ++candidates;
            add_one(p, static_cast<u32>(rows_ + i));
        }
        rows_ += positions.size();
        finite_ += positions.size() - candidates;
    }

    /// The rows of the stray points, ascending, and the robust box. Pre: at least one position is finite.
    std::pair<Array<u32>, BoundingBox> stray_rows();

private:
    struct Entry {
        double coordinate;
        u32 row;
    };
    using Entries = Array<Entry>;

    void add_one(const Vec3& position, u32 row) {
        if (!position.allFinite()) return;
        ++finite_;
        for (int axis = 0; axis < 3; ++axis) {
            const auto add_to = [&](Entries& entries, double& limit, double sign) {
                if (sign * position[axis] >= sign * limit) return;
                entries.push_back({position[axis], row});
                if (entries.size() < 2 * wanted_) return;
                limit = ranked(entries, wanted_ - 1, sign);
                entries.resize(wanted_);
            };
            add_to(low_[static_cast<std::size_t>(axis)], low_limit_[axis], 1);
            add_to(high_[static_cast<std::size_t>(axis)], high_limit_[axis], -1);
        }
    }

    std::size_t wanted_;  // entries per axis and side
    std::size_t rows_ = 0, finite_ = 0;
    std::array<Entries, 3> low_, high_;  // unordered
    // Coordinates from low_limit_ to high_limit_ need not be kept.
    Vec3 low_limit_ = Vec3::Constant(std::numeric_limits<double>::infinity()), high_limit_ = -low_limit_;
};

std::pair<Array<u32>, BoundingBox> Extremes::stray_rows() {
    const std::size_t most_stray = finite_ / points_per_stray;
    BoundingBox inner;
    for (std::size_t i = 0; i < 3; ++i) {
        inner.low[static_cast<int>(i)] = ranked(low_[i], most_stray, 1);
        inner.high[static_cast<int>(i)] = ranked(high_[i], most_stray, -1);
    }
    const double margin = widening * inner.diagonal();
    const Vec3 low = inner.low.array() - margin, high = inner.high.array() + margin;

    // A coordinate outside [low, high] is beyond the coordinate of rank `most_stray`, so the entries contain all such
    // coordinates.
    Array<u32> rows;
    for (std::size_t i = 0; i < 3; ++i) {
        for (const Entry& entry : low_[i])
            if (entry.coordinate < low[static_cast<int>(i)]) rows.push_back(entry.row);
        for (const Entry& entry : high_[i])
            if (entry.coordinate > high[static_cast<int>(i)]) rows.push_back(entry.row);
    }
    std::ranges::sort(rows);
    rows.erase(std::ranges::unique(rows).begin(), rows.end());
    if (rows.size() > most_stray) rows.clear();

    // At each end of each axis, at least one of the most_stray + 1 entries is not stray.
    const auto is_stray = [&](const Entry& entry) { return std::ranges::binary_search(rows, entry.row); };
    BoundingBox robust;
    for (std::size_t i = 0; i < 3; ++i) {
        double &least = robust.low[static_cast<int>(i)], &most = robust.high[static_cast<int>(i)];
        for (const Entry& entry : low_[i])
            if (!is_stray(entry)) least = std::min(least, entry.coordinate);
        for (const Entry& entry : high_[i])
            if (!is_stray(entry)) most = std::max(most, entry.coordinate);
    }
    return {std::move(rows), robust};
}

}  // namespace

RobustBox robust_box(const PositionPieces& pieces, const BoundingBox& all) {
    if (all.empty() || has_no_stray(pieces, all)) return all;
    Extremes extremes(pieces.begin.back());
    Array<Vec3> buffer;
    for (std::size_t piece = 0; piece + 1 < pieces.begin.size(); ++piece) extremes.add(pieces.read(piece, buffer));
    const auto [rows, robust] = extremes.stray_rows();
    RobustBox box(all);
    if (rows.empty()) return box;
    box.robust = robust;
    for (auto row = rows.begin(); row != rows.end();) {
        const auto next = std::ranges::upper_bound(pieces.begin, *row);
        const std::size_t first = *(next - 1);
        const std::span<const Vec3> positions =
            pieces.read(static_cast<std::size_t>(next - pieces.begin.begin()) - 1, buffer);
        for (; row != rows.end() && *row < *next; ++row) box.stray.push_back({*row, positions[*row - first]});
    }
    return box;
}

RobustBox robust_box(std::span<const Vec3> positions, const BoundingBox& all) {
    constexpr std::size_t piece_size = 1 << 16;
    std::vector<std::size_t> begin;
    for (std::size_t row = 0; row < positions.size(); row += piece_size) begin.push_back(row);
    begin.push_back(positions.size());
    return robust_box(
        {begin, [&](std::size_t piece,
                    Array<Vec3>&) { return positions.subspan(begin[piece], begin[piece + 1] - begin[piece]); }},
        all);
}

Vec3 distant_origin(const RobustBox& box) {
    const Vec3 origin = distant_origin(box.robust);
    const bool is_exact = std::ranges::all_of(box.stray, [&](const StrayPoint& point) {
        return (origin + (point.position - origin)).eval() == point.position;
    });
    return is_exact ? origin : distant_origin(box.all);
}

}  // namespace scanmill
