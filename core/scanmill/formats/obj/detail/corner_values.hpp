// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Normals or texture coordinates of OBJ, which faces assign to their corners, as a column of the vertices.

#include <algorithm>

#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

/// The column has a value for every vertex:
/// - If faces refer to values, a vertex gets the value of its corners. All its corners that refer to a value must refer
///   to equal values; the values are compared, not their numbers.
/// - A vertex whose corners refer to no value gets zeros, with a warning. It gets the value of its own number instead
///   if there are as many values as vertices and every other vertex has the value of its own number, too.
/// - If no face refers to a value and there are as many values as vertices, every vertex gets the value of its own
///   number, with a warning if there are faces.
/// In all other cases no column is added; a warning contains the reason with numbers.
class CornerValues {
public:
    /// `name` names the values in messages: "normals (vn)".
    CornerValues(std::string column, std::string_view name, std::size_t components)
        : column_(std::move(column)),
          name_(name),
          components_(components) {}

    /// Adds the next number of the list of values; `components` numbers make a value.
    void add_number(double number) { numbers_.push_back(number); }

    /// Records that corner `corner`, counted over all faces, refers to a value. `spelled` is the number in the file: it
    /// counts from 1, or backwards from the latest value if negative. Pre: corners come in order.
    void add_reference(std::size_t corner, std::int64_t spelled) {
        // A value may follow the face that refers to it. Whether a value with a positive number exists is therefore
        // checked at the end.
        const auto latest = static_cast<std::int64_t>(count());
        const std::int64_t index = spelled > 0 ? spelled - 1 : latest + spelled;
        value_of_.resize(corner, none);
        value_of_.push_back(spelled == 0 || index < 0 || index >= several ? missing : static_cast<u32>(index));
    }

    /// Adds a column with `vertices` rows. `corners` contains the vertex of each corner. Pre: every element of
    /// `corners` is below `vertices`.
    void add_column(ColumnTable& columns, std::span<const u32> corners, std::size_t vertices,
                    const std::function<void(std::string)>& on_warning) {
        const auto add = [&](Array<double> numbers) {
            columns.add(Column(column_, static_cast<u32>(components_), Buffer(std::move(numbers))));
        };
        const auto is_none = [](u32 value) { return value == none; };
        if (std::ranges::all_of(value_of_, is_none)) {
            if (count() == 0) return;
            if (count() != vertices)
                return warn(on_warning, "the {} {} were left out: no face names them, and there {} {}", count(), name_,
                            by_count(vertices, "is", "are"), count_text(vertices, "vertex", "vertices"));
            if (!corners.empty())
                warn(on_warning, "no face names the {} {}: they were given to the vertices of equal number", count(),
                     name_);
            return add(std::move(numbers_));
        }
        const auto absent =
            std::ranges::count_if(value_of_, [&](u32 value) { return !is_none(value) && value >= count(); });
        if (absent > 0)
            return warn(on_warning, "the {} were left out: {} of {} corners of faces name a missing one; there are {}",
                        name_, absent, corners.size(), count());

        const Array<u32> value_of_vertex = values_of_vertices(corners, vertices);
        if (const auto unclear = std::ranges::count(value_of_vertex, several); unclear > 0)
            return warn(on_warning, "the {} were left out: at {} of {} vertices they differ from face to face", name_,
                        unclear, vertices);
        bool one_to_one = count() == vertices;
        for (u32 vertex = 0; vertex < vertices && one_to_one; ++vertex)
            one_to_one = value_of_vertex[vertex] == vertex || is_none(value_of_vertex[vertex]);
        if (one_to_one) return add(std::move(numbers_));

        std::vector<bool> used(count());
        for (u32 value : value_of_)
            if (!is_none(value)) used[value] = true;
        if (const auto unused = std::ranges::count(used, false); unused > 0)
            warn(on_warning, "{} of {} {} were left out: no face names them", unused, count(), name_);
        if (const auto without = std::ranges::count_if(value_of_vertex, is_none); without > 0)
            warn(on_warning, "{} of {} vertices have none of the {}: they were given zeros", without, vertices, name_);
        Array<double> gathered;
        gathered.reserve(vertices * components_);
        for (const u32 value : value_of_vertex)
            for (std::size_t i = 0; i < components_; ++i)
                gathered.push_back(is_none(value) ? 0 : numbers_[value * components_ + i]);
        add(std::move(gathered));
    }

private:
    static constexpr u32 none = ~u32(0), missing = none - 1, several = none - 2;

    std::size_t count() const { return numbers_.size() / components_; }

    bool are_equal(u32 a, u32 b) const {
        for (std::size_t i = 0; i < components_; ++i) {
            const double x = numbers_[a * components_ + i], y = numbers_[b * components_ + i];
            if (x != y && !(std::isnan(x) && std::isnan(y))) return false;
        }
        return true;
    }

    /// The value of every vertex: its index, `none` or `several`.
    Array<u32> values_of_vertices(std::span<const u32> corners, std::size_t vertices) const {
        Array<u32> values(vertices, none);
        for (std::size_t corner = 0; corner < value_of_.size(); ++corner) {
            if (value_of_[corner] == none) continue;
            u32& value = values[corners[corner]];
            if (value == none)
                value = value_of_[corner];
            else if (value != several && value != value_of_[corner] && !are_equal(value, value_of_[corner]))
                value = several;
        }
        return values;
    }

    std::string column_;
    std::string_view name_;
    std::size_t components_;
    Array<double> numbers_;
    Array<u32> value_of_;  // indexed by corner; shorter if the last corners refer to no value
};

}  // namespace scanmill
