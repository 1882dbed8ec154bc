// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/tessellate.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/a_patch.hpp"

namespace scanmill {

namespace {

constexpr u32 none = ~u32(0);
constexpr std::size_t chunk = 256;  // edges or triangles
constexpr unsigned uniform_fan = 4;  // segments of a fan
constexpr unsigned most_subdivision = 1024;

/// A point of the surface.
struct SurfacePoint {
    Vec3 position, normal;
    u8 side;
};

/// The tetrahedra of a mesh triangle: per side one, or three around the base point.
struct TriangleTets {
    std::array<std::array<u32, 3>, 2> rows{{{none, none, none}, {none, none, none}}};
    u32 count = 0;                              ///< per side
    std::array<u32, 3> corners{};               ///< vertices of the mesh
    std::array<u32, 3> edges{none, none, none};  ///< edge i goes from corner i to the next; into Tessellation::edges_
};

/// The tetrahedra beside an edge a → b of its first triangle.
struct EdgeTets {
    u32 a = none, b = none;
    std::array<u32, 2> triangles{none, none};
    std::array<std::array<u32, 2>, 2> rows{{{none, none}, {none, none}}};  ///< by side and triangle
    unsigned segments = 1, fan = 1;
    /// The first vertex of inner samples 1 … segments - 1, and one more. A sample on the surface has one vertex, others
    /// one per column.
    std::vector<u32> first_of_sample{};

    bool is_border() const { return triangles[1] == none; }
    unsigned columns() const { return is_border() ? 1 : fan + 1; }
    bool is_collapsed(unsigned sample) const { return first_of_sample[sample] - first_of_sample[sample - 1] == 1; }
};

struct HalfEdge {
    Edge edge;
    u32 triangle, corner;
    auto operator<=>(const HalfEdge&) const = default;
};

Barycentric corner(int i) {
    Barycentric at = Barycentric::Zero();
    at[i] = 1;
    return at;
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
    const Vec3 d = b - a;
    const double length = d.squaredNorm(), t = length > 0 ? std::clamp((p - a).dot(d) / length, 0.0, 1.0) : 0;
    return (p - a - t * d).norm();
}

class Tessellation {
public:
    Tessellation(const PatchComplex& patches, const TessellateParams& params, Execution& execution)
        : patches_(patches),
          subdivision_(params.subdivision),
          max_error_(params.max_error ? std::optional(params.max_error->value()) : std::nullopt),
          execution_(execution) {
        if (subdivision_ < 1 || subdivision_ > most_subdivision)
            throw Error("subdivision must be from 1 to {}; it is {}", most_subdivision, subdivision_);
        if (max_error_ && !(*max_error_ > 0)) throw Error("max-error must be above 0; it is {:g}", *max_error_);
    }

    TriangleMesh mesh() {
        collect();
        max_error_ ? choose_levels() : set_levels();
        number_vertices();
        lift_edges();
        lift_triangles();
        connect();
        return finished();
    }

private:
    // The structure of the complex.

    void collect() {
        if (patches_.tets.empty()) throw Error("the patches have no tetrahedra");
        const std::size_t rows = patches_.tets.size();
        u32 triangles = 0;
        for (std::size_t row = 0; row < rows; ++row) {
            if (patches_.triangles[row] >= rows) throw_incomplete(patches_.triangles[row]);
            triangles = std::max(triangles, patches_.triangles[row] + 1);
        }
        triangles_.resize(triangles);
        for (u32 row = 0; row < rows; ++row) {
            if (patches_.kinds[row] != PatchKind::face) continue;
            auto& of_side = triangles_[patches_.triangles[row]].rows[patches_.sides[row]];
            const auto free = std::ranges::find(of_side, none);
            if (free == of_side.end()) throw_incomplete(patches_.triangles[row]);
            *free = row;
        }
        for (u32 f = 0; f < triangles_.size(); ++f) {
            TriangleTets& t = triangles_[f];
            t.count = t.rows[1][1] == none ? 1 : 3;
            for (const auto& of_side : t.rows)
                if (std::ranges::count(of_side, none) != 3 - t.count) throw_incomplete(f);
            for (std::size_t i = 0; i < 3; ++i)
                t.corners[i] = t.count == 3 ? patches_.tets[t.rows[1][i]][1] : patches_.tets[t.rows[1][0]][i];
        }
        collect_edges();
    }

    [[noreturn]] static void throw_incomplete(u32 triangle) {
        throw Error("the patches are not complete: tetrahedra of triangle {} are missing or too many", triangle)
            .hint("'a-patch' makes complete ones");
    }

