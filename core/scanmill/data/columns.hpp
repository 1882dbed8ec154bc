// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Named per-element columns: the data of a scan beside its positions.
///
/// A Column is #rows × components numbers of one scalar type, or #rows lists of varying length. Well-known names:
/// `normal` (3 × float32 or float64, unit length), `colour` (3 or 4 × uint8, red green blue alpha), `weight` (1).
/// Other columns keep the name and type of their file. Columns are values: copies share memory, gather() allocates new
/// memory.

#include <array>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "scanmill/data/array.hpp"

namespace scanmill {

enum class ScalarType : u8 { int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64 };

std::size_t size_of(ScalarType type);
/// "int8" … "float64".
std::string_view name_of(ScalarType type);

/// The ScalarType of the C++ type T.
template <class T>
consteval ScalarType scalar_type_of() {
    using std::is_same_v;
    static_assert(std::is_arithmetic_v<T> && !is_same_v<T, bool>);
    if constexpr (is_same_v<T, float>) return ScalarType::float32;
    if constexpr (is_same_v<T, double>) return ScalarType::float64;
    constexpr int width = sizeof(T) == 1 ? 0 : sizeof(T) == 2 ? 2 : sizeof(T) == 4 ? 4 : 6;
    return static_cast<ScalarType>(width + (std::is_unsigned_v<T> ? 1 : 0));
}

/// Calls `action` with a value-initialised number of the C++ type of `type`.
template <class Action>
decltype(auto) visit_scalar(ScalarType type, Action&& action) {
    switch (type) {
        case ScalarType::int8: return action(std::int8_t{});
        case ScalarType::uint8: return action(std::uint8_t{});
        case ScalarType::int16: return action(std::int16_t{});
        case ScalarType::uint16: return action(std::uint16_t{});
        case ScalarType::int32: return action(std::int32_t{});
        case ScalarType::uint32: return action(std::uint32_t{});
        case ScalarType::int64: return action(std::int64_t{});
        case ScalarType::uint64: return action(std::uint64_t{});
        case ScalarType::float32: return action(float{});
        case ScalarType::float64: break;
    }
    return action(double{});
}

class Column {
public:
    /// #rows × components values, row by row. Pre: values.size() is a multiple of components ≥ 1.
    template <class T>
    Column(std::string name, u32 components, const Buffer<T>& values)
        : Column(std::move(name), scalar_type_of<T>(), components, bytes_of(values), {}) {}
    /// One list per row: row r is values[offsets[r]] … values[offsets[r + 1] - 1]; #offsets = #rows + 1.
    template <class T>
    Column(std::string name, Buffer<u64> offsets, const Buffer<T>& values)
        : Column(std::move(name), scalar_type_of<T>(), 0, bytes_of(values), std::move(offsets)) {}
    /// The general form: `components` 0 means lists. Pre: data is aligned for `type`.
    Column(std::string name, ScalarType type, u32 components, Buffer<std::byte> data, Buffer<u64> offsets,
           int length_exponent = 0);

    const std::string& name() const { return name_; }
    ScalarType type() const { return type_; }
    bool is_list() const { return components_ == 0; }
    /// Numbers per row; 0 for lists.
    u32 components() const { return components_; }
    std::size_t rows() const { return rows_; }
    /// The power of the length unit in the numbers: 1 for lengths in the frame's unit, -1 for numbers per length
    /// (curvatures), else 0.
    int length_exponent() const { return length_exponent_; }
    const Buffer<u64>& offsets() const { return offsets_; }
    const Buffer<std::byte>& bytes() const { return data_; }

    /// All numbers. Pre: T is the column's type.
    template <class T>
    std::span<const T> values() const {
        require_type(scalar_type_of<T>());
        return {reinterpret_cast<const T*>(data_.data()), data_.size() / sizeof(T)};
    }
    /// One number as a double; 64-bit integers beyond 2^53 are rounded. Pre: not a list.
    double number(std::size_t row, u32 component = 0) const;

    Column gather(std::span<const u32> rows) const;
    Column renamed(std::string name) const;
    Column with_length_exponent(int exponent) const;
    /// The column in a unit that is `factor` times as small. Lengths are multiplied and numbers per length divided by
    /// `factor`; the results are float64. Columns with length exponent 0 remain unchanged.
    Column scaled(double factor) const;
    bool operator==(const Column& other) const;

private:
    template <class T>
    static Buffer<std::byte> bytes_of(const Buffer<T>& values) {
        return {values.owner(), reinterpret_cast<const std::byte*>(values.data()), values.size() * sizeof(T)};
    }
    void require_type(ScalarType type) const;

    std::string name_;
    ScalarType type_;
    u32 components_;
    std::size_t rows_;
    int length_exponent_;
    Buffer<std::byte> data_;
    Buffer<u64> offsets_;
};

/// Columns of one kind of element (points, faces …), in file order. Names are unique.
class ColumnTable {
public:
    /// Throws Error if the name is taken or the number of rows differs from the table's.
    void add(Column column);
    const Column* find(std::string_view name) const;
    ColumnTable gather(std::span<const u32> rows) const;
    /// Applies Column::scaled() to every column.
    ColumnTable scaled(double factor) const;

    auto begin() const { return columns_.begin(); }
    auto end() const { return columns_.end(); }
    std::size_t size() const { return columns_.size(); }
    bool empty() const { return columns_.empty(); }
    bool operator==(const ColumnTable&) const = default;

private:
    std::vector<Column> columns_;
};

}  // namespace scanmill
