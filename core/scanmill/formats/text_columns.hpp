// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// From the numbers behind x, y and z in the rows of a text to named columns.
///
/// With names: a normal's three columns become `normal` (float64), a colour's three or four `colour` (uint8) when every
/// number is whole, from 0 to 255, and not all are 0 or 1 (1 may be the faintest or the full channel); otherwise they
/// stay columns of their own, which is told. Every other column keeps its name (float64). Normals that are not of unit
/// length are told.
///
/// Without names: three columns are `normal` when every row that is not zero has unit length within a tenth. In Leica's
/// PTS layout one column is `intensity`, four are `intensity` and `colour`, three that are no normals are `colour`,
/// under the same condition. Everything else is numbered from c4; three that are no unit normals are told.

#include <functional>

#include "scanmill/data/columns.hpp"

namespace scanmill {

/// Pre: `values` are of equal length; `names` is empty or has one for each of them. Throws Error when two columns have
/// one name.
ColumnTable text_columns(std::vector<std::string> names, std::vector<Array<double>> values, bool is_pts,
                         const std::function<void(std::string)>& on_warning);

/// Three columns of `rows` rows as normals, when every row that is not zero has about unit length.
bool are_unit_normals(std::span<const Array<double>* const> components);

/// Components side by side in one column.
Column joined(std::string name, std::span<const Array<double>* const> components);

/// The same as uint8 `colour`, when text_columns() calls it a colour.
std::optional<Column> as_colour(std::span<const Array<double>* const> components);

}  // namespace scanmill
