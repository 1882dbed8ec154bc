// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/weights.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <atomic>

#include "scanmill/base/parallel.hpp"

namespace scanmill::a_patches {

namespace {

using Vector4 = Eigen::Vector4d;

constexpr std::size_t chunk = 1024;  // faces or edges
constexpr double least_share = 0.1;  // smallest ratio of a weight to the weight that is next nearer to the mesh
constexpr double least_share_of_edge = 0.2;
constexpr double rounding = 1e-15;  // share of the largest weight; weights at singular points are 0

/// One side of a face. An affine function on its tetrahedron is given by its values at the three corners and the apex.
struct FaceSide {
    Vec3 apex;
    std::array<Vector4, 3> m;  ///< f(v, apex, .)
    Vector4 n;                 ///< f(apex, apex, .)
    /// At edge i: the midpoint of the two apexes. At a sharp edge: the other triangle's apex. On the boundary: this
    /// apex.
    std::array<Vec3, 3> edge_point{};
    std::array<Vector4, 3> at_edge_point;  ///< barycentric coordinates of the edge points
    Eigen::Matrix3d curvature;
};

class WeightsBuilder {
public:
    WeightsBuilder(const Hull& hull, Curvature curvature, Execution& execution)
        : hull_(hull),
          curvature_(curvature),
          execution_(execution) {}

    Weights weights() {
        number_vertices();
        for (auto& sides : sides_) sides.resize(hull_.faces.size());
        for_each_chunk(execution_.threads(), hull_.faces.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            std::size_t raised = 0;
            for (std::size_t f = begin; f < end; ++f)
                for (const Side side : both_sides) raised += set_face(f, side);
            raised_ += raised;
        });
        for_each_chunk(execution_.threads(), hull_.faces.size(), chunk, [&](std::size_t begin, std::size_t end) {
            for (std::size_t f = begin; f < end; ++f)
                for (const Side side : both_sides) write_face(f, side);
        });
        for_each_chunk(execution_.threads(), hull_.edges.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            std::size_t raised = 0;
            for (std::size_t e = begin; e < end; ++e)
                if (hull_.edges[e].is_sharp)
                    write_sharp(e);
                else
                    for (const Side side : both_sides)
                        if (has_edge_point(e, side)) raised += write_edge(e, side);
            raised_ += raised;
        });
        Weights result;
        result.raised = raised_;
        PatchComplex& patches = result.patches;
        patches.positions = std::move(positions_);
        patches.tets = std::move(tets_);
        patches.weights = std::move(weights_);
        patches.kinds = std::move(kinds_);
        patches.sides = std::move(tet_sides_);
        patches.triangles = std::move(triangles_);
        patches.edges = std::move(edges_);
        patches.combine = std::move(combine_);
        patches.partners = std::move(partners_);
        return result;
    }

private:
    static constexpr std::size_t tets_per_side = 2, none_of_ends = 2;

    /// Numbers the vertices in this order: vertices of the mesh, base points of divided triangles, apexes, edge points.
    /// For each triangle or edge, the vertex inside precedes the one outside.
    void number_vertices() {
        const std::size_t faces = hull_.faces.size();
        std::size_t bases = hull_.positions.size();
        for (const HullFace& face : hull_.faces) {
            base_.push_back(static_cast<u32>(bases));
            bases += face.is_divided;
            first_row_.push_back(tets_of_faces_);
            tets_of_faces_ += face.is_divided ? 6 : 2;
        }
        first_apex_ = bases;
        first_edge_point_ = first_apex_ + 2 * faces;
        std::size_t points = 0, count = tets_of_faces_;
        for (std::size_t e = 0; e < hull_.edges.size(); ++e) {
            const HullEdge& edge = hull_.edges[e];
            row_of_edge_.push_back(count);
            edge_point_.push_back({});
            for (const Side side : both_sides) {
                if (has_edge_point(e, side)) edge_point_[e][side] = static_cast<u32>(points++);
                if (edge.second != HullEdge::none && edge.is_filled[side]) count += tets_per_side;
                if (edge.is_continued()) count += tets_per_side;
            }
        }
        positions_.resize(first_edge_point_ + points);
        std::ranges::copy(hull_.positions, positions_.begin());
        tets_.resize(count);
        weights_.resize(count);
        kinds_.resize(count);
        tet_sides_.resize(count);
        triangles_.resize(count);
        edges_.resize(count);
        combine_.resize(count, Combine::none);
        partners_.resize(count, PatchComplex::no_partner);
    }

