// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/resample.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <queue>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::updating {

namespace {

using Counts = std::function<bool(const std::array<Vec3, 3>&)>;

constexpr u32 check_interval = 1 << 14;

double squared_length(std::span<const Vec3> positions, u32 a, u32 b) {
    return (positions[b] - positions[a]).squaredNorm();
}

std::array<Vec3, 3> corners(std::span<const Vec3> positions, const Triangle& t) {
    return {positions[t[0]], positions[t[1]], positions[t[2]]};
}

enum class Judged : u8 { unknown, outside, counts };

/// Whether the triangle has half-edges, and one of them is long.
bool is_long(std::span<const Vec3> positions, const Triangle& t, double squared_longest) {
    return !half_edges::has_repeated_vertex(t) && (squared_length(positions, t[0], t[1]) > squared_longest ||
                                                   squared_length(positions, t[1], t[2]) > squared_longest ||
                                                   squared_length(positions, t[2], t[0]) > squared_longest);
}

/// For each triangle with a long edge, whether it counts; `unknown` for the others. Empty if all triangles count.
/// nullopt if there is nothing to split.
std::optional<std::vector<Judged>> judged_triangles(const TriangleMesh& mesh, double squared_longest,
                                                    const Counts& counts, const Context& context) {
    std::vector<Judged> judged;
    bool any = false;
    for (u32 row = 0; row < mesh.triangles.size(); ++row) {
        if (row % check_interval == 0) context.check_cancelled();
        const Triangle& triangle = mesh.triangles[row];
        if (!is_long(mesh.positions.span(), triangle, squared_longest)) continue;
        if (!counts) return judged;
        const bool does_count = counts(corners(mesh.positions.span(), triangle));
        if (judged.empty()) judged.resize(mesh.triangles.size(), Judged::unknown);
        judged[row] = does_count ? Judged::counts : Judged::outside;
        any |= does_count;
    }
    if (!any) return std::nullopt;
    return judged;
}

/// A lower bound of the number of points that are added if all triangles count. No part of an edge is longer than
/// `longest`. No part of a triangle is larger than the equilateral triangle with this edge, and a split makes at most
/// two triangles more.
double least_added(const TriangleMesh& mesh, double longest) {
    double twice_area = 0, halves_of_edges = 0;
    for (const Triangle& triangle : mesh.triangles) {
        if (half_edges::has_repeated_vertex(triangle)) continue;
        const auto [a, b, c] = corners(mesh.positions.span(), triangle);
        twice_area += area_vector(a, b, c).norm();
        for (const double length : {(b - a).norm(), (c - b).norm(), (a - c).norm()})
            halves_of_edges += std::max(0.0, std::ceil(length / longest) - 1);
    }
    const double twice_largest = std::numbers::sqrt3 / 2 * longest * longest;
    const double triangles = twice_area / twice_largest - static_cast<double>(mesh.triangles.size());
    return std::floor(std::max(triangles / 2, halves_of_edges / 2));
}

[[noreturn]] void refuse(const std::string& number, double longest, bool all, std::size_t most) {
    throw Error("resampling so that no edge is longer than {:.4g} u would add {} points; at most {} are possible",
                longest, number, most)
        .hint(all ? "raise density, thin the clouds with voxel-thin, or set rebuild to local, which resamples only "
                    "near the clouds"
                  : "raise density, or thin the clouds with voxel-thin");
}

class Splitting {
public:
    Splitting(const TriangleMesh& mesh, std::vector<Judged> judged, double longest, const Counts& counts,
              std::size_t most)
        : mesh_(mesh),
          counts_(counts),
          most_(most),
          longest_(longest),
          squared_longest_(longest * longest),
          positions_(mesh.positions.begin(), mesh.positions.end()),
          triangles_(mesh.triangles.begin(), mesh.triangles.end()),
          opposite_(half_edges::opposites(mesh)),
          judged_(std::move(judged)) {
        assert(triangles_.size() < half_edges::no_half_edge / 3 - 2 * most_);  // numbers of half-edges
    }

