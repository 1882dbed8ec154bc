// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/tessellate.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/geometry/a_patch.hpp"
#include "tessellate/structure.hpp"

namespace scanmill {

namespace {

using namespace tessellation;

constexpr std::size_t chunk = 64;  // edges or triangles
constexpr unsigned uniform_fan = 4, least_fan = 2;  // segments of a fan
constexpr unsigned most_subdivision = 1024;
constexpr unsigned length_steps = 8;
constexpr double rounding = 1e-14;  // of the diagonal: below it a value at a point of the mesh is 0
// The largest value of a quadratic function on a segment with zeros at its ends, over that at a third of it.
constexpr double middle_over_third = 9. / 8;
constexpr double share_along = 2. / 3;  // of max_error, for lines along rows

/// A point of the surface.
struct SurfacePoint {
    Vec3 position = Vec3::Zero(), normal = Vec3::Zero();
    u8 side = 1;
};

/// A point of an edge between its ends.
struct Sample {
    std::array<double, 2> share;  ///< of the edge, from a and from b
    bool is_on_surface;
    u8 side;  ///< where the surface is
};

/// The triangles beside an edge: a grid of points whose rows are the samples, and whose columns lead from the face of
/// the first triangle to that of the second. At a border only the column of the first triangle; the ends of the edge
/// and samples on the surface have one point.
struct Strip {
    unsigned segments = 1, fan = 1;
    std::vector<Sample> samples;
    std::vector<u32> first;  ///< of each sample's points, and one more
    std::vector<SurfacePoint> points;
    u32 first_vertex = 0;
    double worst = 0;  ///< distance found between its triangles and the surface

    bool is_collapsed(std::size_t sample) const { return first[sample + 1] - first[sample] == 1; }
    bool is_straight() const { return samples.empty(); }
};

/// Vertices along an edge or inside a triangle, with their shares of the way.
struct Row {
    std::vector<u32> vertices;
    std::vector<double> shares;
};

/// The points inside a triangle: on `rows` - 1 triangles around the base point, with the fewer segments the smaller
/// these are.
struct Grid {
    unsigned segments = 1, rows = 1;
    bool is_triangular = false;  ///< instead an undivided triangle has a triangular grid
    std::vector<double> shares;  ///< of the rows, between the base point and the edges; and one for the edges
    std::vector<SurfacePoint> points;
    u32 first_vertex = 0;
    double worst = 0;

