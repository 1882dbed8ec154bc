// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether the signs of given normals tell the surface's sides, or nobody oriented them.

#include <vector>

#include "region_grow/pieces.hpp"

namespace scanmill::growing {

/// Places whose normal and that of their nearest neighbour are opposed: by more than 154 degrees, which neither ridges
/// nor grooves down to 26 degrees make of it.
struct OpposedNormals {
    std::size_t count = 0;
    /// Of these, such whose neighbour lies behind them, as on the other side of a sheet; in front, as across a slit;
    /// and nearly in their plane (within 17 degrees), as of one surface.
    std::size_t behind = 0, in_front = 0, beside = 0;

    /// Nearly all on the same side: they are the other side of a thin sheet or slit.
    bool are_on_one_side() const { return 4 * (behind > in_front ? behind : in_front) > 3 * count; }
    /// More than one place in a hundred is opposed to one beside it, and not for being thin.
    bool are_mixed(std::size_t places) const { return 100 * beside > places && !are_on_one_side(); }

    /// Pre: the place's normal and the other's are opposed.
    void add(const Vec3& normal, const Vec3& offset_of_other);
};

/// `given`: which places have one. Neighbours without are passed over. Cost: linear.
OpposedNormals opposed_normals(const Samples& samples, const Neighbourhoods& neighbourhoods,
                               const Array<Vec3>& directions, const std::vector<bool>& given);

/// Places on the border beside one on the border whose normal is opposed, in their plane: the surface ends there only
/// because the given normals say so; none where they are on one side. Pre: the normals' signs count. Cost: linear.
std::size_t places_at_seams(const Surface& surface);

/// Turns the triangles of every piece where at least three quarters of the given normals at its corners point away from
/// them. Of given ones that are zero nothing follows. Cost: linear.
void face_as_given(Surface& surface, const Pieces& pieces, const Array<Vec3>& given);

}  // namespace scanmill::growing
