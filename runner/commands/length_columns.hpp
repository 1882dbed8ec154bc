// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Which columns beside the coordinates are in the scan's unit: all that the filters make.

#include "scanmill/data/columns.hpp"

namespace scanmill::runner {

/// The columns with those that are lengths multiplied by `factor` and those that are one over a length divided by it,
/// as double: `bin-size`, `local-bin-size` and `fit-error`; `curvature-1` and `curvature-2`. Others stay as they are:
/// nobody said what they are in.
ColumnTable with_lengths_scaled(const ColumnTable& columns, double factor);

}  // namespace scanmill::runner