    /// Of row r on one third.
    unsigned segments_of(unsigned r) const { return (segments * r + rows - 1) / rows; }
};

Barycentric corner(u32 i) {
    Barycentric at = Barycentric::Zero();
    at[i] = 1;
    return at;
}

/// Numbers of the points on triangles around a base point: the base point, those on the lines from there to the
/// corners, those of the thirds.
class ThirdsNumbers {
public:
    explicit ThirdsNumbers(const Grid& grid) : grid_(grid), before_(grid.rows + 1, 0) {
        for (unsigned r = 1; r < grid.rows; ++r) before_[r + 1] = before_[r] + grid.segments_of(r) - 1;
    }
    u32 count() const { return 1 + 3 * (grid_.rows - 1) + 3 * before_.back(); }
    /// Point k of row r = 0 … rows - 1; row 0 is the base point.
    u32 operator()(u32 third, u32 r, u32 k) const {
        if (r == 0) return 0;
        if (k == 0) return 1 + third * (grid_.rows - 1) + r - 1;
        if (k == grid_.segments_of(r)) return 1 + (third + 1) % 3 * (grid_.rows - 1) + r - 1;
        return 1 + 3 * (grid_.rows - 1) + third * before_.back() + before_[r] + k - 1;
    }

private:
    const Grid& grid_;
    std::vector<u32> before_;  ///< inner points of a third in the rows before
};

/// The inner vertex of an undivided triangle of level n >= 3, with so many steps from corner 0 to corners 1 and 2.
u32 grid_vertex(u32 i, u32 j) { return (i + j - 1) * (i + j - 2) / 2 + j - 1; }

/// Triangles between a row on an edge and a row inside the triangle, both in the edge's direction: the row with the
/// smaller next share goes on, the edge's if they are equal. Calls add(a, b, c) with a and b in one row.
template <class Add>
void join(const Row& edge, const Row& inner, Add&& add) {
    std::size_t i = 0, j = 0;
    const std::size_t edges = edge.vertices.size() - 1, inners = inner.vertices.size() - 1;
    while (i < edges || j < inners)
        if (i < edges && (j == inners || edge.shares[i + 1] <= inner.shares[j + 1])) {
            add(edge.vertices[i], edge.vertices[i + 1], inner.vertices[j]);
            ++i;
        } else {
            add(inner.vertices[j + 1], inner.vertices[j], edge.vertices[i]);
            ++j;
        }
}

/// `count` points at equal distances. A single one has no share.
template <class VertexAt>
Row inner_row(u32 count, VertexAt&& vertex_at) {
    Row row;
    for (u32 k = 0; k < count; ++k) {
        row.vertices.push_back(vertex_at(k));
        row.shares.push_back(count > 1 ? static_cast<double>(k) / (count - 1) : 0);
    }
    return row;
}

/// Calls add(third, a, b, c) for the triangles of a divided triangle, whose inner vertices begin at `first`; a and b
/// are in one row, c is in the next or the one before.
template <class Add>
void connect_thirds(const Grid& grid, u32 first, const std::array<Row, 3>& edges, Add&& add) {
    const ThirdsNumbers numbers(grid);
    for (u32 third = 0; third < 3; ++third) {
        Row inner{{first}, {0}};
        for (u32 r = 1; r <= grid.rows; ++r) {
            const Row outer = r == grid.rows ? edges[third] : inner_row(grid.segments_of(r) + 1, [&](u32 k) {
                return first + numbers(third, r, k);
            });
            join(outer, inner, [&](u32 a, u32 b, u32 c) { add(third, a, b, c); });
            inner = outer;
        }
    }
}

/// The same for a triangular grid.
template <class Add>
void connect_triangular(const Grid& grid, u32 first, const std::array<Row, 3>& edges, Add&& add) {
    const u32 n = grid.segments;
    if (n == 1) {
        add(0, edges[0].vertices[0], edges[1].vertices[0], edges[2].vertices[0]);
        return;
    }
    const auto at = [&](u32 i, u32 j) { return first + grid_vertex(i, j); };
    for (std::size_t i = 0; i < 3; ++i) {
        const Row inner = inner_row(n <= 3 ? 1 : n - 2, [&](u32 k) {
            if (n <= 3) return first;
            return i == 0 ? at(k + 1, 1) : i == 1 ? at(n - 2 - k, k + 1) : at(1, n - 2 - k);
        });
        join(edges[i], inner, [&](u32 a, u32 b, u32 c) { add(0, a, b, c); });
    }
    for (u32 i = 1; i + 2 < n; ++i)
        for (u32 j = 1; i + j + 1 < n; ++j) {
            add(0, at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + j + 2 < n) add(0, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
}

class Tessellation {
public:
    Tessellation(const PatchComplex& patches, const TessellateParams& params, Execution& execution)
        : patches_(patches),
          subdivision_(params.subdivision),
          max_error_(params.max_error ? std::optional(params.max_error->value()) : std::nullopt),
          segments_(params.segments),
          execution_(execution) {
        if (subdivision_ < 1 || subdivision_ > most_subdivision)
            throw Error("subdivision must be from 1 to {}; it is {}", most_subdivision, subdivision_);
        if (max_error_ && !(*max_error_ > 0)) throw Error("max-error must be above 0; it is {:g}", *max_error_);
    }

    TriangleMesh mesh() {
        structure_ = structure_of(patches_);
        zero_ = rounding * bounding_box(patches_.positions.span()).diagonal();
        number_corners();
        max_error_ ? build_within_error() : static_cast<void>(build(subdivision_));
        collect_points();
        connect();
        return finished();
    }

private:
    // Points of the surface.

    PatchCell cell(u32 row) const { return PatchCell(patches_, row); }

    /// Where the line from a point of the mesh to a point off it meets the surface.
    SurfacePoint hit(const PatchCell& cell, u8 side, const Barycentric& from, const Barycentric& to) const {
        std::optional<double> t = 0;
        if (std::abs(patch_value(cell.weights(), from)) > zero_) t = patch_hit(cell.weights(), from, to);
        if (!t) throw Error("the patches have no surface on a line from the mesh to an apex");
        const Barycentric at = (1 - *t) * from + *t * to;
        return {cell.point(at), cell.gradient(at).normalized(), side};
    }

    /// The side of the mesh on which the surface is seen from a point of it.
    u8 side_of(double value) const { return value <= zero_; }

    /// The largest distances found between the surface and lines along rows, lines along columns, and triangles.
    struct Errors {
        double along = 0, across = 0, inside = 0;

        double worst() const { return std::max({along, across, inside}); }
    };

    /// Doubles the numbers of segments of rows and of columns, up to `most` and `most_across`, where the errors demand
    /// it. Returns whether one was doubled. More columns make the triangles lie along the lines along the rows, so
    /// these get a smaller share of the error.
    bool refine(unsigned& along, unsigned& across, const Errors& errors, unsigned most, unsigned most_across) const {
        const double wanted = *max_error_;
        const bool is_long = errors.along > share_along * wanted;
        const bool widen =
            2 * across <= most_across && (errors.across > wanted || (errors.inside > wanted && !is_long));
        const bool lengthen = 2 * along <= most && (is_long || (errors.inside > wanted && !widen));
        if (lengthen) along *= 2;
        if (widen) across *= 2;
        return lengthen || widen;
    }

    // Strips.

    /// The tetrahedra beside an edge by side and triangle; at a border those of its triangle.
    std::array<std::array<PatchCell, 2>, 2> cells_of(const EdgeTets& edge) const {
        const auto at = [&](std::size_t side, std::size_t of) {
            if (!edge.is_border()) return cell(edge.rows[side][of]);
            const TriangleTets& t = structure_.triangles[edge.triangles[0]];
            return cell(t.rows[side][t.count == 3 ? edge.corner : 0]);
        };
        return {{{at(0, 0), at(0, 1)}, {at(1, 0), at(1, 1)}}};
    }

    /// Coordinates of a point of the edge in the tetrahedra of its first or second triangle.
    Barycentric on_edge(const EdgeTets& edge, std::size_t of, double share) const {
        if (of == 1) return {0, share, 1 - share, 0};
        const bool is_whole = edge.is_border() && structure_.triangles[edge.triangles[0]].count == 1;
        const u32 i = is_whole ? edge.corner : 1, j = (i + 1) % (is_whole ? 3 : 4);
        return (1 - share) * corner(i) + share * corner(j);
    }

    /// Where the surface crosses the edge between its ends. On the edge the function is
    /// 3 s (1 - s) ((1 - s) f(a, a, b) + s f(a, b, b)).
    std::optional<double> crossing(const EdgeTets& edge, const PatchCell& cell) const {
        const Barycentric a = on_edge(edge, 0, 0), b = on_edge(edge, 0, 1);
        const double one = patch_blossom(cell.weights(), a, a, b), other = patch_blossom(cell.weights(), a, b, b);
        if (!((one < 0 && other > 0) || (one > 0 && other < 0))) return std::nullopt;
        const double share = one / (one - other);
        // Before or after it the edge is on the surface up to rounding.
        if (std::min(std::abs(one) * share, std::abs(other) * (1 - share)) <= zero_) return std::nullopt;
        return share;
    }

    /// Equally spaced samples, and one where the surface crosses the edge: the nearest is moved there if it is nearer
    /// than a quarter of the spacing.
    std::vector<Sample> samples_of(const EdgeTets& edge, const PatchCell& cell, unsigned segments) const {
        std::vector<std::array<double, 2>> shares;
        for (unsigned k = 1; k < segments; ++k)
            shares.push_back({static_cast<double>(k) / segments, static_cast<double>(segments - k) / segments});
        const std::optional<double> zero = crossing(edge, cell);
        if (zero) {
            const double at = *zero * segments, nearest = std::floor(at + 0.5);
            const std::array<double, 2> share{*zero, 1 - *zero};
            if (nearest >= 1 && nearest < segments && std::abs(at - nearest) < 0.25)
                shares[static_cast<std::size_t>(nearest) - 1] = share;
            else
                shares.insert(shares.begin() + static_cast<std::ptrdiff_t>(at), share);
        }
        std::vector<Sample> samples;
        for (const auto& share : shares) {
            const double value = patch_value(cell.weights(), on_edge(edge, 0, share[0]));
            samples.push_back({share, share[0] == zero || std::abs(value) <= zero_, side_of(value)});
        }
        return samples;
    }

    /// Lifts the samples' points.
    void lift(Strip& strip, const EdgeTets& edge, const std::array<std::array<PatchCell, 2>, 2>& cells) const {
        strip.first.assign(1, 0);
        strip.points.clear();
        for (const Sample& sample : strip.samples) {
            const double share = sample.share[0];
            if (edge.is_border() || sample.is_on_surface) {
                strip.points.push_back(hit(cells[sample.side][0], sample.side, on_edge(edge, 0, share),
                                           sample.is_on_surface ? on_edge(edge, 0, share) : corner(3)));
            } else {
                for (unsigned k = 0; k <= strip.fan; ++k) {
                    const bool is_second = 2 * k > strip.fan;
                    const double across = static_cast<double>(is_second ? strip.fan - k : k) / strip.fan;
                    strip.points.push_back(hit(cells[sample.side][is_second], sample.side,
                                               on_edge(edge, is_second, share), {2 * across, 0, 0, 1 - 2 * across}));
                }
            }
            strip.first.push_back(static_cast<u32>(strip.points.size()));
        }
    }

    Vec3 position(const Strip& strip, const EdgeTets& edge, std::size_t s, unsigned k) const {
        if (s == 0) return patches_.positions[edge.a];
        if (s > strip.samples.size()) return patches_.positions[edge.b];
        return strip.points[strip.first[s - 1] + (strip.is_collapsed(s - 1) ? 0 : k)].position;
    }

    Errors errors_of(const Strip& strip, const EdgeTets& edge,
                     const std::array<std::array<PatchCell, 2>, 2>& cells) const {
        Errors errors;
        const std::size_t last = strip.samples.size() + 1;
        const unsigned columns = edge.is_border() ? 1 : strip.fan + 1;
        for (std::size_t s = 0; s < last; ++s) {
            const bool is_first_on_surface = s == 0 || strip.samples[s - 1].is_on_surface;
            const std::size_t other = is_first_on_surface ? s + 1 : s;
            const std::size_t side = other > 0 && other < last ? strip.samples[other - 1].side : 1;
            const bool is_flat = is_first_on_surface && (s + 1 == last || strip.samples[s].is_on_surface);
            for (unsigned k = 0; k < (is_flat ? 1 : columns); ++k) {
                const PatchCell& here = cells[side][2 * k >= strip.fan && !edge.is_border()];
                const Vec3 a = position(strip, edge, s, k), d = position(strip, edge, s + 1, k);
                errors.along = std::max(errors.along, distance_of(here, a, d));
                if (is_flat || k + 1 >= columns) continue;
                const Vec3 b = position(strip, edge, s, k + 1), c = position(strip, edge, s + 1, k + 1);
                errors.across = std::max(errors.across, distance_of(here, a, b));
                errors.inside = std::max({errors.inside, distance_of(here, a, c),
                                          std::abs(here.first_order_distance((a + b + c) / 3)),
                                          std::abs(here.first_order_distance((a + c + d) / 3))});
            }
        }
        return errors;
    }

    /// The largest distance between a segment and the surface through its ends, as in the middle of a parabola.
    static double distance_of(const PatchCell& cell, const Vec3& a, const Vec3& b) {
        return middle_over_third * std::max(std::abs(cell.first_order_distance((2 * a + b) / 3)),
                                            std::abs(cell.first_order_distance((a + 2 * b) / 3)));
    }

    void build_strip(std::size_t e, unsigned most) {
        const EdgeTets& edge = structure_.edges[e];
        Strip& strip = strips_[e];
        const auto cells = cells_of(edge);
        const bool is_fixed = segments_ || !max_error_;
        strip.segments = segments_    ? std::clamp(segments_(make_edge(edge.a, edge.b)), 1u, most_subdivision)
                         : max_error_ ? 1
                                      : most;
        strip.fan = edge.is_border() ? 1 : is_fixed ? uniform_fan : least_fan;
        for (;;) {
            strip.samples = samples_of(edge, cells[1][0], strip.segments);
            lift(strip, edge, cells);
            if (is_fixed) return;
            const Errors errors = errors_of(strip, edge, cells);
            strip.worst = errors.worst();
            if (!refine(strip.segments, strip.fan, errors, most, edge.is_border() ? 1 : most)) return;
        }
    }

    // Grids.

    u32 row_vertex(std::size_t e, std::size_t s, unsigned k) const {
        const EdgeTets& edge = structure_.edges[e];
        const Strip& strip = strips_[e];
        if (s == 0) return number_of_corner_[edge.a];
        if (s > strip.samples.size()) return number_of_corner_[edge.b];
        return strip.first_vertex + strip.first[s - 1] + (strip.is_collapsed(s - 1) ? 0 : k);
    }

    /// The samples on the edges of triangle f, from corner i to the next.
    std::array<Row, 3> rows_of(std::size_t f) const {
        std::array<Row, 3> rows;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t e = structure_.triangles[f].edges[i];
            const Strip& strip = strips_[e];
            const bool is_first = structure_.edges[e].triangles[0] == f;
            const std::size_t last = strip.samples.size() + 1;
            for (std::size_t n = 0; n <= last; ++n) {
                const std::size_t s = is_first ? n : last - n;
                rows[i].vertices.push_back(row_vertex(e, s, is_first ? 0 : strip.fan));
                rows[i].shares.push_back(n == 0 ? 0 : n == last ? 1 : strip.samples[s - 1].share[is_first ? 0 : 1]);
            }
        }
        return rows;
    }

    void build_grid(std::size_t f, unsigned most) {
        const TriangleTets& t = structure_.triangles[f];
        Grid& grid = grids_[f];
        std::vector<PatchCell> cells;  // the outer ones first
        for (const std::size_t side : {1, 0})
            for (u32 third = 0; third < t.count; ++third) cells.push_back(cell(t.rows[side][third]));
        const std::array<Row, 3> edges = rows_of(f);
        const bool is_fixed = segments_ || !max_error_;
        bool is_straight = true;
        grid.segments = is_fixed && !segments_ ? most : 1;
        for (const u32 e : t.edges) {
            grid.segments = std::max(grid.segments, strips_[e].segments);
            is_straight = is_straight && strips_[e].is_straight();
        }
        // The triangle itself is possible between three segments only.
        grid.is_triangular = t.count == 1 && (is_fixed || is_straight);
        if (grid.is_triangular && !is_straight) grid.segments = std::max(grid.segments, 2u);
        grid.rows = is_fixed ? grid.segments : 1;
        std::vector<double> lengths;
        if (!is_fixed) lengths = lengths_to_corners(t, cells);
        for (;;) {
            set_shares(grid, lengths);
            lift(grid, t, cells);
            if (is_fixed) return;
            const Errors errors = errors_of(grid, t, cells, edges);
            grid.worst = errors.worst();
            if (grid.is_triangular) {
                if (grid.worst <= *max_error_) return;
                grid.is_triangular = false;
            } else if (!refine(grid.segments, grid.rows, errors, most, most)) {
                return;
            }
        }
    }

    /// Lengths on the surface above the lines from the base point to the corners, at equal steps, of the longest line
    /// each. Towards the corners the lines to the apex make a small angle with the surface, so the steps grow.
    std::vector<double> lengths_to_corners(const TriangleTets& t, const std::vector<PatchCell>& cells) const {
        std::vector<double> lengths{0};
        std::array<Vec3, 3> before;
        for (unsigned step = 0; step <= length_steps; ++step) {
            double longest = 0;
            for (u32 third = 0; third < 3; ++third) {
                const double share = static_cast<double>(step) / length_steps;
                const Vec3 here = step < length_steps ? above(t, cells, third, share, 0).position
                                                      : patches_.positions[t.corners[third]];
                if (step > 0) longest = std::max(longest, (here - before[third]).norm());
                before[third] = here;
            }
            if (step > 0) lengths.push_back(lengths.back() + longest);
        }
        return lengths;
    }

    /// Of the rows: equal steps of length, or of the triangle if lengths are not given.
    static void set_shares(Grid& grid, const std::vector<double>& lengths) {
        grid.shares.clear();
        for (unsigned r = 0, step = 0; r <= grid.rows; ++r) {
            const double share = static_cast<double>(r) / grid.rows;
            grid.shares.push_back(share);
            if (lengths.empty() || r == grid.rows || !(lengths.back() > 0)) continue;
            const double wanted = share * lengths.back();
            while (step + 2 < lengths.size() && lengths[step + 1] < wanted) ++step;
            const double part = (wanted - lengths[step]) / (lengths[step + 1] - lengths[step]);
            grid.shares.back() = (step + part) / static_cast<double>(lengths.size() - 1);
        }
    }

    Errors errors_of(const Grid& grid, const TriangleTets& t, const std::vector<PatchCell>& cells,
                     const std::array<Row, 3>& edges) const {
        const auto position = [&](u32 vertex) -> const Vec3& {
            return vertex < points_.size() ? points_[vertex].position : grid.points[vertex - points_.size()].position;
        };
        Errors errors;
        connect_grid(grid, static_cast<u32>(points_.size()), edges, [&](u32 third, u32 a, u32 b, u32 c) {
            if (a == b || b == c || c == a) return;
            const Vec3 &p = position(a), &q = position(b), &r = position(c);
            // The corners may be on both sides of the mesh.
            const u32 part = t.count == 3 ? third : 0;
            const auto at = [&](const Vec3& x) {
                const bool is_outer = cells[part].coordinates(x)[3] >= 0;
                return std::abs(cells[is_outer ? part : t.count + part].first_order_distance(x));
            };
            const auto on = [&](const Vec3& x, const Vec3& y) {
                return middle_over_third * std::max(at((2 * x + y) / 3), at((x + 2 * y) / 3));
            };
            errors.along = std::max(errors.along, on(p, q));
            errors.inside = std::max({errors.inside, on(q, r), on(r, p), at((p + q + r) / 3)});
        });
        return errors;
    }

    template <class Add>
    static void connect_grid(const Grid& grid, u32 first, const std::array<Row, 3>& edges, Add&& add) {
        grid.is_triangular ? connect_triangular(grid, first, edges, add) : connect_thirds(grid, first, edges, add);
    }

    /// Above a point of a triangle, given by its coordinates in a third: base point, corners i and j; or in an
    /// undivided triangle.
    SurfacePoint above(const std::vector<PatchCell>& cells, u32 third, const Vec3& base) const {
        const Barycentric from(base[0], base[1], base[2], 0);
        const u8 side = side_of(patch_value(cells[third].weights(), from));
        return hit(cells[side == 1 ? third : cells.size() / 2 + third], side, from, corner(3));
    }

    /// Above the point of a third at `share` of the way from the base point, or the centre of an undivided triangle, to
    /// the point at `along` of the edge.
    SurfacePoint above(const TriangleTets& t, const std::vector<PatchCell>& cells, u32 third, double share,
                       double along) const {
        const double i = share * (1 - along), j = share * along;
        if (t.count == 3) return above(cells, third, {1 - share, i, j});
        Vec3 base = Vec3::Constant((1 - share) / 3);
        base[third] += i;
        base[(third + 1) % 3] += j;
        return above(cells, 0, base);
    }

    void lift(Grid& grid, const TriangleTets& t, const std::vector<PatchCell>& cells) const {
        const u32 n = grid.segments;
        if (!grid.is_triangular) {
            const ThirdsNumbers numbers(grid);
            grid.points.resize(numbers.count());
            for (u32 third = 0; third < 3; ++third)
                for (u32 r = third == 0 ? 0 : 1; r < grid.rows; ++r) {
                    const u32 count = std::max(grid.segments_of(r), 1u);
                    for (u32 k = 0; k < count; ++k)
                        grid.points[numbers(third, r, k)] =
                            above(t, cells, third, grid.shares[r], static_cast<double>(k) / count);
                }
        } else if (n == 2) {
            grid.points = {above(cells, 0, Vec3::Constant(1. / 3))};
        } else {
            grid.points.resize(n == 1 ? 0 : (n - 1) * (n - 2) / 2);
            for (u32 i = 1; i < n; ++i)
                for (u32 j = 1; i + j < n; ++j)
                    grid.points[grid_vertex(i, j)] = above(cells, 0, Vec3(n - i - j, i, j) / n);
        }
    }

    // Levels.

    /// Lifts all points with at most so many segments per edge. Returns the largest distance that is found between the
    /// triangles and the surface.
    double build(unsigned most) {
        strips_.assign(structure_.edges.size(), {});
        for_each_chunk(execution_.threads(), strips_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (std::size_t e = begin; e < end; ++e) build_strip(e, most);
        });
        std::size_t next = corners_;
        for (Strip& strip : strips_) {
            strip.first_vertex = static_cast<u32>(next);
            next += strip.points.size();
        }
        require_countable(next);
        points_.resize(corners_);
        for (const Strip& strip : strips_) points_.insert(points_.end(), strip.points.begin(), strip.points.end());
        grids_.assign(structure_.triangles.size(), {});
        for_each_chunk(execution_.threads(), grids_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (std::size_t f = begin; f < end; ++f) build_grid(f, most);
        });
        double worst = 0;
        for (const Strip& strip : strips_) worst = std::max(worst, strip.worst);
        for (const Grid& grid : grids_) worst = std::max(worst, grid.worst);
        return worst;
    }

