// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/polygons.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

namespace {

template <class T>
[[noreturn]] void throw_bad_index(std::string_view element, std::size_t row, T index, std::size_t vertices) {
    throw Error("{} {} names vertex {}; there {} {}, numbered from 0", element, row, +index,
                by_count(vertices, "is", "are"), count_text(vertices, "vertex", "vertices"));
}

template <class T>
u32 checked(T index, std::size_t vertices, std::string_view element, std::size_t row) {
    if constexpr (std::is_floating_point_v<T>) {
        if (!(index >= 0 && index < static_cast<double>(vertices)) || index != std::trunc(index))
            throw_bad_index(element, row, index, vertices);
    } else if (index < T(0) || static_cast<u64>(index) >= vertices) {
        throw_bad_index(element, row, index, vertices);
    }
    return static_cast<u32>(index);
}

}  // namespace

void put_faces(TriangleMesh& mesh, const Column& faces, std::size_t vertices, const ColumnTable& columns,
               const std::function<void(std::string)>& on_warning) {
    const Buffer<u64>& offsets = faces.offsets();
    std::size_t polygons = 0, left_out = 0, total = 0;
    for (std::size_t face = 0; face < faces.rows(); ++face) {
        const u64 corners = offsets[face + 1] - offsets[face];
        if (corners < 3) ++left_out;
        if (corners > 3) ++polygons;
        if (corners >= 3) total += corners - 2;
    }
    require_countable(total, "triangles");
    const bool is_renumbered = polygons + left_out > 0;
    Array<Triangle> triangles(total);
    Array<u32> face_of(is_renumbered ? total : 0);
    visit_scalar(faces.type(), [&](auto zero) {
        const auto corners = faces.values<decltype(zero)>();
        std::size_t made = 0;
        for (std::size_t face = 0; face < faces.rows(); ++face)
            for (u64 begin = offsets[face], i = begin + 2; i < offsets[face + 1]; ++i) {
                if (is_renumbered) face_of[made] = static_cast<u32>(face);
                triangles[made++] = {checked(corners[begin], vertices, "face", face),
                                     checked(corners[i - 1], vertices, "face", face),
                                     checked(corners[i], vertices, "face", face)};
            }
    });
    if (polygons > 0) {
        warn(on_warning, "{} cut into fans; the mesh has {}",
             count_text(polygons, "face of more than three corners was", "faces of more than three corners were"),
             count_text(total, "triangle", "triangles"));
        for (const Column& column : columns)
            if (column.is_list())
                warn(on_warning,
                     "the column '{}' has a list for every face; each triangle of a face that was cut has the whole "
                     "list, so values for corners do not fit the triangle",
                     column.name());
    }
    if (left_out > 0)
        warn(on_warning, "{} left out",
             count_text(left_out, "face of fewer than three corners was", "faces of fewer than three corners were"));
    mesh.face_columns = is_renumbered ? columns.gather(face_of) : columns;
    mesh.triangles = std::move(triangles);
}

Array<Triangle> triangles_of_strips(const Column& strips, std::size_t vertices) {
    Array<Triangle> triangles;
    visit_scalar(strips.type(), [&](auto zero) {
        const auto numbers = strips.values<decltype(zero)>();
        for (std::size_t strip = 0; strip < strips.rows(); ++strip) {
            u32 a = 0, b = 0;
            std::size_t length = 0;
            for (u64 i = strips.offsets()[strip]; i < strips.offsets()[strip + 1]; ++i) {
                if (numbers[i] == static_cast<decltype(zero)>(-1)) {
                    length = 0;
                    continue;
                }
                const u32 c = checked(numbers[i], vertices, "triangle strip", strip);
                if (++length >= 3 && a != b && b != c && c != a)
                    triangles.push_back(length % 2 == 1 ? Triangle{a, b, c} : Triangle{b, a, c});
                a = b;
                b = c;
            }
        }
    });
    require_countable(triangles.size(), "triangles");
    return triangles;
}

Array<u32> vertex_numbers(const Column& column, std::size_t vertices, std::string_view element) {
    Array<u32> numbers(column.rows());
    visit_scalar(column.type(), [&](auto zero) {
        const auto values = column.values<decltype(zero)>();
        for (std::size_t row = 0; row < numbers.size(); ++row)
            numbers[row] = checked(values[row], vertices, element, row);
    });
    return numbers;
}

}  // namespace scanmill
