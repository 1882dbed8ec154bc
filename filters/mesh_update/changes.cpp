// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/changes.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/geometry/distance/compensated_sum.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::updating {

namespace {

/// Lines of the grid over a change: this many per triangle, and these limits. The header states the errors and times.
/// With them, a thousand small changes take less than a second.
constexpr std::size_t lines_per_triangle = 64, least_lines = 64 * 64, most_lines = 512 * 512;
/// Old and new triangles in one plane enclose a volume by rounding: at most this share of area × diameter.
constexpr double rounding = 1e-15;
/// Lines that one thread measures at a time, at least; fewer would take less time than starting a task.
constexpr std::size_t band_lines = 1 << 13;

/// The vertices of the changed triangles, numbered without gaps. Common vertices have one number.
class Vertices {
public:
    Vertices(const ChangedTriangles& before, const ChangedTriangles& after, std::span<const u32> common)
        : common_(common) {
        keys_.reserve(3 * (before.triangles.size() + after.triangles.size()));
        for (const Triangle& triangle : before.triangles)
            for (const u32 vertex : triangle) keys_.push_back(vertex);
        for (const Triangle& triangle : after.triangles)
            for (const u32 vertex : triangle) keys_.push_back(key_of_new(vertex));
        std::ranges::sort(keys_);
        keys_.erase(std::unique(keys_.begin(), keys_.end()), keys_.end());
    }

    std::size_t size() const { return keys_.size(); }
    u32 of_old(u32 vertex) const { return number(vertex); }
    u32 of_new(u32 vertex) const { return number(key_of_new(vertex)); }

private:
    u64 key_of_new(u32 vertex) const {
        return common_[vertex] == no_common_vertex ? (u64(1) << 32) + vertex : common_[vertex];
    }
    u32 number(u64 key) const { return static_cast<u32>(std::ranges::lower_bound(keys_, key) - keys_.begin()); }

    std::span<const u32> common_;
    std::vector<u64> keys_;
};

std::vector<Change> components(const ChangedTriangles& before, const ChangedTriangles& after,
                               std::span<const u32> common) {
    const Vertices vertices(before, after, common);
    DisjointSets sets(vertices.size());
    for (const auto& [a, b, c] : before.triangles) {
        sets.unite(vertices.of_old(a), vertices.of_old(b));
        sets.unite(vertices.of_old(a), vertices.of_old(c));
    }
    for (const auto& [a, b, c] : after.triangles) {
        sets.unite(vertices.of_new(a), vertices.of_new(b));
        sets.unite(vertices.of_new(a), vertices.of_new(c));
    }
    std::vector<Change> changes;
    constexpr u32 unseen = ~u32(0);
    std::vector<u32> change_of(vertices.size(), unseen);
    const auto change_at = [&](u32 vertex) -> Change& {
        u32& change = change_of[sets.find(vertex)];
        if (change == unseen) {
            change = static_cast<u32>(changes.size());
            changes.emplace_back();
        }
        return changes[change];
    };
    for (u32 row = 0; row < before.triangles.size(); ++row)
        change_at(vertices.of_old(before.triangles[row][0])).old_triangles.push_back(row);
    for (u32 row = 0; row < after.triangles.size(); ++row)
        change_at(vertices.of_new(after.triangles[row][0])).new_triangles.push_back(row);
    return changes;
}

using Corners = std::array<Vec3, 3>;

Corners corners(const ChangedTriangles& changed, u32 row) {
    const auto& [a, b, c] = changed.triangles[row];
    return {changed.positions[a], changed.positions[b], changed.positions[c]};
}

/// The closed surface around the difference of two solids: new triangles, and old ones reversed. Coordinates are
/// relative to the middle of its box, in the order (u, v, w), which is right-handed; w is the axis along which the box
/// is shortest.
std::vector<Corners> cycle_of(const Change& change, const ChangedTriangles& before, const ChangedTriangles& after) {
    std::vector<Corners> cycle;
    cycle.reserve(change.old_triangles.size() + change.new_triangles.size());
    for (const u32 row : change.old_triangles) {
        const auto [a, b, c] = corners(before, row);
        cycle.push_back({a, c, b});
    }
    for (const u32 row : change.new_triangles) cycle.push_back(corners(after, row));
    BoundingBox box;
    for (const Corners& triangle : cycle)
        for (const Vec3& corner : triangle) box.add(corner);
    const Vec3 middle = (box.low + box.high) / 2;
    int w = 0;
    (box.high - box.low).minCoeff(&w);
    for (Corners& triangle : cycle)
        for (Vec3& corner : triangle) {
            const Vec3 moved = corner - middle;
            corner = {moved[(w + 1) % 3], moved[(w + 2) % 3], moved[w]};
        }
    return cycle;
}

/// The volume that the cycle can enclose by rounding. Pre: the middle of its box is 0.
double volume_by_rounding(std::span<const Corners> cycle) {
    double area = 0, squared_radius = 0;
    for (const auto& [a, b, c] : cycle) {
        area += area_vector(a, b, c).norm() / 2;
        squared_radius = std::max({squared_radius, a.squaredNorm(), b.squaredNorm(), c.squaredNorm()});
    }
    return rounding * area * 2 * std::sqrt(squared_radius);
}

/// By the divergence theorem for the field (0, 0, w), whose terms are small in a thin change.
double signed_volume(std::span<const Corners> cycle) {
    CompensatedSum sum;
    for (const auto& [a, b, c] : cycle) sum.add(area_vector(a, b, c).z() / 2 * ((a.z() + b.z() + c.z()) / 3));
    return sum.value();
}

/// Turns the cycle so that its walls and edges are not parallel to the lines and rows of the grid, even if they are
/// parallel to an axis: thin slices between such walls would be missed.
void tilt(std::span<Corners> cycle) {
    const Vec3 w = Vec3(0.31, 0.17, 0.93).normalized(), v = w.cross(Vec3(0.97, 0.23, 0)).normalized(), u = v.cross(w);
    for (Corners& triangle : cycle)
        for (Vec3& corner : triangle) corner = {u.dot(corner), v.dot(corner), w.dot(corner)};
}

struct Volumes {
    double added = 0, removed = 0;
};

/// Integrates along the lines of a grid over a cycle.
///
/// A row of lines has one v. It meets an edge of a triangle if exactly one end has a coordinate ≤ v. The point where it
/// does is computed from the lower end, so it is the same in all triangles with this edge. A line meets a triangle if
/// its u is between the points of two edges of the triangle, the left one included. Therefore a line meets a closed
/// surface as often upwards as downwards, even through its edges and vertices.
class Grid {
public:
    explicit Grid(std::span<const Corners> cycle) : cycle_(cycle) {
        BoundingBox box;
        for (const Corners& triangle : cycle)
            for (const Vec3& corner : triangle) box.add(corner);
        const double width = box.high.x() - box.low.x(), height = box.high.y() - box.low.y();
        if (!(width > 0 && height > 0)) return;
        const auto lines = static_cast<double>(std::clamp(lines_per_triangle * cycle.size(), least_lines, most_lines));
        const double columns = std::clamp(std::round(std::sqrt(lines * width / height)), 1.0, lines);
        us_ = centres(box.low.x(), width, columns);
        vs_ = centres(box.low.y(), height, std::max(1.0, std::floor(lines / columns)));
        cell_ = width / static_cast<double>(us_.size()) * (height / static_cast<double>(vs_.size()));
        band_rows_ = (band_lines + us_.size() - 1) / us_.size();
    }

