// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/length_columns.hpp"

#include <algorithm>
#include <array>
#include <string_view>

namespace scanmill::runner {

namespace {

struct LengthColumn {
    std::string_view name;
    bool is_inverse;
};

constexpr std::array<LengthColumn, 5> length_columns{{{"bin-size", false},
                                                      {"local-bin-size", false},
                                                      {"fit-error", false},
                                                      {"curvature-1", true},
                                                      {"curvature-2", true}}};

}  // namespace

ColumnTable with_lengths_scaled(const ColumnTable& columns, double factor) {
    ColumnTable scaled;
    for (const Column& column : columns) {
        const auto known = std::ranges::find(length_columns, column.name(), &LengthColumn::name);
        if (known == length_columns.end() || column.is_list()) {
            scaled.add(column);
            continue;
        }
        Array<double> values(column.rows() * column.components());
        for (std::size_t row = 0; row < column.rows(); ++row)
            for (u32 component = 0; component < column.components(); ++component) {
                const double value = column.number(row, component);
                values[row * column.components() + component] = known->is_inverse ? value / factor : value * factor;
            }
        scaled.add(Column(column.name(), column.components(), Buffer<double>(std::move(values))));
    }
    return scaled;
}

}  // namespace scanmill::runner
