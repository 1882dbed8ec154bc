// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Clouds and meshes with columns, for the tests of transfer.

#include <gtest/gtest.h>

#include <vector>

#include "support/shapes.hpp"
#include "transfer/transfer.hpp"

namespace scanmill::test {

template <class T>
Column column_of(std::string name, u32 components, std::vector<T> values) {
    return Column(std::move(name), components, Buffer<T>(Array<T>(values.begin(), values.end())));
}

inline PointCloud with(PointCloud cloud, Column column) {
    cloud.columns.add(std::move(column));
    return cloud;
}
inline TriangleMesh with(TriangleMesh mesh, Column column) {
    mesh.vertex_columns.add(std::move(column));
    return mesh;
}

/// The numbers of a column, row by row; a failure without such a column.
inline std::vector<double> numbers_in(const ColumnTable& columns, std::string_view name) {
    std::vector<double> numbers;
    const Column* column = columns.find(name);
    EXPECT_TRUE(column) << name;
    if (!column) return numbers;
    for (std::size_t row = 0; row < column->rows(); ++row)
        for (u32 component = 0; component < column->components(); ++component)
            numbers.push_back(column->number(row, component));
    return numbers;
}
inline std::vector<double> numbers_in(const PointCloud& cloud, std::string_view name) {
    return numbers_in(cloud.columns, name);
}
inline std::vector<double> numbers_in(const TriangleMesh& mesh, std::string_view name) {
    return numbers_in(mesh.vertex_columns, name);
}

inline TransferParams columns_within(std::vector<std::string> names, double max_distance,
                                     TransferParams::Method method = TransferParams::Method::blend) {
    TransferParams params;
    params.columns = std::move(names);
    params.max_distance = Length(max_distance);
    params.method = method;
    return params;
}

template <class From, class To>
TransferResult<To> carried(const From& from, const To& to, const TransferParams& params) {
    Context context;
    return transfer(from, to, params, context);
}

}  // namespace scanmill::test