    void run(Context& context) {
        std::vector<LongEdge> first;
        for (u32 h = 0; h < opposite_.size(); ++h) {
            const u32 other = opposite_[h];
            const bool is_first = other == half_edges::boundary || (other != half_edges::no_half_edge && h < other);
            if (is_first && is_split(h)) first.push_back(long_edge(h));
        }
        queue_ = Queue({}, std::move(first));
        double progress = 0;
        for (std::size_t popped = 0; !queue_.empty(); ++popped) {
            const LongEdge edge = queue_.top();
            queue_.pop();
            if (popped % check_interval == 0) {
                context.check_cancelled();
                // The number of splits grows as the area over the squared length.
                progress = std::max(progress, squared_longest_ / edge.squared_length);
                context.progress(resampling_begin + (resampling_end - resampling_begin) * progress);
            }
            if (edge_of(edge.half_edge) != edge.vertices || !is_split(edge.half_edge)) continue;
            if (parents_.size() == most_) refuse(fmt::format("more than {}", most_), longest_, !counts_, most_);
            split(edge.half_edge);
        }
    }

    Resampled result() {
        Resampled result;
        TriangleMesh& mesh = result.mesh;
        result.added = parents_.size();
        mesh.frame = mesh_.frame;
        mesh.positions = std::move(positions_);
        mesh.triangles = std::move(triangles_);
        mesh.vertex_columns = vertex_columns();
        mesh.face_columns = mesh_.face_columns.gather(rows_of_triangles());
        find_midpoints();
        mesh.sharp_edges = sharp_edges();
        Array<u32> rows;
        mesh.edges = edges(rows);
        mesh.edge_columns = mesh_.edge_columns.gather(rows);
        return result;
    }

private:
    struct LongEdge {
        double squared_length;
        Edge vertices;
        u32 half_edge;  ///< stale if it has other vertices

        /// Whether `other` is split before this edge.
        bool operator<(const LongEdge& other) const {
            if (squared_length != other.squared_length) return squared_length < other.squared_length;
            return vertices > other.vertices;
        }
    };
    using Queue = std::priority_queue<LongEdge>;

    u32 start(u32 h) const { return triangles_[h / 3][h % 3]; }
    u32 end(u32 h) const { return start(half_edges::after(h)); }
    u32 apex(u32 h) const { return start(half_edges::before(h)); }
    Edge edge_of(u32 h) const { return make_edge(start(h), end(h)); }
    LongEdge long_edge(u32 h) const { return {squared_length(positions_, start(h), end(h)), edge_of(h), h}; }

    bool does_count(u32 row) {
        if (!counts_) return true;
        if (judged_[row] == Judged::unknown)
            judged_[row] = counts_(corners(positions_, triangles_[row])) ? Judged::counts : Judged::outside;
        return judged_[row] == Judged::counts;
    }
    /// Whether the edge is long and in a triangle that counts.
    bool is_split(u32 h) {
        if (!(squared_length(positions_, start(h), end(h)) > squared_longest_)) return false;
        const u32 other = opposite_[h];
        if (other == half_edges::boundary) return does_count(h / 3);
        // Two triangles with the same vertices: both would get an edge from the midpoint to the same third vertex.
        if (apex(h) == apex(other)) return false;
        return does_count(h / 3) || does_count(other / 3);
    }
    void push(u32 h) {
        if (is_split(h)) queue_.push(long_edge(h));
    }
    void link(u32 one, u32 other) {
        opposite_[one] = other;
        if (other != half_edges::boundary) opposite_[other] = one;
    }