    u32 apex_number(std::size_t f, Side side) const { return static_cast<u32>(first_apex_ + 2 * f + side); }
    u32 edge_point_number(std::size_t e, Side side) const {
        return static_cast<u32>(first_edge_point_ + edge_point_[e][side]);
    }

    /// Sets the free weights of a face's side, and the weights that follow from them. Returns the number of raised
    /// weights.
    std::size_t set_face(std::size_t f, Side side) {
        const HullFace& face = hull_.faces[f];
        const Triangle& t = hull_.triangles[f];
        const double sign = sign_of(side);
        FaceSide& out = sides_[side][f];
        out.apex = hull_.apex(f, side);
        out.curvature = face_curvature(hull_, f, curvature_);
        std::array<double, 3> at_apex, along_edge, free;
        double quadric = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 d = out.apex - hull_.positions[t[i]];
            quadric += (d.dot(hull_.normals[f][i]) + d.dot(out.curvature * d) / 2) / 3;
            at_apex[i] = hull_.at_corner(f, i, out.apex);
            along_edge[i] = hull_.at_edge(f, i, out.apex);
        }
        // If a corner has no normal, the quadric may have any value.
        if (std::ranges::find(hull_.normals[f], Vec3(Vec3::Zero())) != hull_.normals[f].end())
            quadric = sign * std::max(sign * quadric, least_share * face.height[side]);
        for (std::size_t i = 0; i < 3; ++i) free[i] = (quadric + 3 * at_apex[i]) / 3;
        double top = quadric;

        Eigen::Matrix3d corners;
        for (std::size_t i = 0; i < 3; ++i)
            corners.col(static_cast<Eigen::Index>(i)) = hull_.positions[t[i]] - out.apex;
        const Eigen::Matrix3d inverse = corners.inverse();
        for (std::size_t i = 0; i < 3; ++i) {
            const HullEdge& edge = hull_.edges[face.edges[i]];
            out.edge_point[i] = edge_point(edge, f, side);
            out.at_edge_point[i].head<3>() = inverse * (out.edge_point[i] - out.apex);
            out.at_edge_point[i][3] = 1 - out.at_edge_point[i].head<3>().sum();
        }

