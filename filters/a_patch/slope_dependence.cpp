// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/slope_dependence.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>

namespace scanmill::a_patches {

namespace {

std::size_t index_in(const auto& list, u32 element) {
    return static_cast<std::size_t>(std::ranges::find(list, element) - list.begin());
}

Directions directions(const Hull& hull, u32 number) {
    const HullEdge& edge = hull.edges[number];
    if (edge.is_sharp) return Directions::Zero();
    const Vec3& a = hull.positions[edge.a];
    const Vec3 d = (hull.positions[edge.b] - a).normalized();
    Directions result = Directions::Zero();
    std::size_t undivided = 0;
    Vec3 normal = Vec3::Zero();
    for (const u32 f : {edge.first, edge.second}) {
        if (f == HullEdge::none) continue;
        const HullFace& face = hull.faces[f];
        normal += face.normal;
        if (face.is_divided) continue;
        // An undivided triangle fixes f(a, b, X) at its opposite corner. The slope can change only perpendicular to it.
        ++undivided;
        const Vec3 to = hull.positions[hull.triangles[f][previous(hull.number_in(number, f))]] - a;
        result.col(0) = d.cross(to).normalized();
    }
    if (undivided == 1) return result;
    if (undivided == 2) return Directions::Zero();
    result.col(0) = normal.normalized();
    result.col(1) = d.cross(result.col(0));
    return result;
}

}  // namespace

std::vector<Directions> free_directions(const Hull& hull) {
    std::vector<Directions> result;
    for (u32 e = 0; e < hull.edges.size(); ++e) result.push_back(directions(hull, e));
    return result;
}

SlopeDependence::SlopeDependence(const Hull& hull, const std::vector<Directions>& free, const PatchComplex& patches,
                                 std::size_t tet)
    : hull_(&hull),
      free_(&free),
      tet_(patches.tets[tet]),
      face_(patches.triangles[tet]),
      side_(patches.sides[tet] == 1 ? outside : inside),
      first_(patches.positions[tet_[0]]) {
    switch (patches.kinds[tet]) {
        case PatchKind::face: set_face(); break;
        case PatchKind::edge: set_edge(patches.edges[tet], 2); break;
        case PatchKind::sharp: set_edge(patches.edges[tet], 1); break;
        case PatchKind::continuation: break;  // depends on the sharp edge's slope only, which is not free
    }
}

Eigen::Vector2d SlopeDependence::effect(u32 edge, const Vec3& point) const {
    return (*free_)[edge].transpose() * (point - hull_->positions[hull_->edges[edge].a]);
}

void SlopeDependence::set_face() {
    const HullFace& face = hull_->faces[face_];
    const Vec3 apex = hull_->apex(face_, side_);
    is_divided_ = face.is_divided;
    const std::size_t i = is_divided_ ? index_in(hull_->triangles[face_], tet_[1]) : 0;
    count_ = 3;
    for (std::size_t n = 0; n < 3; ++n) {
        shares_[n] = face.share[static_cast<Eigen::Index>((i + n) % 3)];
        edges_[n] = face.edges[(i + n) % 3];
        unit_[n] = {effect(edges_[n], face.base), effect(edges_[n], apex)};
    }
}

void SlopeDependence::set_edge(u32 number, std::size_t triangles) {
    is_edge_ = true;
    count_ = 1 + 2 * triangles;
    const HullEdge& edge = hull_->edges[number];
    const std::array<u32, 2> faces{face_, edge.first == face_ ? edge.second : edge.first};
    edges_[0] = number;
    unit_[0][1] = Eigen::Vector2d::Zero();
    for (std::size_t of = 0; of < triangles; ++of) {
        const HullFace& face = hull_->faces[faces[of]];
        const Triangle& t = hull_->triangles[faces[of]];
        const Vec3 apex = hull_->apex(faces[of], side_);
        unit_[0][of] = effect(number, apex);
        // The edges from i and from j to the third corner. i and j are ordered as in the tetrahedron's own triangle.
        const std::size_t here = hull_->number_in(number, faces[of]);
        const std::size_t at_i = of == 0 ? previous(here) : next(here), at_j = of == 0 ? next(here) : previous(here);
        edges_[1 + 2 * of] = face.edges[at_i];
        edges_[2 + 2 * of] = face.edges[at_j];
        for (const std::size_t n : {1 + 2 * of, 2 + 2 * of})
            unit_[n] = {effect(edges_[n], apex), Eigen::Vector2d::Zero()};
        Eigen::Matrix3d corners;
        for (std::size_t c = 0; c < 3; ++c) corners.col(static_cast<Eigen::Index>(c)) = hull_->positions[t[c]] - apex;
        const Vec3 at = corners.inverse() * (first_ - apex);
        for (std::size_t c = 0; c < 2; ++c) of_x_[of][c] = at[static_cast<Eigen::Index>(index_in(t, tet_[1 + c]))];
        of_x_[of][2] = at[static_cast<Eigen::Index>(previous(here))];
    }
}

SlopeDependence::Coefficients SlopeDependence::coefficients(const Barycentric& at) const {
    const double w = at[0], i = at[1], j = at[2], top = at[3];
    Coefficients c{};
    if (is_edge_) {
        // f(x, x, apex) and f(x, x, x) depend on f(i, x, x) and f(j, x, x). These are means over both triangles of f(i,
        // x, apex) and f(j, x, apex). At a sharp edge they do not depend on slopes.
        const double share = count_ == most_edges ? 0.5 : 0;
        const double beyond = (3 * w * w * top + w * w * w) / 2;
        const double of_i = 3 * w * w * i + beyond, of_j = 3 * w * w * j + beyond;
        const double at_i = 6 * w * i * top + share * of_i, at_j = 6 * w * j * top + share * of_j;
        c[0][0] = 6 * i * j * top + 3 * w * i * j + at_i * of_x_[0][1] + at_j * of_x_[0][0];
        c[0][1] = 3 * w * i * j + of_i / 2 * of_x_[1][1] + of_j / 2 * of_x_[1][0];
        c[1][0] = at_i * of_x_[0][2];
        c[2][0] = at_j * of_x_[0][2];
        c[3][0] = of_i / 2 * of_x_[1][2];
        c[4][0] = of_j / 2 * of_x_[1][2];
    } else if (is_divided_) {
        const double si = shares_[0], sj = shares_[1], sk = shares_[2];
        for (std::size_t of = 0; of < 2; ++of) {
            // First f(w, w, w), f(w, w, i), f(w, w, j) and f(w, i, j); then the same with the apex in place of one w.
            const double p = of == 0 ? w * w * w : 3 * w * w * top;
            const double q = of == 0 ? 3 * w * w : 6 * w * top;
            c[0][of] = 2 * si * sj * p + sj * q * i + si * q * j + 6 * i * j * (of == 0 ? w : top);
            c[1][of] = 2 * sj * sk * p + sk * q * j;
            c[2][of] = 2 * sk * si * p + sk * q * i;
        }
    } else {
        c[0][1] = 6 * w * i * top;
        c[1][1] = 6 * i * j * top;
        c[2][1] = 6 * j * w * top;
    }
    return c;
}

std::array<Eigen::Vector2d, SlopeDependence::most_edges> SlopeDependence::derivatives(const Barycentric& at) const {
    std::array<Eigen::Vector2d, most_edges> result;
    const Coefficients c = coefficients(at);
    for (std::size_t n = 0; n < count_; ++n) result[n] = c[n][0] * unit_[n][0] + c[n][1] * unit_[n][1];
    return result;
}

}  // namespace scanmill::a_patches
