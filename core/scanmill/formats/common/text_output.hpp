// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The columns that text formats write beside the coordinates, and their numbers as text.

#include <span>
#include <string_view>
#include <vector>

#include "scanmill/data/columns.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

/// nullptr where a column is absent or of another form.
struct TextColumns {
    explicit TextColumns(const ColumnTable& columns);

    const Column* normal = nullptr;   ///< 3 × float32 or float64
    const Column* colour = nullptr;   ///< 3 or 4 × uint8
    const Column* texture = nullptr;  ///< 2 × float32 or float64

    /// Of those that are there, for warn_left_out().
    std::vector<std::string_view> names() const;
};

/// One float32 or float64 for each row.
bool is_plain_number(const Column& column);

/// A blank and a number for each component of a row, as the shortest decimals that read back equal in the column's own
/// type: those of a float are fewer than those of the same double. Pre: the column is one of
/// TextColumns', or a plain number.
void put_row(const Column& column, std::size_t row, OutputBuffer& out);

}  // namespace scanmill
