// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Intersects lines from the mesh to the apexes with the surface.

#include <array>
#include <optional>

#include "scanmill/geometry/patches/a_patch.hpp"

namespace scanmill::tessellation {

/// A point of the surface.
struct SurfacePoint {
    Vec3 position = Vec3::Zero(), normal = Vec3::Zero();
    u8 side = 1;  ///< 0: inside the mesh
};

/// The function of a tetrahedron, or its two functions. Barycentric coordinates have the order of the tetrahedron's
/// row.
class TetFunctions {
public:
    TetFunctions(const PatchComplex& patches, u32 row);

    const PatchCell& own() const { return own_; }
    bool has_other() const { return other_.has_value(); }
    /// The partner's function. Pre: has_other().
    const PatchCell& other() const { return *other_; }
    Combine combine() const { return combine_; }

    /// The side of the mesh on which the surface is at `base`, a point of the mesh. Values up to `zero` count as 0.
    u8 side_at(const Barycentric& base, double zero) const;

    struct Hit {
        SurfacePoint point;
        bool is_at_base;
        bool is_other;  ///< the partner's function holds there
        /// Of two functions: the difference of the shares of the line at which they meet the surface. It is negative if
        /// the partner's holds, and may be infinite.
        double lead;
        bool is_missed;  ///< neither of two functions has a surface on the line; the point is its end
    };
    /// Returns the point of the surface on the line from `base`, a point of the mesh, to `to`, a point on the side
    /// `side`. Throws Error if a single function has no such point.
    Hit hit(u8 side, const Barycentric& base, const Barycentric& to, double zero) const;

private:
    Barycentric in_other(const Barycentric& at) const;

    PatchCell own_;
    std::optional<PatchCell> other_;
    std::array<Eigen::Index, 4> order_{};  ///< corner i is corner order_[i] of the partner
    Combine combine_;
};

/// Returns the side of the surface for the larger or smaller of two values. If that value is 0 and the other is not, it
/// is the side on which the other value changes its sign.
u8 side_of(double one, double other, Combine combine, double zero);

}  // namespace scanmill::tessellation
