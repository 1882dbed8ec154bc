// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The same points or mesh with its lengths told in another unit.

#include "scanmill/kinds/value.hpp"

namespace scanmill::runner {

/// Columns that are known to be lengths are scaled as well (see length_columns.hpp). Pre: points or a mesh, of a known
/// unit. Throws Error for coordinates that leave double's range.
Value in_other_unit(const Value& value, LengthUnit unit);

}  // namespace scanmill::runner
