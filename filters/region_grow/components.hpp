// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The connected pieces of a grown surface, and which side of each is its outside.

#include "region_grow/surface.hpp"

namespace scanmill::growing {

struct Pieces {
    /// Per place the number of its piece, nobody for unused ones.
    Array<u32> of_place;
    std::size_t count = 0;
};

Pieces find_pieces(const Surface& surface);

/// Turns over what faces inwards: a closed piece by the sign of its volume; open pieces all of one group alike, by that
/// of the volume between them and their centre, or where that is next to nothing (below a hundredth of area^(3/2)) so
/// that the largest component of their summed normal is positive. Turns the triangles alone.
void face_outwards(Surface& surface, const Pieces& pieces, std::span<const u32> groups);

/// Turns the triangles of every piece where at least three quarters of the given normals at its corners point away from
/// them. Of given ones that are zero nothing follows. Cost: linear.
void face_as_given(Surface& surface, const Pieces& pieces, const Array<Vec3>& given);

}  // namespace scanmill::growing
