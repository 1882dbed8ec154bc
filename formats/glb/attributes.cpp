// SPDX-License-Identifier: GPL-3.0-or-later
#include "glb/attributes.hpp"

#include <tiny_gltf.h>

#include <cmath>
#include <limits>
#include <optional>

#include "scanmill/base/elementary.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/writing.hpp"

namespace scanmill::glb {

namespace {

constexpr u32 most_components = 4;

template <class T>
void put(unsigned char* to, T number) {
    std::memcpy(to, &number, sizeof(T));
}

Vec3 row_of(const Column& column, std::size_t row) {
    return {column.number(row, 0), column.number(row, 1), column.number(row, 2)};
}

bool is_normal(const Column& column) { return column.name() == "normal" && column.components() == 3; }

bool is_colour(const Column& column) {
    return column.name() == "colour" && column.type() == ScalarType::uint8 &&
           (column.components() == 3 || column.components() == 4);
}

std::size_t rows_without_direction(const Column& column) {
    std::size_t count = 0;
    for (std::size_t row = 0; row < column.rows(); ++row) {
        const double length = row_of(column, row).stableNorm();
        count += !(length > 0 && std::isfinite(length));
    }
    return count;
}

Attribute normal_attribute(const Column& column) {
    const auto fill = [&column](unsigned char* at) {
        for (std::size_t row = 0; row < column.rows(); ++row, at += 3 * sizeof(float)) {
            const Eigen::Vector3f normal = y_up(row_of(column, row).stableNormalized()).cast<float>();
            std::memcpy(at, normal.data(), 3 * sizeof(float));
        }
    };
    return {"NORMAL", TINYGLTF_COMPONENT_TYPE_FLOAT, 3, false, fill};
}

/// The linear value of every byte of sRGB (IEC 61966-2-1), from 0 to 65535.
std::array<std::uint16_t, 256> linear_fractions() {
    std::array<std::uint16_t, 256> table;
    for (std::size_t byte = 0; byte < table.size(); ++byte) {
        const double c = static_cast<double>(byte) / 255;
        const double linear = c <= 0.04045 ? c / 12.92 : elementary::pow((c + 0.055) / 1.055, 2.4);
        table[byte] = static_cast<std::uint16_t>(std::lround(65535 * linear));
    }
    return table;
}

Attribute colour_attribute(const Column& column) {
    const auto fill = [&column](unsigned char* at) {
        const auto linear = linear_fractions();
        const u8* channels = column.values<u8>().data();
        const u32 count = column.components();
        for (std::size_t row = 0; row < column.rows(); ++row, channels += count, at += 4 * sizeof(std::uint16_t)) {
            for (u32 channel = 0; channel < 3; ++channel) put(at + 2 * channel, linear[channels[channel]]);
            constexpr std::uint16_t per_step = 257;  // 255 × 257 = 65535
            put(at + 6, static_cast<std::uint16_t>(count == 4 ? channels[3] * per_step : 65535));
        }
    };
    return {"COLOR_0", TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT, 4, true, fill};
}

template <class T>
constexpr int component_type() {
    if constexpr (std::is_same_v<T, std::int8_t>) return TINYGLTF_COMPONENT_TYPE_BYTE;
    if constexpr (std::is_same_v<T, std::uint8_t>) return TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE;
    if constexpr (std::is_same_v<T, std::int16_t>) return TINYGLTF_COMPONENT_TYPE_SHORT;
    if constexpr (std::is_same_v<T, std::uint16_t>) return TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT;
    return TINYGLTF_COMPONENT_TYPE_FLOAT;
}

/// Writes every number of the column with the matching type of glTF.
template <class T>
Attribute number_attribute(const Column& column) {
    using Written = std::conditional_t<component_type<T>() == TINYGLTF_COMPONENT_TYPE_FLOAT, float, T>;
    Attribute attribute{"", component_type<T>(), column.components(), false, {}};
    attribute.fill = [&column, stride = attribute.stride()](unsigned char* at) {
        const T* number = column.values<T>().data();
        for (std::size_t row = 0; row < column.rows(); ++row, at += stride)
            for (u32 component = 0; component < column.components(); ++component, ++number)
                put(at + component * sizeof(Written), static_cast<Written>(*number));
    };
    return attribute;
}

struct Fitness {
    std::size_t not_finite = 0, too_large = 0, rounded = 0;
};

/// Counts the numbers that float cannot hold. Integers of 32 and 64 bits count as rounded if they are beyond 2^24.
template <class T>
Fitness fitness_of(std::span<const T> numbers) {
    Fitness found;
    for (const T number : numbers) {
        if constexpr (std::is_floating_point_v<T>) {
            if (!std::isfinite(number))
                ++found.not_finite;
            else if (!std::isfinite(static_cast<float>(number)))
                ++found.too_large;
            else
                found.rounded += static_cast<T>(static_cast<float>(number)) != number;
        } else if constexpr (sizeof(T) >= sizeof(float)) {
            constexpr T exact = T(1) << std::numeric_limits<float>::digits;
            const bool is_exact = number <= exact && (std::is_unsigned_v<T> || number >= T(0) - exact);
            found.rounded += !is_exact;
        }
    }
    return found;
}

/// The reason why glTF cannot hold the column; empty if it can. Warns if doubles are rounded.
std::string why_left_out(const Column& column, const WriteOptions& options) {
    if (column.is_list()) return "it holds lists";
    if (column.components() > most_components)
        return fmt::format("it has {} numbers per row; glTF allows at most {}", column.components(), most_components);
    const Fitness found = visit_scalar(column.type(), [&]<class T>(T) { return fitness_of(column.values<T>()); });
    if (found.not_finite > 0)
        return fmt::format("{} NaN or infinite, which glTF does not allow",
                           count_text(found.not_finite, "of its numbers is", "of its numbers are"));
    if (found.too_large > 0)
        return fmt::format("{} beyond the range of its single precision",
                           count_text(found.too_large, "of its numbers is", "of its numbers are"));
    if (found.rounded > 0 && column.type() != ScalarType::float64)
        return fmt::format("{} beyond 2^24, where its single precision would change whole numbers",
                           count_text(found.rounded, "of its numbers is", "of its numbers are"));
    if (found.rounded > 0)
        warn(options.on_warning, "GLB rounded the column '{}' to single precision; PLY keeps it", column.name());
    return "";
}

/// "Ring no" → "_RING NO". Only ASCII letters are changed.
std::string upper_case(std::string_view name) {
    std::string upper = "_";
    for (const char c : name) upper += c >= 'a' && c <= 'z' ? static_cast<char>(c - 'a' + 'A') : c;
    return upper;
}

std::string identifier(std::string text) {
    for (char& c : text)
        if (!(c >= 'A' && c <= 'Z') && !(c >= '0' && c <= '9')) c = '_';
    return text;
}

}  // namespace

std::size_t Attribute::stride() const {
    const auto size = static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<u32>(component_type)));
    return (components * size + 3) / 4 * 4;
}

