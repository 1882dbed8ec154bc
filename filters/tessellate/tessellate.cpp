// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/tessellate.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/bounds.hpp"
#include "tessellate/strip.hpp"

namespace scanmill {

namespace {

using namespace tessellation;

constexpr std::size_t chunk = 64;  // edges or triangles
constexpr unsigned uniform_fan = 4, least_fan = 2;  // segments of a fan
constexpr unsigned most_subdivision = 1024;
constexpr unsigned length_steps = 8;
constexpr double rounding = 1e-14;  // of the diagonal: below it a value at a point of the mesh is 0

/// Vertices along an edge or inside a triangle, with their shares of the way.
struct Row {
    std::vector<u32> vertices;
    std::vector<double> shares;
    std::vector<double> insets{};  ///< on an edge: Sample::inset
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

/// By side, the outer one first, and third.
using Cells = std::vector<TetFunctions>;

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
    void build_strip(std::size_t e, unsigned most) {
        const EdgeTets& edge = structure_.edges[e];
        Strip& strip = strips_[e];
        const bool is_fixed = segments_ || !max_error_;
        strip.segments = segments_    ? std::clamp(segments_(make_edge(edge.a, edge.b)), 1u, most_subdivision)
                         : max_error_ ? 1
                                      : most;
        strip.fan = edge.is_border() ? 0 : is_fixed ? uniform_fan : least_fan;
        tessellation::build(strip, patches_, structure_, edge, zero_, is_fixed ? std::nullopt : max_error_, most);
    }

    // Grids.

    u32 row_vertex(std::size_t e, std::size_t s, unsigned k) const {
        const EdgeTets& edge = structure_.edges[e];
        const Strip& strip = strips_[e];
        if (s == 0) return number_of_corner_[edge.a];
        if (s > strip.samples.size()) return number_of_corner_[edge.b];
        return strip.first_vertex + strip.number(s - 1, k);
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
                const bool is_end = n == 0 || n == last;
                rows[i].shares.push_back(n == 0 ? 0 : n == last ? 1 : strip.samples[s - 1].share[is_first ? 0 : 1]);
                rows[i].insets.push_back(is_end ? 0 : strip.samples[s - 1].inset[is_first ? 0 : 1]);
            }
        }
        return rows;
    }

