// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/unit_vectors.hpp"

#include <cmath>

namespace scanmill {

Vec3 unit_or_zero(const Vec3& vector) {
    const double length = vector.norm();
    return length > 0 && std::isfinite(length) ? Vec3(vector / length) : Vec3(Vec3::Zero());
}

Array<Vec3> unit_vectors(const ColumnTable& columns, std::string_view name) {
    Array<Vec3> directions;
    const Column* column = columns.find(name);
    if (!column || column->components() != 3) return directions;
    directions.reserve(column->rows());
    for (std::size_t row = 0; row < column->rows(); ++row)
        directions.push_back(unit_or_zero({column->number(row, 0), column->number(row, 1), column->number(row, 2)}));
    return directions;
}

}  // namespace scanmill
