// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/hull.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/base/parallel.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr double share_of_radius = 0.15;  // share of the inradius that is added to a height
constexpr double low_factor = 1.05, low_share = 0.02;  // see low()
constexpr double higher_factor = 1.4, higher_share = 0.05;
constexpr double most_height = 20;  // in inradii, up to which apexes are raised; tetrahedra beyond lose digits
constexpr int most_rounds = 12;
constexpr double flattest_share = 1e-3;  // share of the inradius; gradients in flatter tetrahedra lose many digits
constexpr double share_of_gap = 0.45;  // share of the distance to the next sheet
constexpr double least_sine = 0.1;  // between two undivided triangles
constexpr double most_change = 0.1;  // largest change of an edge's gradient, whose length is 1
constexpr double most_cosine_of_straight = 1e-12;  // rounding of the cosine between perpendicular edge and normal
constexpr double cosine_of_acute = -0.5;  // between the triangles' normals
constexpr double least_sine_of_opening = 0.0175;  // 1 degree; tetrahedra that are flatter count as inside out
constexpr double least_sine_of_crease = 0.1;  // between the normals on its sides, to give the crease a direction
constexpr double most_of_hermite = 4.0 / 27;  // largest value of a cubic with one end slope of 1 and zeros else
constexpr double clearance = 1.5;  // distance of the segment between apexes from the edge, as a multiple of the bulge
constexpr double least_turn = 1e-9;  // normals at a smaller sine count as parallel
constexpr std::size_t chunk = 256;  // triangles
// Cosines of the limits of the angle between two apexes, seen along their edge: 4 and 172 degrees.
constexpr double cosine_of_4 = 0.9975640502598242, cosine_of_172 = -0.9902680687415704;

HullFace face_of(const std::array<Vec3, 3>& p) {
    HullFace face;
    const Vec3 across = area_vector(p[0], p[1], p[2]);
    const double twice = across.norm();
    face.normal = across / twice;
    const Vec3 opposite((p[1] - p[2]).norm(), (p[2] - p[0]).norm(), (p[0] - p[1]).norm());
    const double perimeter = opposite.sum();
    face.share = opposite / perimeter;
    face.base = face.share[0] * p[0] + face.share[1] * p[1] + face.share[2] * p[2];
    face.radius = twice / perimeter;
    return face;
}

/// The default slope of an edge, which is exact for quadrics. `d` goes from end a to end b; `na` and `nb` are the
/// normals there, and `bend` is added to their mean.
Vec3 default_slope(const Vec3& d, const Vec3& na, const Vec3& nb, const Vec3& bend = Vec3::Zero()) {
    const Vec3 sum = na + nb, mean = sum / 6 + bend / 3;
    return mean - d * ((mean.dot(d) + sum.dot(d) / 3) / d.squaredNorm());
}

bool are_adjacent(const Triangle& one, const Triangle& other) {
    return std::ranges::any_of(one, [&](u32 v) { return std::ranges::find(other, v) != other.end(); });
}

/// Whether, at an end of a curved crease, the segment between the apexes passes under the line in which the two tangent
/// planes meet. The surface would end there.
bool passes_under(const Hull& hull, const HullEdge& edge, Side side) {
    if (!edge.is_sharp || edge.is_straight || edge.is_convex != (side == outside)) return false;
    const std::array<u32, 2> faces{edge.first, edge.second};
    const std::array<Vec3, 2> apexes{hull.apex(edge.first, side), hull.apex(edge.second, side)};
    for (const u32 v : {edge.a, edge.b}) {
        std::array<std::array<double, 2>, 2> height;  // height of apexes over tangent planes, by plane and apex
        for (std::size_t of = 0; of < 2; ++of) {
            const Triangle& t = hull.triangles[faces[of]];
            const auto corner = static_cast<std::size_t>(std::ranges::find(t, v) - t.begin());
            for (std::size_t i = 0; i < 2; ++i)
                height[of][i] = sign_of(side) * hull.at_corner(faces[of], corner, apexes[i]);
        }
        // True if a part of the segment is below both tangent planes.
        if (height[0][1] < 0 && height[1][0] < 0 && height[0][0] * height[1][1] <= height[0][1] * height[1][0])
            return true;
    }
    return false;
}