    void collect_edges() {
        std::vector<HalfEdge> halves;
        for (u32 f = 0; f < triangles_.size(); ++f)
            for (u32 i = 0; i < 3; ++i)
                halves.push_back({make_edge(triangles_[f].corners[i], triangles_[f].corners[(i + 1) % 3]), f, i});
        std::ranges::sort(halves);
        for (std::size_t h = 0; h < halves.size(); ++h) {
            const bool is_second = h > 0 && halves[h - 1].edge == halves[h].edge;
            if (h > 1 && halves[h - 2].edge == halves[h].edge) throw_incomplete(halves[h].triangle);
            if (!is_second) edges_.emplace_back();
            EdgeTets& edge = edges_.back();
            edge.triangles[is_second] = halves[h].triangle;
            triangles_[halves[h].triangle].edges[halves[h].corner] = static_cast<u32>(edges_.size() - 1);
            if (is_second) continue;
            edge.a = triangles_[halves[h].triangle].corners[halves[h].corner];
            edge.b = triangles_[halves[h].triangle].corners[(halves[h].corner + 1) % 3];
        }
        for (u32 row = 0; row < patches_.tets.size(); ++row) {
            if (patches_.kinds[row] != PatchKind::edge) continue;
            const TriangleTets& t = triangles_[patches_.triangles[row]];
            const auto i =
                static_cast<std::size_t>(std::ranges::find(t.corners, patches_.tets[row][1]) - t.corners.begin());
            if (i == t.corners.size()) throw_incomplete(patches_.triangles[row]);
            EdgeTets& edge = edges_[t.edges[i]];
            edge.rows[patches_.sides[row]][edge.triangles[1] == patches_.triangles[row]] = row;
        }
        for (const EdgeTets& edge : edges_)
            for (const auto& of_side : edge.rows)
                if (!edge.is_border() && std::ranges::find(of_side, none) != of_side.end())
                    throw_incomplete(edge.triangles[0]);
    }

    // Points of the surface.

    SurfacePoint hit(u32 row, const Barycentric& from, const Barycentric& to) const {
        const PatchWeights& weights = patches_.weights[row];
        const std::optional<double> t = patch_hit(weights, from, to);
        if (!t) throw Error("the patch of triangle {} has no surface above a point of it", patches_.triangles[row]);
        const Barycentric at = (1 - *t) * from + *t * to;
        const PatchCell cell(patches_, row);
        return {cell.point(at), cell.gradient(at).normalized(), patches_.sides[row]};
    }

    /// The side on which the surface is seen from a point of the mesh.
    u8 side_at(u32 row, const Barycentric& base) const { return patch_value(patches_.weights[row], base) <= 0; }

    /// Above the point with these coordinates in part `third` of a triangle: base point, corners i and j; of an
    /// undivided triangle: its three corners.
    SurfacePoint above(const TriangleTets& t, std::size_t third, const Vec3& base) const {
        const Barycentric from(base[0], base[1], base[2], 0);
        const u8 side = side_at(t.rows[1][third], from);
        return hit(t.rows[side][third], from, corner(3));
    }

    /// Above the point at `share` of the edge, at `across` of the fan from the first triangle to the second.
    SurfacePoint beside(const EdgeTets& edge, double share, double across) const {
        const TriangleTets& first = triangles_[edge.triangles[0]];
        const auto i = static_cast<std::size_t>(
            std::ranges::find(first.edges, static_cast<u32>(&edge - edges_.data())) - first.edges.begin());
        if (edge.is_border()) {
            Vec3 base = Vec3::Zero();
            if (first.count == 3) return above(first, i, {0, 1 - share, share});
            base[static_cast<Eigen::Index>(i)] = 1 - share;
            base[static_cast<Eigen::Index>((i + 1) % 3)] = share;
            return above(first, 0, base);
        }
        const u8 side = side_at(edge.rows[1][0], {0, 1 - share, share, 0});
        const std::size_t of = across > 0.5;
        const double u = of == 0 ? 2 * across : 2 * (1 - across);  // 0: the apex, 1: the edge point
        const Barycentric from = of == 0 ? Barycentric(0, 1 - share, share, 0) : Barycentric(0, share, 1 - share, 0);
        return hit(edge.rows[side][of], from, {u, 0, 0, 1 - u});
    }

    // Levels.

