// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Derivatives of the cubics by the slopes of the hull's edges.

#include <Eigen/Core>
#include <vector>

#include "a_patch/hull.hpp"
#include "scanmill/data/patches.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"

namespace scanmill::a_patches {

/// The free components of an edge's slope: two unit vectors perpendicular to the edge, along which the slope can
/// change. A vector is zero if its component is not free. One undivided triangle at the edge leaves one component free;
/// two such triangles leave none.
using Directions = Eigen::Matrix<double, 3, 2>;
std::vector<Directions> free_directions(const Hull& hull);

/// The derivatives of F in one tetrahedron by the free components of the slopes. F is affine in these components as
/// long as no weight is raised for its sign. Therefore the derivatives hold for changes of any size.
///
/// If a slope changes by g, f(a, b, X) of its edge changes by g · (X - a). Up to five edges change F in this way: the
/// edges of the tetrahedron's triangle, or, for a tetrahedron beside an edge, those of both triangles.
class SlopeDependence {
public:
    static constexpr std::size_t most_edges = 5;

    /// Pre: `patches` has the weights of `hull`.
    SlopeDependence(const Hull& hull, const std::vector<Directions>& free, const PatchComplex& patches,
                    std::size_t tet);

    std::size_t count() const { return count_; }
    u32 edge(std::size_t n) const { return edges_[n]; }

    /// Derivatives by edge and component; only the first count() entries are set.
    std::array<Eigen::Vector2d, most_edges> derivatives(const Barycentric& at) const;

private:
    using Coefficients = std::array<std::array<double, 2>, most_edges>;

    void set_face();
    void set_edge(u32 number, std::size_t triangles);
    Coefficients coefficients(const Barycentric& at) const;
    Eigen::Vector2d effect(u32 edge, const Vec3& point) const;

    const Hull* hull_;
    const std::vector<Directions>* free_;
    std::array<u32, 4> tet_;
    u32 face_;
    Side side_;
    Vec3 first_;  ///< first corner of the tetrahedron
    bool is_edge_ = false, is_divided_ = false;
    std::size_t count_ = 0;
    std::array<u32, most_edges> edges_{};
    /// By edge and point X: the increase of f(a, b, X) when a component increases by 1. Over a triangle, the points are
    /// the base point and the apex. Beside an edge, they are the two apexes for that edge, and the triangle's apex for
    /// the other edges.
    std::array<std::array<Eigen::Vector2d, 2>, most_edges> unit_;
    /// Barycentric coordinates of the base point at i, j and the third corner.
    std::array<double, 3> shares_{};
    /// Coordinates of the edge point in the tetrahedra of both triangles, at i, j and the third corner.
    std::array<std::array<double, 3>, 2> of_x_{};
};

}  // namespace scanmill::a_patches