std::vector<Attribute> attributes_of(const ColumnTable& columns, const WriteOptions& options) {
    WrittenNames names("GLB", options);
    std::vector<Attribute> attributes;
    for (const Column& column : columns) {
        const std::size_t lost = is_normal(column) ? rows_without_direction(column) : 0;
        if (is_normal(column) && lost == 0) {
            attributes.push_back(normal_attribute(column));
        } else if (is_colour(column)) {
            attributes.push_back(colour_attribute(column));
        } else if (const std::string reason = why_left_out(column, options); !reason.empty()) {
            if (!options.added_columns.contains(column.name()))
                warn(options.on_warning, "GLB left out the column '{}': {}; PLY keeps it", column.name(), reason);
        } else {
            const std::string expected = upper_case(column.name());
            Attribute attribute = visit_scalar(column.type(), [&]<class T>(T) { return number_attribute<T>(column); });
            attribute.name = names.add(column.name(), identifier(expected), expected);
            if (lost > 0)
                warn(options.on_warning, "GLB contains the column 'normal' as '{}' and not as normals: {} no direction",
                     attribute.name, count_text(lost, "of its rows has", "of its rows have"));
            attributes.push_back(std::move(attribute));
        }
    }
    return attributes;
}

}  // namespace scanmill::glb