    Volumes volumes(Context& context) const {
        const std::size_t bands = (vs_.size() + band_rows_ - 1) / band_rows_;
        const Lists lists = triangles_by_band(bands);
        std::vector<Volumes> parts(bands);
        for_each_chunk(context.threads(), bands, 1, [&](std::size_t band, std::size_t) {
            context.check_cancelled();
            parts[band] = band_volumes(band, lists.of(band));
        });
        CompensatedSum added, removed;
        for (const Volumes& part : parts) {
            added.add(part.added);
            removed.add(part.removed);
        }
        return {added.value() * cell_, removed.value() * cell_};
    }

private:
    struct Lists {
        std::vector<u32> begin, items;
        std::span<const u32> of(std::size_t band) const {
            return std::span(items).subspan(begin[band], begin[band + 1] - begin[band]);
        }
    };
    struct Crossing {
        double height;
        int change;  ///< change of the difference new - old, upwards along the line
    };
    struct Point {
        double u, w;
    };

    static std::vector<double> centres(double low, double length, double count) {
        std::vector<double> result(static_cast<std::size_t>(count));
        for (std::size_t i = 0; i < result.size(); ++i)
            result[i] = low + length * ((static_cast<double>(i) + 0.5) / count);
        return result;
    }
    /// The first position with a value ≥ `value`.
    static std::size_t first_from(const std::vector<double>& values, double value) {
        return static_cast<std::size_t>(std::ranges::lower_bound(values, value) - values.begin());
    }

    struct Rows {
        std::size_t first, last;  ///< `last` is not included
    };
    Rows rows_of(const Corners& triangle) const {
        const auto [low, high] = std::minmax({triangle[0].y(), triangle[1].y(), triangle[2].y()});
        return {first_from(vs_, low), first_from(vs_, high)};
    }

    Lists triangles_by_band(std::size_t bands) const {
        Lists lists;
        lists.begin.resize(bands + 2);
        const auto for_each_band = [&](auto&& action) {
            for (u32 row = 0; row < cycle_.size(); ++row) {
                const auto [first, last] = rows_of(cycle_[row]);
                for (std::size_t band = first / band_rows_; band * band_rows_ < last; ++band) action(band, row);
            }
        };
        for_each_band([&](std::size_t band, u32) { ++lists.begin[band + 2]; });
        for (std::size_t band = 2; band < lists.begin.size(); ++band) lists.begin[band] += lists.begin[band - 1];
        lists.items.resize(lists.begin.back());
        for_each_band([&](std::size_t band, u32 row) { lists.items[lists.begin[band + 1]++] = row; });
        return lists;
    }

