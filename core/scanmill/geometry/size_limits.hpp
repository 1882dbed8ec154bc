// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How large and how small a scan may be: whether distances are doubles, and whether their squares are.

#include <string_view>

#include "scanmill/data/points.hpp"

namespace scanmill {

/// Throws Error, with the range of the coordinates, when the diagonal of their box is larger than any double: finite
/// coordinates may still lie that far apart.
void require_finite_size(const BoundingBox& box);

/// Throws Error unless `size`, a diagonal, is between 1e-100 and 1e100: then squares of lengths are numbers that have
/// all their digits, down to lengths of 1e-50 of the size. `needing` begins the sentence: "needs a mesh".
void require_squares(double size, std::string_view needing);

}  // namespace scanmill