        std::size_t raised = 0;
        for (std::size_t v = 0; v < 3; ++v) raised += lift(free[v], least_share * at_apex[v], sign);
        raised += lift(top, least_share * (free[0] + free[1] + free[2]) / 3, sign);
        for (std::size_t v = 0; v < 3; ++v) {
            Vector4& m = out.m[v];
            m[static_cast<Eigen::Index>(v)] = at_apex[v];
            m[static_cast<Eigen::Index>(next(v))] = along_edge[v];
            m[static_cast<Eigen::Index>(previous(v))] = along_edge[previous(v)];
            m[3] = free[v];
            for (const std::size_t i : {v, previous(v)}) {
                if (!has_edge_point(face.edges[i], side)) continue;
                const double wanted =
                    least_share * (hull_.normals[f][v] == Vec3::Zero() ? hull_.at_edge(f, i, out.edge_point[i])
                                                                       : hull_.at_corner(f, v, out.edge_point[i]));
                raised += raise(m, out.at_edge_point[i], wanted, sign);
            }
            free[v] = m[3];
        }
        out.n = {free[0], free[1], free[2], top};
        const double wanted = least_share * (free[0] + free[1] + free[2]) / 3;
        for (std::size_t i = 0; i < 3; ++i)
            if (has_edge_point(face.edges[i], side)) raised += raise(out.n, out.at_edge_point[i], wanted, sign);
        return raised;
    }

    static std::size_t lift(double& value, double wanted, double sign) {
        if (sign * value >= sign * wanted) return 0;
        value = wanted;
        return 1;
    }

    /// Raises (on the inner side: lowers) the value at the apex until the function reaches `wanted` at the point.
    /// Returns the number of raised values, 0 or 1.
    static std::size_t raise(Vector4& values, const Vector4& at, double wanted, double sign) {
        const double missing = sign * (wanted - values.dot(at));
        if (missing <= 0 || at[3] <= 0) return 0;
        values[3] += sign * missing / at[3];
        return 1;
    }

    bool has_edge_point(std::size_t e, Side side) const {
        return hull_.edges[e].is_smooth() && hull_.edges[e].is_filled[side];
    }

    Vec3 edge_point(const HullEdge& edge, std::size_t f, Side side) const {
        if (edge.second == HullEdge::none) return hull_.apex(edge.first, side);
        if (edge.is_sharp) return hull_.apex(edge.first == f ? edge.second : edge.first, side);
        return (hull_.apex(edge.first, side) + hull_.apex(edge.second, side)) / 2;
    }

    void write_face(std::size_t f, Side side) {
        const HullFace& face = hull_.faces[f];
        const Triangle& t = hull_.triangles[f];
        const FaceSide& s = sides_[side][f];
        positions_[apex_number(f, side)] = s.apex;
        if (!face.is_divided) {
            write_undivided(f, side);
            return;
        }
        positions_[base_[f]] = face.base;
        const Vector4 base(face.share[0], face.share[1], face.share[2], 0);
        std::array<double, 3> m, k;
        for (std::size_t v = 0; v < 3; ++v) {
            m[v] = s.m[v].dot(base);
            Vector4 values;
            values[static_cast<Eigen::Index>(v)] = hull_.at_corner(f, v, face.base);
            values[static_cast<Eigen::Index>(next(v))] = hull_.at_edge(f, v, face.base);
            values[static_cast<Eigen::Index>(previous(v))] = hull_.at_edge(f, previous(v), face.base);
            values[3] = m[v];
            k[v] = values.dot(base);
        }
        const double n = s.n.dot(base), ss = Vector4(m[0], m[1], m[2], n).dot(base),
                     u = Vector4(k[0], k[1], k[2], ss).dot(base);
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t j = next(i), row = first_row_[f] + 3 * side + i;
            tets_[row] = {base_[f], t[i], t[j], apex_number(f, side)};
            weights_[row] =
                with_corners(f, s, i,
                             {u, k[i], k[j], ss, hull_.at_corner(f, i, face.base), hull_.at_edge(f, i, face.base), m[i],
                              hull_.at_corner(f, j, face.base), m[j], n});
            describe(row, PatchKind::face, side, f, PatchComplex::no_edge);
        }
    }

    void write_undivided(std::size_t f, Side side) {
        const Triangle& t = hull_.triangles[f];
        const FaceSide& s = sides_[side][f];
        const std::size_t row = first_row_[f] + side;
        tets_[row] = {t[0], t[1], t[2], apex_number(f, side)};
        // Corner 0 replaces the base point; the edge opposite to it is edge 1.
        weights_[row] =
            with_corners(f, s, 1,
                         {0, hull_.at_corner(f, 0, hull_.positions[t[1]]), hull_.at_corner(f, 0, hull_.positions[t[2]]),
                          s.m[0][0], hull_.at_corner(f, 1, hull_.positions[t[0]]), hull_.faces[f].middle, s.m[0][1],
                          hull_.at_corner(f, 2, hull_.positions[t[0]]), s.m[0][2], s.n[0]});
        describe(row, PatchKind::face, side, f, PatchComplex::no_edge);
    }

    /// Writes the tetrahedra beside a smooth edge. Returns the number of raised weights.
    std::size_t write_edge(std::size_t e, Side side) {
        const HullEdge& edge = hull_.edges[e];
        const double sign = sign_of(side);
        const std::size_t first = row_of_edge_[e] + (side == outside && has_edge_point(e, inside) ? tets_per_side : 0);
        const std::array<u32, 2> faces{edge.first, edge.second};
        std::array<std::size_t, 2> corner, number;  // by face: the corner at the edge's a, and the number of the edge
        for (std::size_t of = 0; of < 2; ++of) {
            number[of] = hull_.number_in(static_cast<u32>(e), faces[of]);
            corner[of] = of == 0 ? number[of] : next(number[of]);
        }
        const Vec3 x = sides_[side][edge.first].edge_point[number[0]];
        positions_[edge_point_number(e, side)] = x;
        const std::array<u32, 2> ends{edge.a, edge.b};
        std::array<std::array<double, 2>, 2> m;  // by face and end
        std::array<double, 2> n, quadratic{};
        for (std::size_t of = 0; of < 2; ++of) {
            const FaceSide& s = sides_[side][faces[of]];
            const Vector4& at = s.at_edge_point[number[of]];
            const std::size_t other = of == 0 ? next(corner[of]) : previous(corner[of]);
            m[of] = {s.m[corner[of]].dot(at), s.m[other].dot(at)};
            n[of] = s.n.dot(at);
        }
        for (std::size_t end = 0; end < 2; ++end) quadratic[end] = (m[0][end] + m[1][end]) / 2;
        const std::array<double, 2> at_end{hull_.at_corner(edge.first, number[0], x),
                                           hull_.at_corner(edge.first, next(number[0]), x)};
        double qxx = 0;
        for (std::size_t end = 0; end < 2; ++end) qxx += 1.5 * (quadratic[end] - at_end[end]);
        const double least = least_share_of_edge * std::min(sign * quadratic[0], sign * quadratic[1]);
        std::array<double, 2> r;
        std::size_t raised = 0;
        for (std::size_t of = 0; of < 2; ++of) {
            const double apex = sides_[side][faces[of]].n[3];
            r[of] = (qxx + 3 * n[of] - apex) / 3;
            if (sign * r[of] < least) {
                r[of] = sign * least;
                ++raised;
            }
        }
        for (std::size_t of = 0; of < 2; ++of) {
            const std::size_t f = faces[of], row = first + of;
            // Corners i and j are ordered as in the face's other tetrahedra.
            const std::size_t i = of == 0 ? 0 : 1, j = 1 - i;
            tets_[row] = {edge_point_number(e, side), ends[i], ends[j], apex_number(f, side)};
            weights_[row] =
                with_corners(f, sides_[side][f], number[of],
                             {(r[0] + r[1]) / 2, quadratic[i], quadratic[j], r[of], at_end[i],
                              hull_.at_edge(edge.first, number[0], x), m[of][i], at_end[j], m[of][j], n[of]});
            describe(row, PatchKind::edge, side, f, static_cast<u32>(e));
        }
        return raised;
    }

    // Sharp edges.

    /// The quadric of a face's side, continued beyond one of its edges. Its polar form is the mean of two polar forms;
    /// each has the value and the gradient of one end of the edge.
    struct Continuation {
        std::array<Vec3, 2> ends, normals;  ///< at the corner where the edge begins, and at the next one
        Eigen::Matrix3d curvature;

        double polar(const Vec3& x, const Vec3& y) const {
            double sum = 0;
            for (std::size_t end = 0; end < 2; ++end) {
                const Vec3 dx = x - ends[end], dy = y - ends[end];
                sum += ((dx + dy).dot(normals[end]) + dx.dot(curvature * dy)) / 4;
            }
            return sum;
        }
        double at_end(std::size_t end, const Vec3& x) const { return (x - ends[end]).dot(normals[end]) / 2; }
    };

    Continuation continuation(std::size_t f, std::size_t number, Side side) const {
        const Triangle& t = hull_.triangles[f];
        const std::size_t j = next(number);
        return {{hull_.positions[t[number]], hull_.positions[t[j]]},
                {hull_.normals[f][number], hull_.normals[f][j]},
                sides_[side][f].curvature};
    }

    void write_sharp(std::size_t e) {
        const HullEdge& edge = hull_.edges[e];
        const std::array<u32, 2> faces{edge.first, edge.second};
        std::size_t row = row_of_edge_[e];
        for (const Side side : both_sides) {
            if (edge.is_filled[side]) {
                for (std::size_t of = 0; of < 2; ++of)
                    write_gap(row + of, static_cast<u32>(e), faces[of], faces[1 - of], side);
                make_partners(row, row + 1, edge);
                row += 2;
            }
            if (!edge.is_continued()) continue;
            for (std::size_t of = 0; of < 2; ++of, ++row) {
                const std::size_t into = faces[1 - of];
                const std::size_t whole = first_row_[into] + 3 * side + hull_.number_in(static_cast<u32>(e), into);
                write_continuation(row, whole, static_cast<u32>(e), faces[of], into, side);
                make_partners(row, whole, edge);
            }
        }
    }

    void make_partners(std::size_t one, std::size_t other, const HullEdge& edge) {
        combine_[one] = combine_[other] = edge.is_convex ? Combine::max : Combine::min;
        partners_[one] = static_cast<u32>(other);
        partners_[other] = static_cast<u32>(one);
    }

    /// Writes the function of face f in the tetrahedron between the two apexes of a sharp edge.
    void write_gap(std::size_t row, u32 e, std::size_t f, std::size_t beyond, Side side) {
        const FaceSide& s = sides_[side][f];
        const Triangle& t = hull_.triangles[f];
        const std::size_t i = hull_.number_in(e, f), j = next(i);
        const Vec3& x = s.edge_point[i];
        const Vector4& at = s.at_edge_point[i];
        const Continuation quadric = continuation(f, i, side);
        const double q = quadric.polar(x, x), n = s.n.dot(at), qa = (3 * n - s.n[3]) / 2;
        const double at_i = hull_.at_corner(f, i, x), at_j = hull_.at_corner(f, j, x);
        tets_[row] = {apex_number(beyond, side), t[i], t[j], apex_number(f, side)};
        weights_[row] = with_corners(f, s, i,
                                     {q, (q + 3 * at_i) / 3, (q + 3 * at_j) / 3, (q + 2 * qa) / 3, at_i,
                                      hull_.at_edge(f, i, x), s.m[i].dot(at), at_j, s.m[j].dot(at), n});
        describe(row, PatchKind::sharp, side, f, e);
    }

    /// Writes the function of face f in a tetrahedron beside the edge: the tetrahedron `whole` of face `into`.
    void write_continuation(std::size_t row, std::size_t whole, u32 e, std::size_t f, std::size_t into, Side side) {
        const std::size_t number = hull_.number_in(e, f);
        const Continuation quadric = continuation(f, number, side);
        tets_[row] = tets_[whole];
        // The corners are base point, second end, first end, apex, because the edge has the opposite direction in
        // `into`.
        const std::array<Vec3, 4> x{hull_.faces[into].base, quadric.ends[1], quadric.ends[0], sides_[side][into].apex};
        const std::array<std::size_t, 4> end{none_of_ends, 1, 0, none_of_ends};
        const std::array<std::size_t, 2> corner{number, next(number)};
        const auto polar = [&](std::size_t a, std::size_t b) {
            if (end[a] != none_of_ends && end[b] != none_of_ends) return 0.0;
            if (end[a] != none_of_ends) return quadric.at_end(end[a], x[b]);
            return end[b] != none_of_ends ? quadric.at_end(end[b], x[a]) : quadric.polar(x[a], x[b]);
        };
        const auto weight = [&](std::size_t a, std::size_t b, std::size_t c) {
            // Finds two arguments that are ends of the edge: one end twice, or both ends.
            for (const auto& [u, v, w] : {std::array{a, b, c}, std::array{b, c, a}, std::array{a, c, b}}) {
                if (end[u] == none_of_ends || end[v] == none_of_ends) continue;
                return u == v ? hull_.at_corner(f, corner[end[u]], x[w]) : hull_.at_edge(f, number, x[w]);
            }
            return (polar(a, b) + polar(b, c) + polar(a, c)) / 3;
        };
        std::size_t next_weight = 0;
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = a; b < 4; ++b)
                for (std::size_t c = b; c < 4; ++c) weights_[row][next_weight++] = weight(a, b, c);
        describe(row, PatchKind::continuation, side, into, e);
    }

    /// Joins the ten weights of the first corner with the weights of corners i and j of edge i, and the apex.
    PatchWeights with_corners(std::size_t f, const FaceSide& s, std::size_t i, const std::array<double, 10>& first) {
        const Triangle& t = hull_.triangles[f];
        const std::size_t j = next(i);
        PatchWeights c;
        std::ranges::copy(first, c.begin());
        // Exactly 0, so that the function is exactly 0 on the edge.
        const bool is_straight = hull_.edges[hull_.faces[f].edges[i]].is_straight;
        const std::array<double, 10> rest{0,
                                          is_straight ? 0 : hull_.at_corner(f, i, hull_.positions[t[j]]),
                                          s.m[i][static_cast<Eigen::Index>(i)],
                                          is_straight ? 0 : hull_.at_corner(f, j, hull_.positions[t[i]]),
                                          s.m[i][static_cast<Eigen::Index>(j)],
                                          s.n[static_cast<Eigen::Index>(i)],
                                          0,
                                          s.m[j][static_cast<Eigen::Index>(j)],
                                          s.n[static_cast<Eigen::Index>(j)],
                                          s.n[3]};
        std::ranges::copy(rest, c.begin() + 10);
        return c;
    }

    void describe(std::size_t row, PatchKind kind, Side side, std::size_t f, u32 edge) {
        kinds_[row] = kind;
        tet_sides_[row] = static_cast<u8>(side);
        triangles_[row] = static_cast<u32>(f);
        edges_[row] = edge;
    }

    const Hull& hull_;
    Curvature curvature_;
    Execution& execution_;
    std::array<std::vector<FaceSide>, 2> sides_;  // by Side
    std::size_t first_apex_ = 0, first_edge_point_ = 0, tets_of_faces_ = 0;
    std::vector<u32> base_;
    std::vector<std::array<u32, 2>> edge_point_;  ///< by edge and Side
    std::vector<std::size_t> first_row_, row_of_edge_;  ///< first row of each face's and of each edge's tetrahedra
    Array<Vec3> positions_;
    Array<std::array<u32, 4>> tets_;
    Array<PatchWeights> weights_;
    Array<PatchKind> kinds_;
    Array<u8> tet_sides_;
    Array<u32> triangles_, edges_, partners_;
    Array<Combine> combine_;
    std::atomic<std::size_t> raised_ = 0;
};

}  // namespace

