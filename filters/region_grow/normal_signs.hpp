// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether the signs of given normals tell the surface's sides, or nobody oriented them.

#include <vector>

#include "region_grow/neighbourhoods.hpp"

namespace scanmill::growing {

/// Places whose normal and that of their nearest neighbour differ by more than 120 degrees.
struct OpposedNormals {
    std::size_t count = 0;
    /// Of these, such whose neighbour lies behind them, as on the other side of a sheet; in front, as across a slit.
    std::size_t behind = 0, in_front = 0;

    /// More than one place in a hundred is opposed, and not because of thin sheets or slits, where nearly all
    /// neighbours would lie on the same side: at least a quarter of them lie on each, or in the plane.
    bool are_mixed(std::size_t places) const {
        const std::size_t one_sided = behind > in_front ? behind : in_front;
        return 100 * count > places && 4 * one_sided <= 3 * count;
    }
};

/// `given`: which places have one. Neighbours without are passed over. Cost: linear.
OpposedNormals opposed_normals(const Samples& samples, const Neighbourhoods& neighbourhoods,
                               const Array<Vec3>& directions, const std::vector<bool>& given);

}  // namespace scanmill::growing
