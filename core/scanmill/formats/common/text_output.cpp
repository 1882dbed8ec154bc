// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_output.hpp"

namespace scanmill {

namespace {

bool has_floats(const Column& column, u32 components) {
    return column.components() == components &&
           (column.type() == ScalarType::float32 || column.type() == ScalarType::float64);
}

template <class T>
void put_numbers(const Column& column, std::size_t row, OutputBuffer& out) {
    const auto values = column.values<T>().subspan(row * column.components(), column.components());
    for (const T value : values) {
        out.text(" ");
        out.number(value);
    }
}

}  // namespace

TextColumns::TextColumns(const ColumnTable& columns) {
    if (const Column* column = columns.find("normal"); column && has_floats(*column, 3)) normal = column;
    if (const Column* column = columns.find("texture"); column && has_floats(*column, 2)) texture = column;
    const Column* column = columns.find("colour");
    if (column && column->type() == ScalarType::uint8 && (column->components() == 3 || column->components() == 4))
        colour = column;
}

std::vector<std::string_view> TextColumns::names() const {
    std::vector<std::string_view> names;
    for (const Column* column : {normal, colour, texture})
        if (column) names.push_back(column->name());
    return names;
}

bool is_plain_number(const Column& column) { return has_floats(column, 1); }

void put_row(const Column& column, std::size_t row, OutputBuffer& out) {
    switch (column.type()) {
        case ScalarType::float32: return put_numbers<float>(column, row, out);
        case ScalarType::float64: return put_numbers<double>(column, row, out);
        default: return put_numbers<u8>(column, row, out);
    }
}

}  // namespace scanmill
