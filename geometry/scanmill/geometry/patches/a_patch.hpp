// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Evaluates A-patches: cubic polynomials in Bernstein-Bezier form over tetrahedra. PatchCell is one tetrahedron.
/// PatchSurface is the whole complex. At a point it computes the value, the gradient, the second derivatives and
/// whether the point is inside. It also finds the first hit of a ray and the nearest point of the surface. The file
/// tests/geometry/patches/a_patch_example.hpp shows its use.
///
/// Beside sharp edges, two rows of the complex share a tetrahedron (PatchComplex::partners). There the function is the
/// larger or the smaller of the two rows' functions. The row that gives this value is *active*; its function also gives
/// the derivatives.
///
/// Barycentric coordinates are four numbers whose sum is 1, or 0 for a direction. Functions of one tetrahedron cost a
/// few hundred operations. They use no libm function whose result depends on the processor. All functions are safe from
/// several threads.

#include <Eigen/Core>
#include <optional>
#include <vector>

#include "scanmill/data/patches.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

using Barycentric = Eigen::Vector4d;

/// The value at the point with these coordinates.
double patch_value(const PatchWeights& weights, const Barycentric& at);
/// The polar form f(a, b, c). It is symmetric and affine in each argument; f(a, a, a) is the value at a.
double patch_blossom(const PatchWeights& weights, const Barycentric& a, const Barycentric& b, const Barycentric& c);
/// The derivatives by the four coordinates. The gradient by position is the sum of the coordinates' gradients, each
/// times its derivative.
Eigen::Vector4d patch_derivatives(const PatchWeights& weights, const Barycentric& at);

/// A tetrahedron with its function.
class PatchCell {
public:
    /// Keeps a reference to `weights`. Pre: a tetrahedron with a volume.
    PatchCell(const std::array<Vec3, 4>& corners, const PatchWeights& weights);
    PatchCell(const std::array<Vec3, 4>& corners, const PatchWeights&& weights) = delete;
    /// Keeps a reference to the weights of `patches`.
    PatchCell(const PatchComplex& patches, std::size_t tet);
    PatchCell(const PatchComplex&& patches, std::size_t tet) = delete;

    Barycentric coordinates(const Vec3& point) const;
    Vec3 point(const Barycentric& at) const;
    double value(const Vec3& point) const { return patch_value(*weights_, coordinates(point)); }
    Vec3 gradient(const Barycentric& at) const { return gradients_ * patch_derivatives(*weights_, at); }
    Vec3 gradient(const Vec3& point) const { return gradient(coordinates(point)); }
    Eigen::Matrix3d hessian(const Vec3& point) const;
    /// The value divided by the length of the gradient. To first order, this is the signed distance to the surface
    /// (Taubin 1991). Infinite or NaN where the gradient is 0.
    double first_order_distance(const Vec3& point) const;
    const PatchWeights& weights() const { return *weights_; }

private:
    std::array<Vec3, 4> corners_;
    Eigen::Matrix<double, 3, 4> gradients_;  ///< gradients of the four coordinates
    const PatchWeights* weights_;
};

/// The Bernstein weights at 0, 1/3, 2/3 and 1 of the function along the segment between two points.
std::array<double, 4> patch_along(const PatchWeights& weights, const Barycentric& from, const Barycentric& to);

/// The zero t in [0, 1] of the cubic with these Bernstein weights at 0, 1/3, 2/3 and 1, accurate to the last bits.
/// Empty if the first and the last weight have one sign and are not 0. Pre: at most one zero.
std::optional<double> zero_of_cubic(const std::array<double, 4>& weights);

/// The share t at which the segment between two points meets the surface. It is zero_of_cubic() of patch_along(), so
/// the same preconditions apply.
std::optional<double> patch_hit(const PatchWeights& weights, const Barycentric& from, const Barycentric& to);

/// The zeros t in [0, 1] of any cubic, ascending, accurate to about 1e-15. For the cubic that is 0 everywhere: only t =
/// 0.
std::vector<double> zeros_of_cubic(const std::array<double, 4>& weights);

/// Evaluates a complex at points and along rays. The function is defined near the surface only: points outside all
/// tetrahedra have no value.
class PatchSurface {
public:
    struct Hit {
        double share;  ///< position on the ray: the point is from + share * direction
        u32 tet;
        Vec3 point;
        Vec3 gradient;
    };
    struct Foot {
        Vec3 point;  ///< on the surface
        double distance;  ///< positive outside the object, negative inside
    };

    /// Keeps a reference to `patches`. Pre: at least one tetrahedron. Cost: O(n log n), about 200 bytes per
    /// tetrahedron.
    explicit PatchSurface(const PatchComplex& patches, unsigned threads = 1);

    /// The tetrahedron that contains the point; of two partners, the active row. If several contain it, because parts
    /// of the surface are near each other, the one with the smallest |F|; ties: the first row. Cost: O(log n).
    std::optional<u32> locate(const Vec3& point) const;
    PatchCell cell(u32 tet) const { return PatchCell(patches_, tet); }

    /// The value is negative inside the object and positive outside. Near the surface it is about the distance.
    std::optional<double> value(const Vec3& point) const;
    std::optional<Vec3> gradient(const Vec3& point) const;
    std::optional<Eigen::Matrix3d> hessian(const Vec3& point) const;

    /// Whether the point is inside the object. For points outside all tetrahedra a ray decides. Pre: a closed surface.
    bool is_inside(const Vec3& point) const;

    /// The first point of the surface on the segment from + t * direction, 0 <= t <= 1. Cost: O(log n) for each 64th of
    /// the complex's diagonal along the segment.
    std::optional<Hit> first_hit(const Vec3& from, const Vec3& direction) const;

    /// A point of the surface whose distance to `point` is a local minimum. Newton's method starts near `start` and
    /// moves along the surface, always towards `point`; it continues along a crease if it arrives at one. The result is
    /// the nearest point of all if `start` is on the same slope. Empty if `start` is outside the tetrahedra, or if the
    /// path crosses the boundary of an open surface.
    std::optional<Foot> foot(const Vec3& point, const Vec3& start) const;
    /// The same with `point` as start. Finds the nearest point if `point` is nearer to the surface than the radius of
    /// curvature.
    std::optional<Foot> foot(const Vec3& point) const { return foot(point, point); }

private:
    /// The active row of a tetrahedron and its partner at the point.
    u32 active(u32 tet, const Vec3& point) const;
    /// The function at a point.
    struct Local {
        u32 tet;
        double value;
        Vec3 gradient;
    };
    /// Evaluates the function; tries tetrahedron `hint` first. Empty outside all tetrahedra.
    std::optional<Local> local(const Vec3& point, std::optional<u32> hint) const;
    /// Moves a point onto the surface along gradients; returns whether it converged.
    bool retract(Vec3& point, Local& here) const;
    /// The tetrahedra with two functions that contain the point; of two partners, the lower row.
    std::vector<u32> with_creases_at(const Vec3& point) const;
    /// The Newton step from x to the crease in `tet`, and along its tangent to the point nearest to `point`.
    Vec3 step_on_crease(const Vec3& point, const Vec3& x, u32 tet) const;
    /// foot() along creases; starts with the crease in tetrahedron `tet`.
    std::optional<Foot> foot_on_crease(const Vec3& point, const Vec3& start, u32 tet) const;
    std::optional<Hit> hit_in(u32 tet, const Vec3& from, const Vec3& direction) const;

    const PatchComplex& patches_;
    BoundingBox box_;
    TriangleTree tree_;  ///< over the diagonals of the tetrahedra's boxes
};

}  // namespace scanmill