    void set_levels() {
        for (EdgeTets& edge : edges_) {
            edge.segments = subdivision_;
            edge.fan = uniform_fan;
        }
        levels_.assign(triangles_.size(), subdivision_);
    }

    void choose_levels() {
        const unsigned most = std::bit_floor(subdivision_);
        const double worst = choose_levels(most);
        if (worst <= *max_error_) return;
        unsigned enough = 2 * most;
        while (enough <= most_subdivision && choose_levels(enough) > *max_error_) enough *= 2;
        Error error("with {} segments per edge the triangles are up to {:.3g} from the surface; max-error is {:.3g}",
                    most, worst, *max_error_);
        error.set_hint(enough <= most_subdivision ? fmt::format("subdivision {} suffices", enough)
                                                  : fmt::format("not even subdivision {} suffices", most_subdivision));
        throw error;
    }

    /// Returns the distance that is left.
    double choose_levels(unsigned most) {
        std::vector<double> left(edges_.size(), 0.0), left_above(triangles_.size(), 0.0);
        for_each_chunk(execution_.threads(), edges_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (std::size_t e = begin; e < end; ++e) left[e] = choose_level(edges_[e], most);
        });
        levels_.assign(triangles_.size(), 1);
        for_each_chunk(execution_.threads(), triangles_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (std::size_t f = begin; f < end; ++f) left_above[f] = choose_level(f, most);
        });
        return std::max(std::ranges::max(left), std::ranges::max(left_above));
    }

    /// Returns the distance that is left.
    double choose_level(EdgeTets& edge, unsigned most) const {
        const double wanted = *max_error_;
        edge.segments = 1;
        edge.fan = edge.is_border() ? 1 : 2;
        for (;;) {
            double along = 0, across = 0;
            const auto at = [&](double s, double k) {
                if (s == 0) return patches_.positions[edge.a];
                if (s == edge.segments) return patches_.positions[edge.b];
                return beside(edge, s / edge.segments, edge.is_border() ? 0 : k / edge.fan).position;
            };
            for (unsigned s = 0; s < edge.segments; ++s)
                for (unsigned k = 0; k < edge.columns(); ++k) {
                    const Vec3 here = at(s + 0.5, k);
                    along = std::max(along, distance_to_segment(here, at(s, k), at(s + 1, k)));
                    if (k + 1 < edge.columns())
                        across = std::max(across, distance_to_segment(at(s + 0.5, k + 0.5), here, at(s + 0.5, k + 1)));
                }
            const bool is_long = along > wanted && edge.segments<most, is_wide = across> wanted && edge.fan < most;
            if (!is_long && !is_wide) return std::max(along, across);
            if (is_long) edge.segments *= 2;
            if (is_wide) edge.fan *= 2;
        }
    }

    double choose_level(std::size_t f, unsigned most) {
        const TriangleTets& t = triangles_[f];
        unsigned& level = levels_[f];
        for (const u32 e : t.edges) level = std::max(level, edges_[e].segments);
        for (;; level *= 2) {
            double worst = 0;
            for (std::size_t third = 0; third < t.count; ++third) {
                const auto at = [&](double i, double j) {
                    return above(t, third, Vec3(level - i - j, i, j) / level).position;
                };
                const auto measure = [&](double i, double j, double step) {
                    const Vec3 a = at(i, j), b = at(i + step, j), c = at(i, j + step);
                    const double half = step / 2, part = step / 3;
                    worst = std::max({worst, above_plane(at(i + part, j + part), a, b, c),
                                      distance_to_segment(at(i + half, j), a, b),
                                      distance_to_segment(at(i + half, j + half), b, c),
                                      distance_to_segment(at(i, j + half), c, a)});
                };
                for (unsigned i = 0; i < level; ++i)
                    for (unsigned j = 0; i + j < level; ++j) {
                        measure(i, j, 1);
                        if (i + j + 2 <= level) measure(i + 1, j + 1, -1);
                    }
            }
            if (worst <= *max_error_ || 2 * level > most) return worst;
        }
    }

    static double above_plane(const Vec3& p, const Vec3& a, const Vec3& b, const Vec3& c) {
        const Vec3 normal = (b - a).cross(c - a);
        const double length = normal.norm();
        return length > 0 ? std::abs(normal.dot(p - a)) / length : (p - a).norm();
    }

    // Vertices.

    /// Inner vertices of a triangle: divided, the base point, the inner points of the three lines to the corners, and
    /// those of the thirds; undivided, the inner points of its grid, or its middle if there are none.
    u32 inner_vertices(std::size_t f) const {
        const u32 n = levels_[f];
        if (triangles_[f].count == 3) return 1 + 3 * (n - 1) + 3 * ((n - 1) * (n - 2) / 2);
        return n == 1 ? 0 : n == 2 ? 1 : (n - 1) * (n - 2) / 2;
    }

