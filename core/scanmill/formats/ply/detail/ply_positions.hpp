// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The common case of a binary PLY file, as fast as memory: vertices of fixed size whose x, y and z lie side by side as
/// floats or doubles in the machine's own byte order.

#include <optional>

#include "scanmill/data/bounds.hpp"
#include "scanmill/formats/ply/detail/ply_header.hpp"

namespace scanmill {

/// Fills `positions`, one per row, from the rows at the front of `body`, and returns the bounds of the finite ones
/// and whether all are; nothing, without touching them, when the element is no such case.
/// Pre: positions.size() rows are there (require_room() passed); the element has scalars x, y and z.
std::optional<FiniteBounds> widen_packed_positions(std::string_view body, const PlyElement& vertex,
                                                   PlyEncoding encoding, Array<Vec3>& positions);

}  // namespace scanmill