    void build_within_error() {
        const unsigned most = std::bit_floor(subdivision_);
        const double worst = build(most);
        if (worst <= *max_error_ || segments_) return;
        unsigned enough = 2 * most;
        while (enough <= most_subdivision && build(enough) > *max_error_) enough *= 2;
        Error error("with {} segments per edge the triangles are up to {:.3g} from the surface; max-error is {:.3g}",
                    most, worst, *max_error_);
        error.set_hint(enough <= most_subdivision ? fmt::format("subdivision {} suffices", enough)
                                                  : "a larger max-error needs fewer segments");
        throw error;
    }

    static void require_countable(std::size_t vertices) {
        if (vertices >= none)
            throw Error("the mesh would have {} vertices; at most {} are possible", vertices, none - 1);
    }

    // The mesh: vertices of the mesh below, then strip by strip, then grid by grid.

    void number_corners() {
        number_of_corner_.assign(patches_.positions.size(), none);
        for (const TriangleTets& t : structure_.triangles)
            for (const u32 v : t.corners) number_of_corner_[v] = 0;
        corners_ = 0;
        for (u32& number : number_of_corner_)
            if (number != none) number = corners_++;
        points_.resize(corners_);
        for (const TriangleTets& t : structure_.triangles)
            for (u32 i = 0; i < 3; ++i) {
                const PatchCell here = cell(t.rows[1][t.count == 3 ? i : 0]);
                points_[number_of_corner_[t.corners[i]]] = {
                    patches_.positions[t.corners[i]], here.gradient(corner(t.count == 3 ? 1 : i)).normalized(), 1};
            }
    }