    void split(u32 h) {
        const u32 midpoint = static_cast<u32>(positions_.size());
        const Edge ends = edge_of(h);
        positions_.push_back((positions_[ends[0]] + positions_[ends[1]]) / 2);
        parents_.push_back(ends);
        std::array<u32, 2> sides{h, opposite_[h]};
        if (start(h) != ends[0]) std::swap(sides[0], sides[1]);
        std::array<u32, 2> appended{half_edges::boundary, half_edges::boundary};
        for (std::size_t i = 0; i < 2; ++i)
            if (sides[i] != half_edges::boundary) appended[i] = cut(sides[i], i == 0, midpoint);
        for (std::size_t i = 0; i < 2; ++i)
            if (sides[i] != half_edges::boundary) link(appended[i], appended[1 - i]);

        push(h);
        push(sides[0] == h ? appended[0] : appended[1]);
        for (std::size_t i = 0; i < 2; ++i) {
            if (sides[i] == half_edges::boundary) continue;
            const auto at_higher = [&](u32 half_edge) {
                return i == 0 ? half_edges::after(half_edge) : half_edges::before(half_edge);
            };
            push(at_higher(sides[i]));  // from the midpoint to the third vertex
            push(at_higher(appended[i]));  // has another number now
            if (counts_) push(at_higher(at_higher(sides[i])));  // the triangle may count now
        }
    }

    /// Halves the triangle of half-edge `h`, which is to be split at `midpoint`. The half at the lower vertex keeps the
    /// row, and `h` becomes the lower part of the edge. `ascending`: h goes from the lower vertex to the higher one.
    /// Returns the half-edge of the upper part, which has no opposite yet.
    u32 cut(u32 h, bool ascending, u32 midpoint) {
        const u32 row = h / 3, new_row = static_cast<u32>(triangles_.size());
        const u32 lower = h % 3, next = half_edges::after(h) % 3;
        Triangle half = triangles_[row];
        half[ascending ? lower : next] = midpoint;
        triangles_[row][ascending ? next : lower] = midpoint;
        triangles_.push_back(half);
        rows_.push_back(row < mesh_.triangles.size() ? row : rows_[row - mesh_.triangles.size()]);
        if (counts_) {
            judged_[row] = Judged::unknown;
            judged_.push_back(Judged::unknown);
        }
        opposite_.resize(opposite_.size() + 3, half_edges::boundary);
        const u32 upper = 3 * new_row + lower;
        const u32 inner =
            ascending ? half_edges::after(h) : half_edges::before(h);  // was the edge at the higher vertex
        link(3 * new_row + inner % 3, opposite_[inner]);
        link(inner, ascending ? half_edges::before(upper) : half_edges::after(upper));
        return upper;
    }

    /// The old row of every triangle.
    Array<u32> rows_of_triangles() const {
        Array<u32> rows(mesh_.triangles.size());
        std::iota(rows.begin(), rows.end(), u32(0));
        rows.insert(rows.end(), rows_.begin(), rows_.end());
        return rows;
    }

    ColumnTable vertex_columns() const {
        ColumnTable table;
        if (mesh_.vertex_columns.empty()) return table;
        Array<u32> rows(mesh_.positions.size());
        std::iota(rows.begin(), rows.end(), u32(0));
        rows.reserve(rows.size() + parents_.size());
        for (const Edge& ends : parents_) rows.push_back(rows[ends[0]]);
        for (const Column& column : mesh_.vertex_columns) {
            if (!column.is_list() && column.type() == ScalarType::float32)
                table.add(interpolated<float>(column));
            else if (!column.is_list() && column.type() == ScalarType::float64)
                table.add(interpolated<double>(column));
            else
                table.add(column.gather(rows));
        }
        return table;
    }

