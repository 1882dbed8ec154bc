// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/resample.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>
#include <optional>
#include <queue>
#include <unordered_set>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::updating {

namespace {

using Counts = std::function<bool(const std::array<Vec3, 3>&)>;

constexpr u32 check_interval = 1 << 14, suspect_check_interval = 1 << 17;

/// Distance of two edges that cross, as a share of one of them: far above the rounding of doubles, far below a crease.
constexpr double flatness = 1e-9;

/// The same as a share of the largest coordinate, if all coordinates have single precision: the rounding moves a point
/// of each edge by at most √3 2^-24 of it.
constexpr double single_rounding = 0x1p-22;

/// Least excess of two opposite angles over π: rectangles keep their diagonals.
constexpr double least_excess = 1e-6;

/// Whether the least angle is below 14.5°.
bool is_thin(const Vec3& a, const Vec3& b, const Vec3& c, double twice_area) {
    std::array<double, 3> squared{(b - a).squaredNorm(), (c - b).squaredNorm(), (a - c).squaredNorm()};
    std::ranges::sort(squared);
    return twice_area < thin_sine * std::sqrt(squared[1] * squared[2]);
}

std::uint64_t key_of(const Edge& edge) { return std::uint64_t(edge[0]) << 32 | edge[1]; }

/// The distance that rounding leaves between edges that cross: 0, or more if all coordinates have single precision, as
/// in most CAD files.
double rounding_of(std::span<const Vec3> positions) {
    double largest = 0;
    for (const Vec3& p : positions) {
        for (const double coordinate : p) {
            if (coordinate != static_cast<double>(static_cast<float>(coordinate))) return 0;
            largest = std::max(largest, std::abs(coordinate));
        }
    }
    return single_rounding * largest;
}

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
          judged_(std::move(judged)),
          rounding_(rounding_of(mesh.positions.span())) {
        assert(triangles_.size() < half_edges::no_half_edge / 3 - 2 * most_);  // numbers of half-edges
        for (const Edge& edge : mesh.sharp_edges) declared_.insert(key_of(edge));
        for (const auto& [a, b] : mesh.edges) declared_.insert(key_of(make_edge(a, b)));
    }

