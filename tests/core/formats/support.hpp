// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// For the tests of readers and writers: warnings kept, files from a few lines of text.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bit>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/files.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {

namespace fs = std::filesystem;

/// Three rows of positions.
inline const std::string right_triangle = "0 0 0\n1 0 0\n0 1 0\n";

/// Collects warnings through the options.
struct Warnings {
    std::vector<std::string> sentences;
    ReadOptions reading() {
        return {[this](std::string sentence) { sentences.push_back(std::move(sentence)); }};
    }
    WriteOptions writing() {
        return {[this](std::string sentence) { sentences.push_back(std::move(sentence)); }};
    }
};

inline void put_file(const fs::path& path, std::string_view content) {
    std::ofstream(path, std::ios::binary).write(content.data(), static_cast<std::streamsize>(content.size()));
}

inline std::shared_ptr<const PointCloud> points_in(std::string_view bytes, const char* name,
                                                   Warnings* warnings = nullptr) {
    return read_bytes(bytes, name, warnings ? warnings->reading() : ReadOptions{}).value.get<PointCloud>();
}

inline std::shared_ptr<const TriangleMesh> mesh_in(std::string_view bytes, const char* name,
                                                   Warnings* warnings = nullptr) {
    return read_bytes(bytes, name, warnings ? warnings->reading() : ReadOptions{}).value.get<TriangleMesh>();
}

/// The sentence of the Error that reading throws.
inline std::string refusal_of(std::string_view bytes, const char* name) {
    try {
        read_bytes(bytes, name);
    } catch (const Error& error) {
        return error.sentence();
    }
    return "it was read";
}

/// A number's bytes, in the order asked for.
template <class T>
std::string bytes_of(T number, bool big_endian = false) {
    std::string bytes(sizeof(T), '\0');
    std::memcpy(bytes.data(), &number, sizeof(T));
    if (big_endian != (std::endian::native == std::endian::big)) bytes.assign(bytes.rbegin(), bytes.rend());
    return bytes;
}

template <class T>
std::vector<T> numbers_of(const Column* column) {
    if (!column || column->type() != scalar_type_of<T>()) return {};
    return {column->values<T>().begin(), column->values<T>().end()};
}

template <class T>
std::vector<T> rows_of(const Buffer<T>& buffer) {
    return {buffer.begin(), buffer.end()};
}

inline Vec3 world_of(const PointCloud& cloud, std::size_t row) { return cloud.frame.origin + cloud.positions[row]; }

/// Equal up to the origin, which is a reader's choice: frames, world coordinates, columns.
inline void expect_same_points(const PointCloud& a, const PointCloud& b) {
    ASSERT_EQ(a.size(), b.size());
    EXPECT_EQ(a.frame.unit, b.frame.unit);
    EXPECT_EQ(a.frame.name, b.frame.name);
    for (std::size_t row = 0; row < a.size(); ++row) ASSERT_EQ(world_of(a, row), world_of(b, row)) << "row " << row;
    EXPECT_EQ(a.columns, b.columns);
}

}  // namespace scanmill::test
