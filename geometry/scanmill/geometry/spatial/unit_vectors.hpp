// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "scanmill/data/array.hpp"
#include "scanmill/data/columns.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// The unit vector with the direction of `vector`; zero if the vector is zero or not finite.
Vec3 unit_or_zero(const Vec3& vector);

/// unit_or_zero() of each row of a column of directions, such as `normal`. Empty if there is no such column, or if it
/// does not have three numbers in each row.
Array<Vec3> unit_vectors(const ColumnTable& columns, std::string_view name);

}  // namespace scanmill
