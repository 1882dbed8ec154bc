// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// LAS files in memory, put together field by field.

#include "core/formats/support.hpp"

namespace scanmill::test {

/// Puts the number's bytes, little-endian, over those at `at`.
template <class T>
void put_at(std::string& bytes, std::size_t at, T number) {
    bytes.replace(at, sizeof(T), bytes_of(number));
}

struct LasBytes {
    u32 minor_version = 2;
    u32 point_format = 0;  ///< as in the header, with the compression bits
    std::array<double, 3> scale{1, 1, 1}, offset{0, 0, 0};
    std::string records;
    u32 record_count = 0;
    /// #points, all of one length.
    std::vector<std::string> points;
    std::string trailing;

    void add_record(std::string_view user, u32 id, std::string_view content) {
        std::string header(54, '\0');
        header.replace(2, user.size(), user);
        put_at(header, 18, static_cast<std::uint16_t>(id));
        put_at(header, 20, static_cast<std::uint16_t>(content.size()));
        records += header;
        records += content;
        ++record_count;
    }

    std::size_t header_size() const { return minor_version < 3 ? 227 : minor_version == 3 ? 235 : 375; }

    std::string file() const {
        std::string bytes(header_size(), '\0');
        bytes.replace(0, 4, "LASF");
        bytes[24] = 1;
        bytes[25] = static_cast<char>(minor_version);
        put_at(bytes, 94, static_cast<std::uint16_t>(header_size()));
        put_at(bytes, 96, static_cast<u32>(header_size() + records.size()));
        put_at(bytes, 100, record_count);
        bytes[104] = static_cast<char>(point_format);
        put_at(bytes, 105, static_cast<std::uint16_t>(points.empty() ? 20 : points[0].size()));
        put_at(bytes, 107, static_cast<u32>(points.size()));
        for (std::size_t axis = 0; axis < 3; ++axis) {
            put_at(bytes, 131 + 8 * axis, scale[axis]);
            put_at(bytes, 155 + 8 * axis, offset[axis]);
        }
        if (minor_version >= 4) put_at(bytes, 247, u64(points.size()));
        bytes += records;
        for (const std::string& point : points) bytes += point;
        return bytes + trailing;
    }
};

/// A point of zeros except its position.
inline std::string las_point(std::size_t size, std::int32_t x, std::int32_t y, std::int32_t z) {
    std::string point(size, '\0');
    put_at(point, 0, x);
    put_at(point, 4, y);
    put_at(point, 8, z);
    return point;
}

/// The description of one kind of extra bytes: 192 bytes.
inline std::string las_extra(u32 type, std::string_view name, u32 options = 0, double scale = 1, double shift = 0) {
    std::string description(192, '\0');
    description[2] = static_cast<char>(type);
    description[3] = static_cast<char>(options);
    description.replace(4, name.size(), name);
    put_at(description, 112, scale);
    put_at(description, 136, shift);
    return description;
}

/// GeoTIFF keys: pairs of key and value.
inline std::string geo_keys(const std::vector<std::pair<int, int>>& keys) {
    std::string content;
    const auto put = [&](int number) { content += bytes_of(static_cast<std::uint16_t>(number)); };
    for (const int number : {1, 1, 0, static_cast<int>(keys.size())}) put(number);
    for (const auto& [key, value] : keys)
        for (const int number : {key, 0, 1, value}) put(number);
    return content;
}

inline std::vector<std::string> column_names(const PointCloud& cloud) {
    std::vector<std::string> names;
    for (const Column& column : cloud.columns) names.push_back(column.name());
    return names;
}

}  // namespace scanmill::test