    void build_grid(std::size_t f, unsigned most) {
        const TriangleTets& t = structure_.triangles[f];
        Grid& grid = grids_[f];
        Cells cells;  // the outer ones first
        for (const std::size_t side : {1, 0})
            for (u32 third = 0; third < t.count; ++third) cells.emplace_back(patches_, t.rows[side][third]);
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
            lift(grid, t, cells, edges);
            if (is_fixed) return;
            const Errors errors = errors_of(grid, t, cells, edges);
            grid.worst = errors.worst();
            if (grid.is_triangular) {
                if (grid.worst <= *max_error_) return;
                grid.is_triangular = false;
            } else if (!refine(grid.segments, grid.rows, errors, *max_error_, most, most)) {
                return;
            }
        }
    }

    /// Lengths on the surface above the lines from the base point to the corners, at equal steps, of the longest line
    /// each. Towards the corners the lines to the apex make a small angle with the surface, so the steps grow.
    std::vector<double> lengths_to_corners(const TriangleTets& t, const Cells& cells) const {
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

    Errors errors_of(const Grid& grid, const TriangleTets& t, const Cells& cells,
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
                const bool is_outer = cells[part].own().coordinates(x)[3] >= 0;
                return std::abs(cells[is_outer ? part : t.count + part].own().first_order_distance(x));
            };
            errors.along = std::max(errors.along, distance_on_segment(p, q, at));
            errors.inside = std::max(
                {errors.inside, distance_on_segment(q, r, at), distance_on_segment(r, p, at), at((p + q + r) / 3)});
        });
        return errors;
    }

    template <class Add>
    static void connect_grid(const Grid& grid, u32 first, const std::array<Row, 3>& edges, Add&& add) {
        grid.is_triangular ? connect_triangular(grid, first, edges, add) : connect_thirds(grid, first, edges, add);
    }

    /// Above a point of a triangle, given by its coordinates in a third: base point, corners i and j; or in an
    /// undivided triangle.
    SurfacePoint above(const Cells& cells, u32 third, const Vec3& base) const {
        const Barycentric from(base[0], base[1], base[2], 0);
        const u8 side = cells[third].side_at(from, zero_);
        return cells[side == 1 ? third : cells.size() / 2 + third].hit(side, from, corner(3), zero_).point;
    }

    /// Above the point of a third at `share` of the way from the base point, or the centre of an undivided triangle, to
    /// the point at `along` of the edge.
    SurfacePoint above(const TriangleTets& t, const Cells& cells, u32 third, double share, double along) const {
        const double i = share * (1 - along), j = share * along;
        if (t.count == 3) return above(cells, third, {1 - share, i, j});
        Vec3 base = Vec3::Constant((1 - share) / 3);
        base[third] += i;
        base[(third + 1) % 3] += j;
        return above(cells, 0, base);
    }

    /// How far the crease reaches into a triangle at this share of the edge.
    static double inset_at(const Row& edge, double along) {
        const auto next =
            std::max<std::ptrdiff_t>(1, std::ranges::lower_bound(edge.shares, along) - edge.shares.begin());
        const auto j = static_cast<std::size_t>(next), i = j - 1;
        const double part = (along - edge.shares[i]) / (edge.shares[j] - edge.shares[i]);
        return (1 - part) * edge.insets[i] + part * edge.insets[j];
    }

    void lift(Grid& grid, const TriangleTets& t, const Cells& cells, const std::array<Row, 3>& edges) const {
        const u32 n = grid.segments;
        if (!grid.is_triangular) {
            const ThirdsNumbers numbers(grid);
            grid.points.resize(numbers.count());
            for (u32 third = 0; third < 3; ++third)
                for (u32 r = third == 0 ? 0 : 1; r < grid.rows; ++r) {
                    const u32 count = std::max(grid.segments_of(r), 1u);
                    for (u32 k = 0; k < count; ++k) {
                        const double along = static_cast<double>(k) / count;
                        grid.points[numbers(third, r, k)] =
                            above(t, cells, third, grid.shares[r] * (1 - inset_at(edges[third], along)), along);
                    }
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
        corner_normals_.resize(structure_.triangles.size());
        for (std::size_t f = 0; f < structure_.triangles.size(); ++f) {
            const TriangleTets& t = structure_.triangles[f];
            for (u32 i = 0; i < 3; ++i) {
                const PatchCell here(patches_, t.rows[1][t.count == 3 ? i : 0]);
                const Vec3 normal = here.gradient(corner(t.count == 3 ? 1 : i)).normalized();
                corner_normals_[f][i] = normal;
                SurfacePoint& point = points_[number_of_corner_[t.corners[i]]];
                point.position = patches_.positions[t.corners[i]];
                point.normal = normal;
            }
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
        has_creases_ = std::ranges::any_of(structure_.edges, &EdgeTets::is_sharp);
        if (has_creases_) collect_creases();
        for (u32 f = 0; f < grids_.size(); ++f) {
            patch_ = f;
            connect_grid(grids_[f], grids_[f].first_vertex, rows_of(f),
                         [&](u32, u32 a, u32 b, u32 c) { add(a, b, c); });
        }
        for (std::size_t e = 0; e < strips_.size(); ++e) {
            const EdgeTets& edge = structure_.edges[e];
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

    /// The edges along creases, and the normals beyond them.
    void collect_creases() {
        beyond_.resize(points_.size());
        std::vector<bool> is_sharp(corners_, false);
        for (std::size_t e = 0; e < strips_.size(); ++e) {
            const EdgeTets& edge = structure_.edges[e];
            if (!edge.is_sharp) continue;
            const Strip& strip = strips_[e];
            for (std::size_t s = 0; s <= strip.samples.size(); ++s)
                creases_.push_back(make_edge(row_vertex(e, s, strip.fan / 2), row_vertex(e, s + 1, strip.fan / 2)));
            for (std::size_t i = 0; i < strip.points.size(); ++i)
                beyond_[strip.first_vertex + i] = {edge.triangles[1], strip.second_normals[i]};
            is_sharp[number_of_corner_[edge.a]] = is_sharp[number_of_corner_[edge.b]] = true;
        }
        std::ranges::sort(creases_);
        // The mean of the normals of the triangles at a vertex.
        for (u32 v = 0; v < corners_; ++v)
            if (is_sharp[v]) points_[v].normal = Vec3::Zero();
        for (std::size_t f = 0; f < structure_.triangles.size(); ++f)
            for (std::size_t i = 0; i < 3; ++i) {
                const u32 v = number_of_corner_[structure_.triangles[f].corners[i]];
                if (is_sharp[v]) points_[v].normal += corner_normals_[f][i];
            }
        for (u32 v = 0; v < corners_; ++v)
            if (is_sharp[v]) points_[v].normal.normalize();
    }

    void add(u32 a, u32 b, u32 c) {
        if (a == b || b == c || c == a) return;
        out_.push_back({a, b, c});
        out_patches_.push_back(patch_);
        out_sides_.push_back(std::min({points_[a].side, points_[b].side, points_[c].side}));
        if (!has_creases_) return;
        for (const u32 v : {a, b, c}) {
            const Vec3 normal = normal_at(v);
            out_normals_.insert(out_normals_.end(), normal.data(), normal.data() + 3);
        }
    }

    /// The normal at a vertex of a triangle that is being added, on its side of creases.
    Vec3 normal_at(u32 vertex) const {
        if (vertex < corners_) {
            const auto& corners = structure_.triangles[patch_].corners;
            for (std::size_t i = 0; i < 3; ++i)
                if (number_of_corner_[corners[i]] == vertex) return corner_normals_[patch_][i];
        }
        const Beyond& beyond = beyond_[vertex];
        return beyond.triangle == patch_ && !beyond.normal.isZero(0) ? beyond.normal : points_[vertex].normal;
    }

    TriangleMesh finished() {
        TriangleMesh mesh;
        mesh.frame = patches_.frame;
        Array<Vec3> positions(points_.size());
        Array<double> normals(3 * points_.size());
        for (std::size_t v = 0; v < points_.size(); ++v) {
            positions[v] = points_[v].position;
            const Vec3 normal = has_creases_ && !beyond_[v].normal.isZero(0)
                                    ? (points_[v].normal + beyond_[v].normal).normalized()
                                    : points_[v].normal;
            for (std::size_t i = 0; i < 3; ++i) normals[3 * v + i] = normal[static_cast<Eigen::Index>(i)];
        }
        mesh.positions = std::move(positions);
        mesh.triangles = std::move(out_);
        mesh.sharp_edges = std::move(creases_);
        mesh.vertex_columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
        mesh.face_columns.add(Column("patch", 1, Buffer<u32>(std::move(out_patches_))));
        mesh.face_columns.add(Column("side", 1, Buffer<u8>(std::move(out_sides_))));
        if (has_creases_) mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(out_normals_))));
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
    std::vector<std::array<Vec3, 3>> corner_normals_;  ///< of the mesh's triangles
    bool has_creases_ = false;
    struct Beyond {
        u32 triangle = none;  ///< the second triangle at a crease
        Vec3 normal = Vec3::Zero();
    };
    std::vector<Beyond> beyond_;  ///< by point
    Array<Edge> creases_;
    u32 patch_ = 0;  ///< of the triangles that are being added
    Array<double> out_normals_;
    Array<Triangle> out_;
    Array<u32> out_patches_;
    Array<u8> out_sides_;
};

}  // namespace

TriangleMesh tessellate(const PatchComplex& patches, const TessellateParams& params, Execution& execution) {
    return Tessellation(patches, params, execution).mesh();
}

}  // namespace scanmill
