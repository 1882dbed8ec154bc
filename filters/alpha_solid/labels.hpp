// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What cells count as while a solid is being chosen.

#include "scanmill/data/array.hpp"

namespace scanmill::alpha {

/// Only `solid` cells are in the solid that is being chosen.
enum Label : u8 {
    outside = 0,
    solid = 1,
    left_out = 2  ///< in the alpha-solid, but in a piece of it that is not kept
};

}  // namespace scanmill::alpha
