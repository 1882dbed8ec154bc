// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/unit_conversion.hpp"

#include "commands/length_columns.hpp"
#include "scanmill/base/error.hpp"

namespace scanmill::runner {

namespace {

ColumnTable& columns_of(PointCloud& points) { return points.columns; }
ColumnTable& columns_of(TriangleMesh& mesh) { return mesh.vertex_columns; }

template <class T>
std::shared_ptr<const T> rescaled(const T& value, LengthUnit unit) {
    const auto convert = [&](const Vec3& p) {
        return Vec3(p.unaryExpr([&](double length) { return in_unit(length, value.frame.unit, unit); }));
    };
    T scaled = value;
    Array<Vec3> positions(value.positions.size());
    for (std::size_t i = 0; i < positions.size(); ++i) {
        positions[i] = convert(value.positions[i]);
        if (value.positions[i].allFinite() && !positions[i].allFinite())
            throw Error("point {} has a coordinate beyond what a number can hold in {}", i, symbol(unit));
    }
    scaled.positions = std::move(positions);
    scaled.frame.origin = convert(value.frame.origin);
    scaled.frame.unit = unit;
    ColumnTable& columns = columns_of(scaled);
    columns = with_lengths_scaled(columns, in_unit(1, value.frame.unit, unit));
    return std::make_shared<const T>(std::move(scaled));
}

}  // namespace

Value in_other_unit(const Value& value, LengthUnit unit) {
    if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value)) return rescaled(**mesh, unit);
    return rescaled(*std::get<std::shared_ptr<const PointCloud>>(value), unit);
}

}  // namespace scanmill::runner
