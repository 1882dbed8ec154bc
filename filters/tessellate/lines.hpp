// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Intersections of lines from the mesh to the apexes with the surface.

#include <array>
#include <optional>

#include "scanmill/geometry/patches/a_patch.hpp"

namespace scanmill::tessellation {

/// A point of the surface.
struct SurfacePoint {
    Vec3 position = Vec3::Zero(), normal = Vec3::Zero();
    u8 side = 1;  ///< 0: inside the mesh
};

/// The function, or the two functions, of a tetrahedron. Coordinates are those of its row.
class TetFunctions {
public:
    TetFunctions(const PatchComplex& patches, u32 row);

    const PatchCell& own() const { return own_; }
    bool has_other() const { return other_.has_value(); }
    /// The partner's.
    const PatchCell& other() const { return *other_; }
    Combine combine() const { return combine_; }

    /// The side of the mesh on which the surface is seen from a point of it. Values up to `zero` are 0.
    u8 side_at(const Barycentric& base, double zero) const;

    struct Hit {
        SurfacePoint point;
        bool is_at_base;
        bool is_other;  ///< the partner's function holds there
        bool is_missed;  ///< two functions have no surface on the line; the point is its end
    };
    /// The point of the surface on the line from a point of the mesh to one off it, on that side. Throws Error if one
    /// function has none.
    Hit hit(u8 side, const Barycentric& base, const Barycentric& to, double zero) const;

private:
    Barycentric in_other(const Barycentric& at) const;

    PatchCell own_;
    std::optional<PatchCell> other_;
    std::array<Eigen::Index, 4> order_{};  ///< corner i is corner order_[i] of the partner
    Combine combine_;
};

/// The side on which the larger or smaller of two values has the surface; where it is 0, that on which the one that is
/// not changes its sign.
u8 side_of(double one, double other, Combine combine, double zero);

}  // namespace scanmill::tessellation