/// Largest distance between the chord and the cubic curve that a crease follows, at the side where it lies between the
/// apexes; see bisect().
double bulge(const Hull& hull, const HullEdge& edge, Side side) {
    if (!edge.is_sharp || edge.is_straight || edge.is_convex != (side == outside)) return 0;
    const Vec3 d = hull.positions[edge.b] - hull.positions[edge.a];
    const auto off = [&](u32 v) {
        std::array<Vec3, 2> normals;
        for (std::size_t of = 0; of < 2; ++of) {
            const std::size_t f = of == 0 ? edge.first : edge.second;
            normals[of] = hull.normals[f][static_cast<std::size_t>(std::ranges::find(hull.triangles[f], v) -
                                                                   hull.triangles[f].begin())];
        }
        return off_tangent(d, normals[0], normals[1], true).norm();
    };
    return most_of_hermite * (off(edge.a) + off(edge.b));
}

/// The opening between two apexes across an edge.
enum class Opening { sound, too_small, too_large };

Opening opening(const Hull& hull, const HullEdge& edge, Side side) {
    const Vec3& a = hull.positions[edge.a];
    const Vec3 d = (hull.positions[edge.b] - a).normalized();
    const auto across = [&](const Vec3& apex) -> Vec3 { return (apex - a) - d * d.dot(apex - a); };
    const Vec3 u = across(hull.apex(edge.first, side)), v = across(hull.apex(edge.second, side));
    const double length = std::sqrt(u.squaredNorm() * v.squaredNorm());
    const double sine = sign_of(side) * d.dot(u.cross(v)), cosine = u.dot(v);
    if (sine <= 0) {
        // The angle is negative or above 180 degrees. It can be negative only where the triangles enclose less than 180
        // degrees, because apexes lie over the interiors of their triangles.
        const Vec3& base = hull.faces[edge.second].base;
        const bool is_above = sign_of(side) * hull.faces[edge.first].normal.dot(base - a) > 0;
        return is_above ? Opening::too_small : Opening::too_large;
    }
    if (cosine >= cosine_of_4 * length) return Opening::too_small;
    const bool is_low = cosine <= cosine_of_172 * length || sine < clearance * bulge(hull, edge, side) * (u - v).norm();
    return is_low || passes_under(hull, edge, side) ? Opening::too_large : Opening::sound;
}

class HullBuilder {
public:
    HullBuilder(const PatchMesh& mesh, double apex_factor, Split split, Execution& execution)
        : mesh_(mesh),
          apex_factor_(apex_factor),
          split_(split),
          execution_(execution) {
        hull_.positions = mesh.mesh.positions.span();
        hull_.triangles = mesh.mesh.triangles.span();
        hull_.normals = mesh.normals;
        opposites_ = half_edges::opposites(mesh.mesh);
    }

    Hull hull() {
        add_faces();
        add_edges();
        if (split_ == Split::where_needed) undivide();
        execution_.check_cancelled();
        set_heights();
        const TriangleTree tree(hull_.positions, hull_.triangles, execution_.threads());
        limit_heights(tree);
        open_gaps();
        limit_heights(tree);  // again, for the apexes that open_gaps() raised
        find_faults();
        return std::move(hull_);
    }

private:
    void add_faces() {
        for (const Triangle& t : hull_.triangles)
            hull_.faces.push_back(face_of({hull_.positions[t[0]], hull_.positions[t[1]], hull_.positions[t[2]]}));
    }

    void add_edges() {
        for (u32 half = 0; half < opposites_.size(); ++half) {
            const u32 other = opposites_[half];
            if (other != half_edges::boundary && other < half) continue;
            HullEdge edge;
            edge.a = hull_.triangles[half / 3][half % 3];
            edge.b = hull_.triangles[half / 3][(half + 1) % 3];
            edge.first = half / 3;
            const auto number = static_cast<u32>(hull_.edges.size());
            hull_.faces[edge.first].edges[half % 3] = number;
            if (other != half_edges::boundary) {
                edge.second = other / 3;
                hull_.faces[edge.second].edges[other % 3] = number;
            }
            const std::span sharp = mesh_.mesh.sharp_edges.span();
            edge.is_sharp =
                edge.second != HullEdge::none && std::ranges::binary_search(sharp, make_edge(edge.a, edge.b));
            const std::array<Vec3, 2> of_first{hull_.normals[half / 3][half % 3],
                                               hull_.normals[half / 3][(half + 1) % 3]};
            const Vec3 d = hull_.positions[edge.b] - hull_.positions[edge.a];
            const auto bend = mesh_.bends.find(make_edge(edge.a, edge.b));
            edge.slopes.fill(
                default_slope(d, of_first[0], of_first[1],
                              bend == mesh_.bends.end() || edge.is_sharp ? Vec3(Vec3::Zero()) : bend->second));
            if (edge.is_sharp) describe_sharp(edge, of_first, other);
            set_slope_without_normals(edge);
            hull_.edges.push_back(edge);
        }
    }