    void number_vertices() {
        number_of_vertex_.assign(patches_.positions.size(), none);
        for (const TriangleTets& t : triangles_)
            for (const u32 v : t.corners) number_of_vertex_[v] = 0;
        u32 count = 0;
        for (u32& number : number_of_vertex_)
            if (number != none) number = count++;
        std::size_t next = count;
        for (EdgeTets& edge : edges_) {
            edge.first_of_sample = {static_cast<u32>(next)};
            for (unsigned s = 1; s < edge.segments; ++s) {
                const double share = static_cast<double>(s) / edge.segments;
                const bool is_on_surface =
                    !edge.is_border() && patch_value(patches_.weights[edge.rows[1][0]], {0, 1 - share, share, 0}) == 0;
                next += is_on_surface ? 1 : edge.columns();
                edge.first_of_sample.push_back(static_cast<u32>(next));
            }
        }
        for (std::size_t f = 0; f < triangles_.size(); ++f) {
            first_inner_.push_back(static_cast<u32>(next));
            next += inner_vertices(f);
        }
        if (next >= none) throw Error("the mesh would have {} vertices; at most {} are possible", next, none - 1);
        points_.resize(next);
        for (u32 f = 0; f < triangles_.size(); ++f)
            for (u32 i = 0; i < 3; ++i) {
                const u32 v = triangles_[f].corners[i];
                SurfacePoint& point = points_[number_of_vertex_[v]];
                const u32 row = triangles_[f].rows[1][triangles_[f].count == 3 ? i : 0];
                const int at = triangles_[f].count == 3 ? 1 : static_cast<int>(i);
                point = {patches_.positions[v], PatchCell(patches_, row).gradient(corner(at)).normalized(), 1};
            }
    }

    /// The vertex at sample s and column k of the fan; column 0 belongs to the first triangle.
    u32 vertex(const EdgeTets& edge, unsigned s, unsigned k) const {
        if (s == 0) return number_of_vertex_[edge.a];
        if (s == edge.segments) return number_of_vertex_[edge.b];
        return edge.first_of_sample[s - 1] + (edge.is_collapsed(s) ? 0 : k);
    }

