// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Scan files of many points, some of which can be read piece by piece.

#include <fmt/format.h>

#include <string>

#include "scanmill/formats/files.hpp"

namespace scanmill::test {

/// `count` points on a helix around `middle`, with normals, colours and a number each: as binary PLY more than one
/// piece from 2^16 points on.
inline PointCloud helix(std::size_t count, const Vec3& middle = Vec3::Zero()) {
    Array<Vec3> positions(count);
    Array<float> normals(3 * count);
    Array<u8> colours(3 * count);
    Array<double> numbers(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double turn = static_cast<double>(i) * 0.37, height = static_cast<double>(i) / static_cast<double>(count);
        const Vec3 outward(std::cos(turn), std::sin(turn), 0);
        positions[i] = (middle + outward + Vec3(0, 0, height)).cast<float>().cast<double>();
        for (std::size_t axis = 0; axis < 3; ++axis) {
            normals[3 * i + axis] = static_cast<float>(outward[static_cast<int>(axis)]);
            colours[3 * i + axis] = static_cast<u8>(i * (axis + 1));
        }
        numbers[i] = static_cast<double>(i) / 3;
    }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    cloud.columns.add(Column("normal", 3, Buffer<float>(std::move(normals))));
    cloud.columns.add(Column("colour", 3, Buffer<u8>(std::move(colours))));
    cloud.columns.add(Column("number", 1, Buffer<double>(std::move(numbers))));
    return cloud;
}

/// The file's path as text; its extension decides the format.
inline std::string written(const std::filesystem::path& path, PointCloud cloud) {
    write_file(path, std::make_shared<const PointCloud>(std::move(cloud)));
    return path.string();
}

inline PointCloud without_columns(PointCloud cloud) {
    cloud.columns = {};
    return cloud;
}

}  // namespace scanmill::test