    /// Sets the slope of an edge between two vertices without normals from the normals of its triangles.
    void set_slope_without_normals(HullEdge& edge) {
        const Vec3& first = hull_.faces[edge.first].normal;
        const Vec3& second = hull_.faces[edge.second == HullEdge::none ? edge.first : edge.second].normal;
        const bool are_zero = edge.slopes[0] == Vec3::Zero() || edge.slopes[1] == Vec3::Zero();
        if (are_zero && !edge.is_sharp) edge.slopes.fill((first + second) / 6);
        if (edge.slopes[0] == Vec3::Zero()) edge.slopes[0] = first / 3;
        if (edge.slopes[1] == Vec3::Zero()) edge.slopes[1] = second / 3;
    }

    void describe_sharp(HullEdge& edge, const std::array<Vec3, 2>& of_first, u32 other) {
        const std::array<Vec3, 2> of_second{hull_.normals[other / 3][(other + 1) % 3],
                                            hull_.normals[other / 3][other % 3]};
        const Vec3 d = hull_.positions[edge.b] - hull_.positions[edge.a];
        edge.slopes[1] = default_slope(d, of_second[0], of_second[1]);
        edge.is_straight = std::ranges::all_of(
            std::array{of_first[0], of_first[1], of_second[0], of_second[1]},
            [&](const Vec3& n) { return std::abs(n.dot(d)) <= most_cosine_of_straight * d.norm(); });
        // At a convex edge the normals of the two faces diverge.
        const double turn = d.dot(of_first[0].cross(of_second[0]) + of_first[1].cross(of_second[1])) / d.norm();
        if (std::abs(turn) > least_turn) {
            edge.is_convex = turn > 0;
        } else {
            const Vec3& opposite = hull_.positions[hull_.triangles[other / 3][(other + 2) % 3]];
            edge.is_convex = (opposite - hull_.positions[edge.a]).dot(hull_.faces[edge.first].normal) <= 0;
        }
    }

    // Undivided triangles.

    /// The vector from end a of edge `e` to the opposite corner of face `f`.
    Vec3 opposite(u32 e, u32 f) const {
        return hull_.positions[hull_.triangles[f][(hull_.number_in(e, f) + 2) % 3]] - hull_.positions[hull_.edges[e].a];
    }

    /// Leaves a triangle undivided unless one of its edges would then have no slope, or a slope far from its default.
    void undivide() {
        std::vector<Vec3> defaults;
        for (const HullEdge& edge : hull_.edges) defaults.push_back(edge.slopes[0]);
        for (u32 f = 0; f < hull_.faces.size(); ++f) {
            HullFace& face = hull_.faces[f];
            face.is_divided = std::ranges::any_of(face.edges, [&](u32 e) { return hull_.edges[e].is_sharp; });
            face.middle = 0;
            for (std::size_t i = 0; i < 3; ++i)
                face.middle += hull_.at_edge(f, i, hull_.positions[hull_.triangles[f][(i + 2) % 3]]) / 3;
        }
        for (;;) {
            std::vector<u32> bad;
            for (u32 e = 0; e < hull_.edges.size(); ++e)
                if (!hull_.edges[e].is_sharp && !set_slope(e, defaults[e])) bad.push_back(e);
            if (bad.empty()) return;
            divide(bad);
            execution_.check_cancelled();
        }
    }

