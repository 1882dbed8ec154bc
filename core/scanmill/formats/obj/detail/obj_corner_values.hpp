// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Values that OBJ lists apart from the vertices and that faces bind to their corners, normals or texture coordinates:
/// from corners to a column of the vertices.
///
/// A vertex gets the value that its corners name, if all that name one name equal ones; values are compared, not their
/// numbers. A vertex whose corners name none, or that has no corner, gets the value of its own number when values and
/// vertices correspond one to one wherever a face says so, else zeros, which is told. When no face names any value,
/// they belong to the vertices of equal number if there are as many; where faces exist that is told. In every other
/// case no column is made, and why is told with numbers.

#include <functional>
#include <span>
#include <string>
#include <string_view>

#include "scanmill/data/columns.hpp"

namespace scanmill {

class ObjCornerValues {
public:
    /// `what` names the values in messages: "normals (vn)".
    ObjCornerValues(std::string column, std::string_view what, std::size_t components)
        : column_(std::move(column)),
          what_(what),
          components_(components) {}

    /// The next number of the list; `components` of them make a value.
    void add_number(double number) { numbers_.push_back(number); }
    /// Corner `corner`, counted over all faces, names a value as the file spells it: from 1, or backwards from the
    /// latest when negative. Pre: corners come in order.
    void add_reference(std::size_t corner, std::int64_t spelled) {
        value_of_.resize(corner, none);
        value_of_.push_back(index_of(spelled));
    }

    /// Adds the column for `vertices`. Pre: every element of `corners`, the vertex of each corner, is below `vertices`.
    void add_column(ColumnTable& columns, std::span<const u32> corners, std::size_t vertices,
                    const std::function<void(std::string)>& on_warning);

private:
    static constexpr u32 none = ~u32(0), missing = none - 1, several = none - 2;

    std::size_t count() const { return numbers_.size() / components_; }
    u32 index_of(std::int64_t spelled) const;
    bool are_equal(u32 a, u32 b) const;
    /// The value of every vertex: a number, none or several.
    Array<u32> values_of_vertices(std::span<const u32> corners, std::size_t vertices) const;
    void warn_unused(const std::function<void(std::string)>& on_warning) const;
    Array<double> gathered(std::span<const u32> value_of_vertex) const;

    std::string column_;
    std::string_view what_;
    std::size_t components_;
    Array<double> numbers_;
    Array<u32> value_of_;  // of each corner; shorter when the last corners name none
};

}  // namespace scanmill