    template <class Number>
    Column interpolated(const Column& column) const {
        const auto old = column.values<Number>();
        const u32 width = column.components();
        const bool is_normal = column.name() == "normal" && width == 3;
        Array<Number> values(old.begin(), old.end());
        values.resize(old.size() + parents_.size() * width);
        Number* value = values.data() + old.size();
        for (const Edge& ends : parents_) {
            const Number *lower = values.data() + std::size_t(ends[0]) * width,
                         *higher = values.data() + std::size_t(ends[1]) * width;
            for (u32 i = 0; i < width; ++i) value[i] = std::midpoint(lower[i], higher[i]);
            if (is_normal) {
                const Vec3 sum{double(lower[0]) + double(higher[0]), double(lower[1]) + double(higher[1]),
                               double(lower[2]) + double(higher[2])};
                const double length = sum.norm();
                for (u32 i = 0; i < 3; ++i) value[i] = length > 0 ? static_cast<Number>(sum[i] / length) : lower[i];
            }
            value += width;
        }
        return Column(column.name(), width, Buffer<Number>(std::move(values)))
            .with_length_exponent(column.length_exponent());
    }

    void find_midpoints() {
        if (mesh_.sharp_edges.empty() && mesh_.edges.empty()) return;
        midpoints_.reserve(parents_.size());
        for (u32 i = 0; i < parents_.size(); ++i)
            midpoints_.push_back({parents_[i], static_cast<u32>(mesh_.positions.size()) + i});
        std::ranges::sort(midpoints_, {}, &Midpoint::edge);
    }
    /// Calls action(a, b) for the parts of the edge, in order from its first vertex to its second one.
    template <class Action>
    void for_each_part(const Edge& edge, Action&& action) const {
        std::vector<Edge> parts{edge};
        while (!parts.empty()) {
            const auto [a, b] = parts.back();
            parts.pop_back();
            const Edge key = make_edge(a, b);
            const auto found = std::ranges::lower_bound(midpoints_, key, {}, &Midpoint::edge);
            if (found == midpoints_.end() || found->edge != key) {
                action(a, b);
            } else {
                parts.push_back({found->vertex, b});
                parts.push_back({a, found->vertex});
            }
        }
    }
    Buffer<Edge> sharp_edges() const {
        Array<Edge> sharp;
        for (const Edge& edge : mesh_.sharp_edges)
            for_each_part(edge, [&](u32 a, u32 b) { sharp.push_back(make_edge(a, b)); });
        std::ranges::sort(sharp);
        sharp.erase(std::unique(sharp.begin(), sharp.end()), sharp.end());
        return sharp;
    }
    Buffer<Edge> edges(Array<u32>& rows) const {
        Array<Edge> edges;
        for (u32 row = 0; row < mesh_.edges.size(); ++row)
            for_each_part(mesh_.edges[row], [&](u32 a, u32 b) {
                edges.push_back(make_edge(a, b));
                rows.push_back(row);
            });
        return edges;
    }

    struct Midpoint {
        Edge edge;
        u32 vertex;
    };

    const TriangleMesh& mesh_;
    const Counts& counts_;
    std::size_t most_;
    double longest_, squared_longest_;
    Array<Vec3> positions_;
    Array<Triangle> triangles_;
    Array<u32> opposite_;
    std::vector<Judged> judged_;  ///< by triangle; unused if all triangles count
    Array<Edge> parents_;  ///< ends of the edge that each new vertex split
    Array<u32> rows_;  ///< old row of each appended triangle
    Queue queue_;
    std::vector<Midpoint> midpoints_;
};

}  // namespace

Resampled resampled(const TriangleMesh& mesh, double longest, const Counts& counts, Context& context,
                    std::size_t most) {
    if (!(longest > 0))
        throw Error("the longest edge after resampling must be above 0; it is {:g} u", longest)
            .hint("thin the clouds with voxel-thin: most of their points may have a duplicate");
    std::optional<std::vector<Judged>> judged = judged_triangles(mesh, longest * longest, counts, context);
    if (!judged) return {mesh, 0};
    if (!counts)
        if (const double least = least_added(mesh, longest); !(least <= static_cast<double>(most)))
            refuse(fmt::format("at least {:.0f}", least), longest, true, most);
    Splitting splitting(mesh, std::move(*judged), longest, counts, most);
    splitting.run(context);
    return splitting.result();
}

}  // namespace scanmill::updating