/// The quadric interpolates a face's vertices and normals as well as it can. Its value and gradient come from the
/// vertices, its second derivatives from the differences of the normals.
Eigen::Matrix3d face_curvature(const Hull& hull, std::size_t face, Curvature curvature) {
    const Triangle& t = hull.triangles[face];
    const Vec3& p = hull.positions[t[0]];
    const Vec3 e1 = hull.positions[t[1]] - p, e2 = hull.positions[t[2]] - p;
    const std::array<Vec3, 3>& normals = hull.normals[face];
    const Vec3 d1 = normals[1] - normals[0], d2 = normals[2] - normals[0];
    const Vec3& n = hull.faces[face].normal;
    const Vec3 x = e1.normalized(), y = n.cross(x);
    Eigen::Matrix2d edges;
    edges << x.dot(e1), x.dot(e2), y.dot(e1), y.dot(e2);
    Eigen::Matrix<double, 3, 2> differences;
    differences << x.dot(d1), x.dot(d2), y.dot(d1), y.dot(d2), n.dot(d1), n.dot(d2);
    const Eigen::Matrix<double, 3, 2> change = differences * edges.inverse();
    Eigen::Matrix3d local;
    local.topLeftCorner<2, 2>() = (change.topRows<2>() + change.topRows<2>().transpose()) / 2;
    local.bottomLeftCorner<1, 2>() = change.row(2);
    local.topRightCorner<2, 1>() = change.row(2).transpose();
    local(2, 2) = curvature == Curvature::mean ? (local(0, 0) + local(1, 1)) / 2 : 0;
    Eigen::Matrix3d axes;
    axes << x, y, n;
    return axes * local * axes.transpose();
}

std::size_t wrong_signs(const PatchComplex& patches, std::size_t tet) {
    if (patches.kinds[tet] == PatchKind::sharp || patches.kinds[tet] == PatchKind::continuation) return 0;
    const PatchWeights& weights = patches.weights[tet];
    double largest = 0;
    for (const double weight : weights) largest = std::max(largest, std::abs(weight));
    const double sign = patches.sides[tet] == 1 ? 1 : -1;
    std::size_t wrong = 0, number = 0;
    for (int i = 3; i >= 0; --i)
        for (int j = 3 - i; j >= 0; --j)
            for (int k = 3 - i - j; k >= 0; --k, ++number) {
                const int layer = 3 - i - j - k + (patches.kinds[tet] == PatchKind::edge ? i : 0);
                if (layer > 0 && sign * weights[number] < -rounding * largest) ++wrong;
            }
    return wrong;
}

Weights make_weights(const Hull& hull, Curvature curvature, Execution& execution) {
    return WeightsBuilder(hull, curvature, execution).weights();
}

}  // namespace scanmill::a_patches