    void run(Context& context) {
        if (!counts_)
            if (const double least = least_added(); !(least <= static_cast<double>(most_)))
                refuse(fmt::format("at least {:.0f}", least), longest_, true, most_);
        std::vector<LongEdge> first;
        for (u32 h = 0; h < opposite_.size(); ++h) {
            if (!is_first(h)) continue;
            if (is_split(h)) first.push_back(long_edge(h));
            if (is_inner(h) && (is_near_long(h / 3) || is_near_long(opposite_[h] / 3))) suspects_.push_back(h);
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
            const u32 before = split_before(edge.half_edge);
            if (before != edge.half_edge) queue_.push(edge);  // its turn comes again if it is not flipped
            split(before);
            flip_suspects(context);
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
    double squared_length_of(u32 h) const { return squared_length(positions_, start(h), end(h)); }
    LongEdge long_edge(u32 h) const { return {squared_length_of(h), edge_of(h), h}; }

    /// Whether edges of this triangle of the given mesh may be flipped before the first split.
    bool is_near_long(u32 row) const { return !counts_ || judged_[row] != Judged::unknown; }
    bool is_inner(u32 h) const { return opposite_[h] < half_edges::no_half_edge; }
    /// Whether this is the half-edge that stands for its edge.
    bool is_first(u32 h) const { return opposite_[h] == half_edges::boundary || (is_inner(h) && h < opposite_[h]); }

    /// A lower bound of the number of points that are added if all triangles count. No part of an edge that stays is
    /// longer than `longest`. No triangle is larger than the equilateral one with this edge, and a split makes at most
    /// two triangles more.
    double least_added() {
        double twice_area = 0, on_edges = 0;
        for (const Triangle& triangle : triangles_)
            if (!half_edges::has_repeated_vertex(triangle)) twice_area += area_vector(positions_, triangle).norm();
        for (u32 h = 0; h < opposite_.size(); ++h)
            if (is_first(h) && is_split(h) && !is_flippable(h))
                on_edges += std::ceil(std::sqrt(squared_length_of(h)) / longest_) - 1;
        const double twice_largest = std::numbers::sqrt3 / 2 * squared_longest_;
        const double triangles = twice_area / twice_largest - static_cast<double>(triangles_.size());
        return std::floor(std::max(triangles / 2, on_edges));
    }

    bool does_count(u32 row) {
        if (!counts_) return true;
        if (judged_[row] == Judged::unknown)
            judged_[row] = counts_(corners(positions_, triangles_[row])) ? Judged::counts : Judged::outside;
        return judged_[row] == Judged::counts;
    }
    /// Whether the edge is long and in a triangle that counts.
    bool is_split(u32 h) {
        if (!(squared_length_of(h) > squared_longest_)) return false;
        const u32 other = opposite_[h];
        if (other == half_edges::boundary) return does_count(h / 3);
        // Two triangles with the same vertices: both would get an edge from the midpoint to the same third vertex.
        if (apex(h) == apex(other)) return false;
        return does_count(h / 3) || does_count(other / 3);
    }
    void push(u32 h) {
        if (is_split(h)) queue_.push(long_edge(h));
    }

    /// Lawson's algorithm: flips edges until no suspect is to be flipped; a flip makes the edges around it suspects.
    void flip_suspects(Context& context) {
        while (!suspects_.empty()) {
            if (++suspected_ % suspect_check_interval == 0) context.check_cancelled();
            const u32 h = suspects_.back();
            suspects_.pop_back();
            if (is_flipped(h)) flip(h);
        }
    }
    /// Whether the edge is to be flipped: one of its triangles is thin, and it violates the empty-circle test.
    bool is_flipped(u32 h) {
        if (!is_inner(h)) return false;
        const u32 other = opposite_[h];
        const Vec3 &a = positions_[start(h)], &b = positions_[end(h)], &c = positions_[apex(h)],
                   &d = positions_[apex(other)];
        const double twice_area = area_vector(a, b, c).norm(), other_twice_area = area_vector(b, a, d).norm();
        const double cosine = (a - c).dot(b - c), other_cosine = (b - d).dot(a - d);
        const double size =
            std::sqrt((a - c).squaredNorm() * (b - c).squaredNorm() * (a - d).squaredNorm() * (b - d).squaredNorm());
        // The sine of the sum of both angles opposite to the edge. The other angles have a sum below π then: the
        // quadrilateral is strictly convex.
        if (!(twice_area * other_cosine + other_twice_area * cosine < -least_excess * size)) return false;
        return (is_thin(a, b, c, twice_area) || is_thin(b, a, d, other_twice_area)) && is_flippable(h);
    }
    /// Whether the edge may be flipped: the surface remains the same, and the edge is not declared.
    bool is_flippable(u32 h) {
        if (!is_inner(h)) return false;
        const u32 other = opposite_[h];
        const Vec3 &a = positions_[start(h)], &b = positions_[end(h)], &c = positions_[apex(h)],
                   &d = positions_[apex(other)];
        if (!(area_vector(a, b, c).dot(area_vector(b, a, d)) > 0)) return false;
        // The flip moves no point of the surface farther than the distance between the old and the new edge.
        const Vec3 normal = (b - a).cross(d - c);
        const double distance = std::max(flatness * (b - a).norm(), rounding_);
        if (!(std::abs(normal.dot(c - a)) <= distance * normal.norm())) return false;
        return !declared_.contains(key_of(edge_of(h))) && does_count(h / 3) && does_count(other / 3);
    }
    /// The edge to split before this long one, or this one. The midpoints of two sides of a triangle are half of the
    /// third side apart. Where that is too near, a side that stays is split before one that its split may flip.
    u32 split_before(u32 h) {
        std::optional<LongEdge> best;
        if (is_flippable(h))
            for (const u32 half_edge : {h, opposite_[h]}) {
                const std::array<u32, 2> sides{half_edges::after(half_edge), half_edges::before(half_edge)};
                for (std::size_t i = 0; i < 2; ++i)
                    if (4 * squared_length_of(sides[1 - i]) < squared_longest_ && is_split(sides[i]) &&
                        !is_flippable(sides[i]) && (!best || *best < long_edge(sides[i])))
                        best = long_edge(sides[i]);
            }
        return best ? best->half_edge : h;
    }

    /// Replaces the edge of two triangles by the one between their other vertices. Half-edge after(h) becomes the new
    /// edge; h and its opposite take the place of the two sides that change their triangle.
    void flip(u32 h) {
        const u32 other = opposite_[h], side = half_edges::after(h), other_side = half_edges::after(other);
        const u32 vertex = apex(h), other_vertex = apex(other);
        triangles_[side / 3][side % 3] = other_vertex;
        triangles_[other_side / 3][other_side % 3] = vertex;
        link(h, opposite_[other_side]);
        link(other, opposite_[side]);
        link(side, other_side);
        if (counts_) judged_[h / 3] = judged_[other / 3] = Judged::unknown;
        push(side);
        for (const u32 outer : {h, half_edges::before(h), other, half_edges::before(other)}) {
            push(outer);  // has another number now, or its triangle may count now
            suspects_.push_back(outer);
        }
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

        for (const u32 half : {h, sides[0] == h ? appended[0] : appended[1]}) {
            push(half);
            suspects_.push_back(half);
        }
        for (std::size_t i = 0; i < 2; ++i) {
            if (sides[i] == half_edges::boundary) continue;
            const auto at_higher = [&](u32 half_edge) {
                return i == 0 ? half_edges::after(half_edge) : half_edges::before(half_edge);
            };
            push(at_higher(sides[i]));  // from the midpoint to the third vertex
            push(at_higher(appended[i]));  // has another number now
            const u32 at_lower = at_higher(at_higher(sides[i]));
            if (counts_) push(at_lower);  // the triangle may count now
            suspects_.push_back(at_lower);
            suspects_.push_back(at_higher(appended[i]));
        }
        if (declared_.erase(key_of(ends)) > 0)
            for (const u32 vertex : ends) declared_.insert(key_of(make_edge(vertex, midpoint)));
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
    double rounding_;
    std::unordered_set<std::uint64_t> declared_;  ///< sharp edges and `edges`, which are not flipped
    std::vector<u32> suspects_;  ///< half-edges that may have to be flipped
    std::size_t suspected_ = 0;
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
    Splitting splitting(mesh, std::move(*judged), longest, counts, most);
    splitting.run(context);
    return splitting.result();
}

}  // namespace scanmill::updating
