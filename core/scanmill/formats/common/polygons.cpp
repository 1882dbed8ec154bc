// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/polygons.hpp"

#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
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

/// Counts before anything is stored: triangles, polygons, short faces.
std::size_t count_triangles(const Buffer<u64>& offsets, Fans& fans) {
    u64 triangles = 0;
    for (std::size_t face = 0; face + 1 < offsets.size(); ++face) {
        const u64 corners = offsets[face + 1] - offsets[face];
        if (corners < 3) ++fans.left_out;
        if (corners > 3) ++fans.polygons;
        if (corners >= 3) triangles += corners - 2;
    }
    require_countable(triangles, "triangles");
    return triangles;
}

}  // namespace

Fans triangulated(const Column& faces, std::size_t vertices) {
    Fans fans;
    fans.triangles.resize(count_triangles(faces.offsets(), fans));
    const bool renumbered = fans.polygons + fans.left_out > 0;
    if (renumbered) fans.face_of.resize(fans.triangles.size());
    visit_scalar(faces.type(), [&](auto zero) {
        const auto corners = faces.values<decltype(zero)>();
        std::size_t made = 0;
        for (std::size_t face = 0; face < faces.rows(); ++face) {
            const u64 begin = faces.offsets()[face];
            const u64 end = faces.offsets()[face + 1];
            for (u64 i = begin + 2; i < end; ++i) {
                if (renumbered) fans.face_of[made] = static_cast<u32>(face);
                fans.triangles[made++] = {checked(corners[begin], vertices, "face", face),
                                          checked(corners[i - 1], vertices, "face", face),
                                          checked(corners[i], vertices, "face", face)};
            }
        }
    });
    return fans;
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

void put_faces(TriangleMesh& mesh, Fans fans, const ColumnTable& columns,
               const std::function<void(std::string)>& on_warning) {
    if (fans.polygons > 0)
        warn(on_warning, "{} cut into fans; the mesh has {}",
             count_text(fans.polygons, "face of more than three corners was", "faces of more than three corners were"),
             count_text(fans.triangles.size(), "triangle", "triangles"));
    if (fans.polygons > 0)
        for (const Column& column : columns)
            if (column.is_list())
                warn(on_warning,
                     "the column '{}' has a list for every face: the triangles of a face that was cut carry its whole "
                     "list, so what it says of the corners no longer fits theirs",
                     column.name());
    if (fans.left_out > 0)
        warn(on_warning, "{} left out",
             count_text(fans.left_out, "face of fewer than three corners was",
                        "faces of fewer than three corners were"));
    mesh.face_columns = fans.polygons + fans.left_out > 0 ? columns.gather(fans.face_of) : columns;
    mesh.triangles = std::move(fans.triangles);
}

}  // namespace scanmill
