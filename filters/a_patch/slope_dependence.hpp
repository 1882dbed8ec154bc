// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How the cubics depend on the slopes of the hull's edges.

#include <Eigen/Core>
#include <vector>

#include "a_patch/hull.hpp"
#include "scanmill/data/patches.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"

namespace scanmill::a_patches {

/// The free components of an edge's slope: two unit vectors perpendicular to the edge, which the slope changes along;
/// zero for those that are not free. An undivided triangle at the edge leaves one free, two leave none.
using Directions = Eigen::Matrix<double, 3, 2>;
std::vector<Directions> free_directions(const Hull& hull);

/// The derivatives of F in one tetrahedron by the free components of the slopes. F is affine in them, as long as no
/// weight is raised for its sign, so the derivatives hold for changes of any size. A slope's change g changes f(a, b,
/// X) of its edge by g · (X - a); through it up to five edges change F: those of the triangle, and beside an edge those
/// of both triangles.
class SlopeDependence {
public:
    static constexpr std::size_t most_edges = 5;

    /// Pre: `patches` has the weights of `hull`.
    SlopeDependence(const Hull& hull, const std::vector<Directions>& free, const PatchComplex& patches,
                    std::size_t tet);

    std::size_t count() const { return count_; }
    u32 edge(std::size_t n) const { return edges_[n]; }

    /// Derivatives by edge and component; the first count() are set.
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
    Vec3 first_;  ///< corner
    bool is_edge_ = false, is_divided_ = false;
    std::size_t count_ = 0;
    std::array<u32, most_edges> edges_{};
    /// By edge: what a change of 1 of the components adds to f(a, b, X) at two points: the base point and the apex;
    /// beside an edge the two apexes for that edge, the triangle's apex for the others.
    std::array<std::array<Eigen::Vector2d, 2>, most_edges> unit_;
    std::array<double, 3> shares_{};  ///< coordinates of the base point: at i, j, the third corner
    std::array<std::array<double, 3>, 2> of_x_{};  ///< the edge point in both triangles' tetrahedra, likewise
};

}  // namespace scanmill::a_patches