    void collect_points() {
        std::size_t next = points_.size();
        for (Grid& grid : grids_) {
            grid.first_vertex = static_cast<u32>(next);
            next += grid.points.size();
        }
        require_countable(next);
        points_.reserve(next);
        for (const Grid& grid : grids_) points_.insert(points_.end(), grid.points.begin(), grid.points.end());
    }

    void connect() {
        for (u32 f = 0; f < grids_.size(); ++f) {
            patch_ = f;
            connect_grid(grids_[f], grids_[f].first_vertex, rows_of(f),
                         [&](u32, u32 a, u32 b, u32 c) { add(a, b, c); });
        }
        for (std::size_t e = 0; e < strips_.size(); ++e) {
            const EdgeTets& edge = structure_.edges[e];
            if (edge.is_border()) continue;
            const unsigned fan = strips_[e].fan;
            for (std::size_t s = 0; s <= strips_[e].samples.size(); ++s)
                for (unsigned k = 0; k < fan; ++k) {
                    patch_ = edge.triangles[2 * k >= fan];
                    const u32 a = row_vertex(e, s, k), b = row_vertex(e, s, k + 1), c = row_vertex(e, s + 1, k + 1),
                              d = row_vertex(e, s + 1, k);
                    add(a, b, c);
                    add(a, c, d);
                }
        }
    }