    void lift_edges() {
        for_each_chunk(execution_.threads(), edges_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (std::size_t e = begin; e < end; ++e)
                for (unsigned s = 1; s < edges_[e].segments; ++s)
                    for (unsigned k = 0; k < edges_[e].columns(); ++k)
                        points_[vertex(edges_[e], s, k)] =
                            beside(edges_[e], static_cast<double>(s) / edges_[e].segments,
                                   edges_[e].is_border() ? 0 : static_cast<double>(k) / edges_[e].fan);
        });
    }

    /// The inner vertex of third `third` in row r = 1 … n - 1 (0: the base point), at k = 0 … r between the lines to
    /// its two corners.
    u32 third_vertex(std::size_t f, u32 third, u32 r, u32 k) const {
        const u32 n = levels_[f], first = first_inner_[f];
        if (r == 0) return first;
        if (k == 0) return first + 1 + third * (n - 1) + r - 1;
        if (k == r) return first + 1 + (third + 1) % 3 * (n - 1) + r - 1;
        return first + 1 + 3 * (n - 1) + third * ((n - 1) * (n - 2) / 2) + (r - 1) * (r - 2) / 2 + k - 1;
    }

    /// The inner vertex of an undivided triangle of level n >= 3, with so many steps from corner 0 to corners 1 and 2.
    u32 grid_vertex(std::size_t f, u32 i, u32 j) const {
        return first_inner_[f] + (i + j - 1) * (i + j - 2) / 2 + j - 1;
    }

    void lift_triangles() {
        for_each_chunk(execution_.threads(), triangles_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (std::size_t f = begin; f < end; ++f) {
                const TriangleTets& t = triangles_[f];
                const u32 n = levels_[f];
                if (t.count == 3) {
                    for (u32 third = 0; third < 3; ++third)
                        for (u32 r = third == 0 ? 0 : 1; r < n; ++r)
                            for (u32 k = 0; k < std::max(r, 1u); ++k)
                                points_[third_vertex(f, third, r, k)] = above(t, third, Vec3(n - r, r - k, k) / n);
                } else if (n == 2) {
                    points_[first_inner_[f]] = above(t, 0, Vec3::Constant(1. / 3));
                } else {
                    for (u32 i = 1; i < n; ++i)
                        for (u32 j = 1; i + j < n; ++j)
                            points_[grid_vertex(f, i, j)] = above(t, 0, Vec3(n - i - j, i, j) / n);
                }
            }
        });
    }

    // Triangles.

    void connect() {
        for (u32 f = 0; f < triangles_.size(); ++f) {
            patch_ = f;
            triangles_[f].count == 3 ? connect_thirds(f) : connect_whole(f);
        }
        for (const EdgeTets& edge : edges_) {
            if (edge.is_border()) continue;
            for (unsigned s = 0; s < edge.segments; ++s)
                for (unsigned k = 0; k < edge.fan; ++k) {
                    patch_ = edge.triangles[2 * k >= edge.fan];
                    const u32 a = vertex(edge, s, k), b = vertex(edge, s, k + 1), c = vertex(edge, s + 1, k + 1),
                              d = vertex(edge, s + 1, k);
                    add(a, b, c);
                    add(a, c, d);
                }
        }
    }

    /// The samples on edge i of triangle f, from its corner i to the next.
    std::vector<u32> row_of_edge(u32 f, std::size_t i) const {
        const EdgeTets& edge = edges_[triangles_[f].edges[i]];
        const bool is_first = edge.triangles[0] == f;
        std::vector<u32> row;
        for (unsigned s = 0; s <= edge.segments; ++s)
            row.push_back(vertex(edge, is_first ? s : edge.segments - s, is_first ? 0 : edge.columns() - 1));
        return row;
    }

    void connect_thirds(u32 f) {
        const u32 n = levels_[f];
        for (u32 third = 0; third < 3; ++third) {
            const auto at = [&](u32 r, u32 k) { return third_vertex(f, third, r, k); };
            std::vector<u32> row;
            for (u32 r = 0; r + 1 < n; ++r)
                for (u32 k = 0; k <= r; ++k) {
                    add(at(r, k), at(r + 1, k), at(r + 1, k + 1));
                    if (k < r) add(at(r, k), at(r + 1, k + 1), at(r, k + 1));
                }
            for (u32 k = 0; k < n; ++k) row.push_back(at(n - 1, k));
            join(row_of_edge(f, third), row);
        }
    }

    void connect_whole(u32 f) {
        const u32 n = levels_[f];
        if (n == 1) {
            add(row_of_edge(f, 0)[0], row_of_edge(f, 1)[0], row_of_edge(f, 2)[0]);
            return;
        }
        for (std::size_t i = 0; i < 3; ++i) {
            std::vector<u32> row;  // of inner vertices, along edge i
            if (n <= 3)
                row.push_back(first_inner_[f]);
            else
                for (u32 k = 1; k + 1 < n; ++k)
                    row.push_back(i == 0   ? grid_vertex(f, k, 1)
                                  : i == 1 ? grid_vertex(f, n - 1 - k, k)
                                           : grid_vertex(f, 1, n - 1 - k));
            join(row_of_edge(f, i), row);
        }
        for (u32 i = 1; i + 2 < n; ++i)
            for (u32 j = 1; i + j + 1 < n; ++j) {
                add(grid_vertex(f, i, j), grid_vertex(f, i + 1, j), grid_vertex(f, i, j + 1));
                if (i + j + 2 < n)
                    add(grid_vertex(f, i + 1, j), grid_vertex(f, i + 1, j + 1), grid_vertex(f, i, j + 1));
            }
    }

    /// Triangles between a row on an edge and a row inside the triangle, both in the edge's direction: the row with the
    /// smaller next share goes on, the edge's if they are equal.
    void join(const std::vector<u32>& edge, const std::vector<u32>& inner) {
        std::size_t i = 0, j = 0;
        const std::size_t edges = edge.size() - 1, inners = inner.size() - 1;
        while (i < edges || j < inners)
            if (i < edges && (j == inners || (i + 1) * inners <= (j + 1) * edges)) {
                add(edge[i], edge[i + 1], inner[j]);
                ++i;
            } else {
                add(edge[i], inner[j + 1], inner[j]);
                ++j;
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
    Execution& execution_;
    std::vector<TriangleTets> triangles_;
    std::vector<EdgeTets> edges_;
    std::vector<unsigned> levels_;  ///< of triangles
    std::vector<u32> number_of_vertex_, first_inner_;
    std::vector<SurfacePoint> points_;
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