    /// Sets an edge's slope to the one nearest to its default that the undivided triangles at the edge allow. Returns
    /// whether such a slope exists and is usable.
    bool set_slope(u32 e, const Vec3& by_default) {
        HullEdge& edge = hull_.edges[e];
        edge.slopes.fill(by_default);
        const Vec3 d = (hull_.positions[edge.b] - hull_.positions[edge.a]).normalized();
        std::array<Vec3, 2> across;
        std::array<double, 2> missing;
        std::size_t conditions = 0;
        for (const u32 f : {edge.first, edge.second}) {
            if (f == HullEdge::none || hull_.faces[f].is_divided) continue;
            const Vec3 to = opposite(e, f);
            across[conditions] = to - d * d.dot(to);
            missing[conditions++] =
                hull_.faces[f].middle - hull_.at_edge(f, hull_.number_in(e, f), hull_.positions[edge.a] + to);
        }
        if (conditions == 0) return true;
        Vec3 change;
        if (conditions == 1) {
            change = across[0] * (missing[0] / across[0].squaredNorm());
        } else {
            const double area = d.dot(across[0].cross(across[1]));
            if (std::abs(area) < least_sine * std::sqrt(across[0].squaredNorm() * across[1].squaredNorm()))
                return false;
            change = (missing[0] * across[1].cross(d) + missing[1] * d.cross(across[0])) / area;
        }
        if (3 * change.norm() > most_change) return false;
        edge.slopes.fill(by_default + change);
        return std::ranges::all_of(std::array{edge.first, edge.second}, [&](u32 f) {
            return f == HullEdge::none || hull_.faces[f].normal.dot(edge.slopes[0]) > 0;
        });
    }

    /// Divides triangles until every bad edge has a newly divided triangle; triangles with the most bad edges come
    /// first.
    void divide(const std::vector<u32>& bad) {
        std::vector<u32> count(hull_.faces.size(), 0), candidates;
        std::vector<bool> is_bad(hull_.edges.size(), false);
        for (const u32 e : bad) {
            is_bad[e] = true;
            for (const u32 f : {hull_.edges[e].first, hull_.edges[e].second})
                if (f != HullEdge::none && !hull_.faces[f].is_divided && count[f]++ == 0) candidates.push_back(f);
        }
        std::ranges::sort(candidates);
        std::ranges::stable_sort(candidates, [&](u32 one, u32 other) { return count[one] > count[other]; });
        for (const u32 f : candidates) {
            HullFace& face = hull_.faces[f];
            if (std::ranges::none_of(face.edges, [&](u32 e) { return is_bad[e]; })) continue;
            face.is_divided = true;
            for (const u32 e : face.edges) is_bad[e] = false;
        }
    }

    // Heights.

    void set_heights() {
        for (std::size_t f = 0; f < hull_.faces.size(); ++f) {
            HullFace& face = hull_.faces[f];
            for (const Side side : both_sides) {
                // The signed values at the apex, which is base ± h normal, must be positive. Therefore h > -(value at
                // the base) / (slope along the normal).
                double least = 0;
                for (std::size_t i = 0; i < 3; ++i) {
                    const double at_corner = -sign_of(side) * hull_.at_corner(f, i, face.base);
                    const double at_edge = -sign_of(side) * hull_.at_edge(f, i, face.base);
                    const Vec3& normal = hull_.normals[f][i];
                    if (normal != Vec3::Zero()) least = std::max(least, 3 * at_corner / face.normal.dot(normal));
                    least = std::max(least, at_edge / face.normal.dot(hull_.slope(f, i)));
                }
                face.least[side] = least;
                face.height[side] = apex_factor_ * least + share_of_radius * face.radius;
            }
        }
    }