    void add(u32 a, u32 b, u32 c) {
        if (a == b || b == c || c == a) return;
        out_.push_back({a, b, c});
        out_patches_.push_back(patch_);
        out_sides_.push_back(std::min({points_[a].side, points_[b].side, points_[c].side}));
    }

    TriangleMesh finished() {
        TriangleMesh mesh;
        mesh.frame = patches_.frame;
        Array<Vec3> positions(points_.size());
        Array<double> normals(3 * points_.size());
        for (std::size_t v = 0; v < points_.size(); ++v) {
            positions[v] = points_[v].position;
            for (std::size_t i = 0; i < 3; ++i) normals[3 * v + i] = points_[v].normal[static_cast<Eigen::Index>(i)];
        }
        mesh.positions = std::move(positions);
        mesh.triangles = std::move(out_);
        mesh.vertex_columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
        mesh.face_columns.add(Column("patch", 1, Buffer<u32>(std::move(out_patches_))));
        mesh.face_columns.add(Column("side", 1, Buffer<u8>(std::move(out_sides_))));
        return mesh;
    }

    const PatchComplex& patches_;
    unsigned subdivision_;
    std::optional<double> max_error_;
    const std::function<unsigned(Edge)>& segments_;
    Execution& execution_;
    PatchStructure structure_;
    double zero_ = 0;  ///< values up to it are 0
    std::vector<Strip> strips_;
    std::vector<Grid> grids_;
    std::vector<u32> number_of_corner_;  ///< by point of the complex
    u32 corners_ = 0;
    std::vector<SurfacePoint> points_;  ///< of the corners and strips; at last of the grids, too
    u32 patch_ = 0;  ///< of the triangles that are being added
    Array<Triangle> out_;
    Array<u32> out_patches_;
    Array<u8> out_sides_;
};

}  // namespace

TriangleMesh tessellate(const PatchComplex& patches, const TessellateParams& params, Execution& execution) {
    return Tessellation(patches, params, execution).mesh();
}

}  // namespace scanmill