    static Point point_at(const Vec3& low, const Vec3& high, double v) {
        const double share = (v - low.y()) / (high.y() - low.y());
        return {low.x() + share * (high.x() - low.x()), low.z() + share * (high.z() - low.z())};
    }

    /// Calls action(column, crossing) for each line of the row that meets the triangle. Pre: the row meets it.
    template <class Action>
    void for_each_crossing(const Corners& triangle, double v, Action&& action) const {
        Point ascending{}, descending{};  // where the row meets ascending and descending edges
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 &from = triangle[i], &to = triangle[(i + 1) % 3];
            if (from.y() <= v && !(to.y() <= v)) ascending = point_at(from, to, v);
            if (!(from.y() <= v) && to.y() <= v) descending = point_at(to, from, v);
        }
        // A triangle that faces up has its descending edge on the left; the line leaves the solid there.
        const bool faces_up = descending.u <= ascending.u;
        const Point &left = faces_up ? descending : ascending, &right = faces_up ? ascending : descending;
        for (std::size_t column = first_from(us_, left.u); column < us_.size() && us_[column] < right.u; ++column) {
            const double share = (us_[column] - left.u) / (right.u - left.u);
            action(column, Crossing{left.w + share * (right.w - left.w), faces_up ? -1 : 1});
        }
    }

    Volumes band_volumes(std::size_t band, std::span<const u32> triangles) const {
        const std::size_t first_row = band * band_rows_, last_row = std::min(first_row + band_rows_, vs_.size());
        const auto for_each = [&](auto&& action) {
            for (const u32 triangle : triangles) {
                const auto [first, last] = rows_of(cycle_[triangle]);
                for (std::size_t row = std::max(first, first_row); row < std::min(last, last_row); ++row)
                    for_each_crossing(cycle_[triangle], vs_[row], [&](std::size_t column, const Crossing& crossing) {
                        action((row - first_row) * us_.size() + column, crossing);
                    });
            }
        };
        std::vector<u32> begin((last_row - first_row) * us_.size() + 2);
        for_each([&](std::size_t line, const Crossing&) { ++begin[line + 2]; });
        for (std::size_t line = 2; line < begin.size(); ++line) begin[line] += begin[line - 1];
        std::vector<Crossing> crossings(begin.back());
        for_each([&](std::size_t line, const Crossing& crossing) { crossings[begin[line + 1]++] = crossing; });
        CompensatedSum added, removed;
        for (std::size_t line = 0; line + 2 < begin.size(); ++line) {
            const std::span<Crossing> on_line =
                std::span(crossings).subspan(begin[line], begin[line + 1] - begin[line]);
            std::ranges::sort(on_line, {}, &Crossing::height);
            int difference = 0;
            for (std::size_t i = 0; i < on_line.size(); ++i) {
                if (difference > 0) added.add(difference * (on_line[i].height - on_line[i - 1].height));
                if (difference < 0) removed.add(-difference * (on_line[i].height - on_line[i - 1].height));
                difference += on_line[i].change;
            }
            assert(difference == 0);  // the cycle is closed
        }
        return {added.value(), removed.value()};
    }

    std::span<const Corners> cycle_;
    std::vector<double> us_, vs_;  ///< coordinates of the lines
    double cell_ = 0;  ///< area per line
    std::size_t band_rows_ = 1;  ///< rows of lines that are measured together
};

/// Changes both volumes by the same share, so that their difference is `difference`. Where nothing is removed, or
/// nothing added, the result is exact. Volumes up to `zero` count as nothing.
Volumes corrected(Volumes measured, double difference, double zero) {
    for (double* volume : {&measured.added, &measured.removed})
        if (*volume <= zero) *volume = 0;
    if (std::abs(difference) <= zero) difference = 0;
    const double sum = measured.added + measured.removed;
    const double share = sum > 0 ? (difference - (measured.added - measured.removed)) / sum : 0;
    if (measured.removed <= measured.added) {
        const double removed = std::max({0.0, measured.removed * (1 - share), -difference});
        return {removed + difference, removed};
    }
    const double added = std::max({0.0, measured.added * (1 + share), difference});
    return {added, added - difference};
}

}  // namespace

std::vector<Change> changes(const ChangedTriangles& before, const ChangedTriangles& after, std::span<const u32> common,
                            Context& context) {
    context.check_cancelled();
    std::vector<Change> changes = components(before, after, common);
    for (Change& change : changes) {
        context.check_cancelled();
        CompensatedSum twice_area;
        for (const u32 row : change.new_triangles) {
            const auto [a, b, c] = corners(after, row);
            twice_area.add(area_vector(a, b, c).norm());
        }
        change.area = twice_area.value() / 2;
        std::vector<Corners> cycle = cycle_of(change, before, after);
        const double difference = signed_volume(cycle), zero = volume_by_rounding(cycle);
        tilt(cycle);
        const Volumes volumes = corrected(Grid(cycle).volumes(context), difference, zero);
        change.volume_added = volumes.added;
        change.volume_removed = volumes.removed;
    }
    return changes;
}

}  // namespace scanmill::updating