    /// Keeps each apex below the next sheet that the line from its base point through the apex meets.
    void limit_heights(const TriangleTree& tree) {
        for_each_chunk(execution_.threads(), hull_.faces.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            Array<u32> rows;
            for (std::size_t f = begin; f < end; ++f)
                for (const Side side : both_sides) {
                    HullFace& face = hull_.faces[f];
                    const Vec3 reach = sign_of(side) * (face.height[side] / share_of_gap) * face.normal;
                    BoundingBox box;
                    box.add(face.base);
                    box.add(face.base + reach);
                    rows.clear();
                    tree.meeting(box, rows);
                    double nearest = 1;
                    for (const u32 row : rows)
                        if (!are_adjacent(hull_.triangles[f], hull_.triangles[row]))
                            nearest = std::min(nearest, share_until(face.base, reach, row));
                    if (nearest == 1) continue;
                    face.limit[side] = std::max(nearest * face.height[side],
                                                low_factor * face.least[side] + flattest_share * face.radius);
                    face.is_thin = face.is_thin || face.limit[side] > nearest * face.height[side];
                    face.height[side] = face.limit[side];
                }
        });
    }

    /// The share of `reach` after which the line from `from` meets triangle `row`; 1 if it does not meet the triangle.
    double share_until(const Vec3& from, const Vec3& reach, u32 row) const {
        const Triangle& t = hull_.triangles[row];
        const Vec3 &a = hull_.positions[t[0]], u = hull_.positions[t[1]] - a, v = hull_.positions[t[2]] - a;
        const Vec3 across = reach.cross(v);
        const double volume = u.dot(across);
        if (volume == 0) return 1;
        const Vec3 to = from - a, turned = to.cross(u);
        const double first = to.dot(across) / volume, second = reach.dot(turned) / volume,
                     share = v.dot(turned) / volume;
        return first >= 0 && second >= 0 && first + second <= 1 && share > 0 && share < 1 ? share : 1;
    }

    /// The least height that an apex may be lowered to.
    static double low(const HullFace& face, Side side) {
        return low_factor * face.least[side] + low_share * face.radius;
    }

    void find_faults() {
        for (u32 f = 0; f < hull_.faces.size(); ++f)
            if (hull_.faces[f].is_thin) hull_.faults.thin.push_back(f);
        for (u32 e = 0; e < hull_.edges.size(); ++e) {
            HullEdge& edge = hull_.edges[e];
            const bool is_open = mesh_.is_open(make_edge(edge.a, edge.b));
            for (const Side side : both_sides) edge.is_filled[side] = !is_open && hull_.is_sound(edge, side);
            if (edge.second == HullEdge::none || edge.is_filled_twice()) continue;
            if (edge.is_sharp) edge.is_filled = {false, false};
            // The surfaces beside a straight edge have no gap between them.
            if (!is_open && !edge.is_straight) hull_.faults.inverted.push_back(e);
        }
    }

    /// Lowers apexes that collide across a concave edge. Raises apexes whose connecting segment passes under a convex
    /// edge.
    void open_gaps() {
        for (int round = 0; round < most_rounds; ++round) {
            bool has_changed = false;
            for (const HullEdge& edge : hull_.edges) {
                if (edge.second == HullEdge::none) continue;
                for (const Side side : both_sides) {
                    const Opening found = opening(hull_, edge, side);
                    if (found == Opening::sound) continue;
                    if (found == Opening::too_large && edge.is_straight && is_acute(edge)) continue;
                    has_changed = true;
                    for (const u32 f : {edge.first, edge.second}) change(hull_.faces[f], side, found);
                }
            }
            if (!has_changed) return;
        }
    }

    /// Whether the edge is so acute that only very high apexes have a connecting segment above it.
    bool is_acute(const HullEdge& edge) const {
        return hull_.faces[edge.first].normal.dot(hull_.faces[edge.second].normal) < cosine_of_acute;
    }

    static void change(HullFace& face, Side side, Opening found) {
        double& height = face.height[side];
        if (found == Opening::too_large) {
            const double most = std::max(height, most_height * face.radius);
            height = std::min({face.limit[side], most, higher_factor * height + higher_share * face.radius});
        } else {
            height = std::min(height, (height + low(face, side)) / 2);
        }
    }

    const PatchMesh& mesh_;
    double apex_factor_;
    Split split_;
    Execution& execution_;
    Array<u32> opposites_;
    Hull hull_;
};

}  // namespace

Vec3 off_tangent(const Vec3& edge, const Vec3& one, const Vec3& other, bool is_sharp) {
    const Vec3 crease = one.cross(other);
    if (!is_sharp || crease.norm() < least_sine_of_crease) return edge.dot(one) * one;
    return edge - crease * (crease.dot(edge) / crease.squaredNorm());
}

bool Hull::is_open_within_smooth(u32 edge) const {
    const HullEdge& e = edges[edge];
    if (e.second == HullEdge::none || e.is_filled_twice()) return false;
    const std::size_t i = number_in(edge, e.first), j = number_in(edge, e.second);
    return normals[e.first][i] == normals[e.second][next(j)] && normals[e.first][next(i)] == normals[e.second][j];
}

bool Hull::is_sound(const HullEdge& edge, Side side) const {
    if (edge.second == HullEdge::none) return true;
    const Vec3 d = (positions[edge.b] - positions[edge.a]).normalized();
    const Vec3 u = d.cross(apex(edge.first, side) - positions[edge.a]),
               v = d.cross(apex(edge.second, side) - positions[edge.a]);
    return sign_of(side) * d.dot(u.cross(v)) > least_sine_of_opening * u.norm() * v.norm();
}

Hull make_hull(const PatchMesh& mesh, double apex_factor, Split split, Execution& execution) {
    return HullBuilder(mesh, apex_factor, split, execution).hull();
}

}  // namespace scanmill::a_patches
