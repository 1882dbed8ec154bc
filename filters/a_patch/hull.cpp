// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/hull.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/geometry/mesh/half_edges.hpp"

namespace scanmill::a_patches {

namespace {

constexpr double share_of_radius = 0.15;  // added to a height
constexpr double low_factor = 1.05, low_share = 0.02;  // the least height that an apex is lowered to
constexpr double higher_factor = 1.4, higher_share = 0.05;
constexpr int most_rounds = 12;
// Cosine and sine of the limits 4 and 172 degrees of the angle between two apexes, seen along their edge.
constexpr double cosine_of_4 = 0.9975640502598242, cosine_of_172 = -0.9902680687415704;

HullFace face_of(const std::array<Vec3, 3>& p) {
    HullFace face;
    const Vec3 across = (p[1] - p[0]).cross(p[2] - p[0]);
    const double twice = across.norm();
    face.normal = across / twice;
    const Vec3 opposite((p[1] - p[2]).norm(), (p[2] - p[0]).norm(), (p[0] - p[1]).norm());
    const double perimeter = opposite.sum();
    face.share = opposite / perimeter;
    face.base = face.share[0] * p[0] + face.share[1] * p[1] + face.share[2] * p[2];
    face.radius = twice / perimeter;
    return face;
}

/// The slope of an edge whose value is exact for quadrics.
Vec3 default_slope(const Vec3& d, const Vec3& na, const Vec3& nb) {
    const Vec3 sum = na + nb, mean = sum / 6;
    return mean - d * ((mean.dot(d) + sum.dot(d) / 3) / d.squaredNorm());
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
    if (sine <= 0) return cosine > 0 ? Opening::too_small : Opening::too_large;
    if (cosine >= cosine_of_4 * length) return Opening::too_small;
    return cosine <= cosine_of_172 * length ? Opening::too_large : Opening::sound;
}

class HullBuilder {
public:
    HullBuilder(const TriangleMesh& mesh, std::vector<Vec3> normals, double apex_factor) : apex_factor_(apex_factor) {
        hull_.positions = mesh.positions.span();
        hull_.triangles = mesh.triangles.span();
        hull_.normals = std::move(normals);
        opposites_ = half_edges::opposites(mesh);
    }

    Hull hull(Execution& execution) {
        add_faces();
        add_edges();
        execution.check_cancelled();
        set_heights();
        open_gaps();
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
            edge.slope = default_slope(hull_.positions[edge.b] - hull_.positions[edge.a], hull_.normals[edge.a],
                                       hull_.normals[edge.b]);
            hull_.edges.push_back(edge);
        }
    }

    void set_heights() {
        for (std::size_t f = 0; f < hull_.faces.size(); ++f) {
            HullFace& face = hull_.faces[f];
            for (const Side side : both_sides) {
                // The signed values at base ± h normal must be positive: h > -value at the base / slope along the
                // normal.
                double least = 0;
                for (std::size_t i = 0; i < 3; ++i) {
                    const u32 v = hull_.triangles[f][i];
                    const HullEdge& edge = hull_.edges[face.edges[i]];
                    least = std::max(
                        least, -sign_of(side) * 3 * hull_.at_vertex(v, face.base) / face.normal.dot(hull_.normals[v]));
                    least =
                        std::max(least, -sign_of(side) * hull_.at_edge(edge, face.base) / face.normal.dot(edge.slope));
                }
                face.least[side] = least;
                face.height[side] = apex_factor_ * least + share_of_radius * face.radius;
            }
        }
    }

    /// Lowers apexes that collide across a concave edge, raises those whose connection passes under a convex edge.
    void open_gaps() {
        for (int round = 0; round < most_rounds; ++round) {
            bool has_changed = false;
            for (const HullEdge& edge : hull_.edges) {
                if (edge.second == HullEdge::none) continue;
                for (const Side side : both_sides) {
                    const Opening found = opening(hull_, edge, side);
                    if (found == Opening::sound) continue;
                    has_changed = true;
                    for (const u32 f : {edge.first, edge.second}) change(hull_.faces[f], side, found);
                }
            }
            if (!has_changed) return;
        }
    }

    static void change(HullFace& face, Side side, Opening found) {
        double& height = face.height[side];
        if (found == Opening::too_large) {
            height = higher_factor * height + higher_share * face.radius;
        } else {
            const double low = low_factor * face.least[side] + low_share * face.radius;
            height = std::min(height, (height + low) / 2);
        }
    }

    double apex_factor_;
    Array<u32> opposites_;
    Hull hull_;
};

}  // namespace

bool Hull::is_sound(const HullEdge& edge, Side side) const {
    if (edge.second == HullEdge::none) return true;
    const Vec3 d = positions[edge.b] - positions[edge.a];
    const Vec3 u = apex(edge.first, side) - positions[edge.a], v = apex(edge.second, side) - positions[edge.a];
    return sign_of(side) * d.dot(u.cross(v)) > 0;
}

Hull make_hull(const TriangleMesh& mesh, std::vector<Vec3> normals, double apex_factor, Execution& execution) {
    return HullBuilder(mesh, std::move(normals), apex_factor).hull(execution);
}

}  // namespace scanmill::a_patches
