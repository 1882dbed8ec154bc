// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/obj/detail/obj_corner_values.hpp"

#include <algorithm>

#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

u32 ObjCornerValues::index_of(std::int64_t spelled) const {
    // A value may follow the face that names it: whether it is there at all is known at the end.
    if (spelled > 0) return spelled <= several ? static_cast<u32>(spelled - 1) : missing;
    const auto latest = static_cast<std::int64_t>(count());
    if (spelled == 0 || spelled < -latest || latest + spelled >= several) return missing;
    return static_cast<u32>(latest + spelled);
}

bool ObjCornerValues::are_equal(u32 a, u32 b) const {
    for (std::size_t i = 0; i < components_; ++i) {
        const double x = numbers_[a * components_ + i], y = numbers_[b * components_ + i];
        if (x != y && !(x != x && y != y)) return false;
    }
    return true;
}

Array<u32> ObjCornerValues::values_of_vertices(std::span<const u32> corners, std::size_t vertices) const {
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

void ObjCornerValues::warn_unused(const std::function<void(std::string)>& on_warning) const {
    std::vector<bool> used(count());
    for (u32 value : value_of_)
        if (value != none) used[value] = true;
    if (const auto unused = std::ranges::count(used, false); unused > 0)
        warn(on_warning, "{} of {} {} were left out: no face names them", unused, count(), what_);
}

Array<double> ObjCornerValues::gathered(std::span<const u32> value_of_vertex) const {
    Array<double> numbers(value_of_vertex.size() * components_);
    for (std::size_t vertex = 0; vertex < value_of_vertex.size(); ++vertex)
        for (std::size_t i = 0; i < components_; ++i) {
            const u32 value = value_of_vertex[vertex];
            numbers[vertex * components_ + i] = value == none ? 0 : numbers_[value * components_ + i];
        }
    return numbers;
}

void ObjCornerValues::add_column(ColumnTable& columns, std::span<const u32> corners, std::size_t vertices,
                                 const std::function<void(std::string)>& on_warning) {
    const auto add = [&](Array<double> numbers) {
        columns.add(Column(column_, static_cast<u32>(components_), Buffer(std::move(numbers))));
    };
    if (std::ranges::all_of(value_of_, [](u32 value) { return value == none; })) {
        if (count() == 0) return;
        if (count() != vertices)
            return warn(on_warning, "the {} {} were left out: no face names them, and there {} {}", count(), what_,
                        by_count(vertices, "is", "are"), count_text(vertices, "vertex", "vertices"));
        if (!corners.empty())
            warn(on_warning, "no face names the {} {}: they were given to the vertices of equal number", count(),
                 what_);
        return add(std::move(numbers_));
    }
    const auto absent = std::ranges::count_if(value_of_, [&](u32 value) { return value != none && value >= count(); });
    if (absent > 0)
        return warn(on_warning,
                    "the {} were left out: {} of {} corners of faces name one that is not there; there are {}", what_,
                    absent, corners.size(), count());

    const Array<u32> value_of_vertex = values_of_vertices(corners, vertices);
    if (const auto unclear = std::ranges::count(value_of_vertex, several); unclear > 0)
        return warn(on_warning, "the {} were left out: at {} of {} vertices they differ from face to face", what_,
                    unclear, vertices);
    bool one_to_one = count() == vertices;
    for (u32 vertex = 0; vertex < vertices && one_to_one; ++vertex)
        one_to_one = value_of_vertex[vertex] == vertex || value_of_vertex[vertex] == none;
    if (one_to_one) return add(std::move(numbers_));

    warn_unused(on_warning);
    if (const auto without = std::ranges::count(value_of_vertex, none); without > 0)
        warn(on_warning, "{} of {} vertices have none of the {}: they were given zeros", without, vertices, what_);
    add(gathered(value_of_vertex));
}

}  // namespace scanmill
