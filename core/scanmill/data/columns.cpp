// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/columns.hpp"
#include "scanmill/base/text.hpp"

#include <algorithm>
#include <cassert>
#include <cstring>

#include "scanmill/base/error.hpp"

namespace scanmill {

std::size_t size_of(ScalarType type) {
    return visit_scalar(type, [](auto number) { return sizeof(number); });
}

std::string_view name_of(ScalarType type) {
    constexpr std::array<std::string_view, 10> names{"int8",   "uint8", "int16",  "uint16",  "int32",
                                                     "uint32", "int64", "uint64", "float32", "float64"};
    return names[static_cast<std::size_t>(type)];
}

Column::Column(std::string name, ScalarType type, u32 components, Buffer<std::byte> data, Buffer<u64> offsets,
               int length_exponent)
    : name_(std::move(name)),
      type_(type),
      components_(components),
      length_exponent_(length_exponent),
      data_(std::move(data)),
      offsets_(std::move(offsets)) {
    const std::size_t count = data_.size() / size_of(type_);
    assert(data_.size() % size_of(type_) == 0);
    if (components_ == 0) {
        assert(!offsets_.empty() && offsets_[offsets_.size() - 1] == count);
        rows_ = offsets_.size() - 1;
    } else {
        assert(count % components_ == 0);
        rows_ = count / components_;
    }
}

void Column::require_type([[maybe_unused]] ScalarType type) const { assert(type == type_); }

double Column::number(std::size_t row, u32 component) const {
    assert(row < rows_ && component < components_);
    return visit_scalar(
        type_, [&](auto zero) { return static_cast<double>(values<decltype(zero)>()[row * components_ + component]); });
}

Column Column::gather(std::span<const u32> rows) const {
    const std::size_t width = size_of(type_);
    if (!is_list()) {
        const std::size_t stride = width * components_;
        Array<std::byte> picked(rows.size() * stride);
        for (std::size_t i = 0; i < rows.size(); ++i)
            std::memcpy(picked.data() + i * stride, data_.data() + rows[i] * stride, stride);
        return {name_, type_, components_, std::move(picked), {}, length_exponent_};
    }
    Array<u64> offsets(rows.size() + 1);
    offsets[0] = 0;
    for (std::size_t i = 0; i < rows.size(); ++i)
        offsets[i + 1] = offsets[i] + offsets_[rows[i] + 1] - offsets_[rows[i]];
    Array<std::byte> picked(offsets.back() * width);
    for (std::size_t i = 0; i < rows.size(); ++i)
        if (offsets[i + 1] > offsets[i])
            std::memcpy(picked.data() + offsets[i] * width, data_.data() + offsets_[rows[i]] * width,
                        (offsets[i + 1] - offsets[i]) * width);
    return {name_, type_, 0, std::move(picked), std::move(offsets), length_exponent_};
}

Column Column::renamed(std::string name) const {
    return {std::move(name), type_, components_, data_, offsets_, length_exponent_};
}

Column Column::with_length_exponent(int exponent) const {
    return {name_, type_, components_, data_, offsets_, exponent};
}

Column Column::scaled(double factor) const {
    if (length_exponent_ == 0) return *this;
    const std::size_t count = data_.size() / size_of(type_);
    Array<double> values(count);
    visit_scalar(type_, [&](auto zero) {
        const auto numbers = this->values<decltype(zero)>();
        for (std::size_t i = 0; i < count; ++i) {
            const auto number = static_cast<double>(numbers[i]);
            values[i] = length_exponent_ < 0 ? number / factor : number * factor;
        }
    });
    const Buffer<double> scaled(std::move(values));
    const Column column = is_list() ? Column(name_, offsets_, scaled) : Column(name_, components_, scaled);
    return column.with_length_exponent(length_exponent_);
}

bool Column::operator==(const Column& other) const {
    return name_ == other.name_ && type_ == other.type_ && components_ == other.components_ &&
           length_exponent_ == other.length_exponent_ && std::ranges::equal(data_, other.data_) &&
           std::ranges::equal(offsets_, other.offsets_);
}

void ColumnTable::add(Column column) {
    if (find(column.name())) throw Error("two columns are called '{}'; names must differ", column.name());
    if (!columns_.empty() && columns_.front().rows() != column.rows())
        throw Error("column '{}' has {}, the others have {}", column.name(), count_text(column.rows(), "row", "rows"),
                    columns_.front().rows());
    columns_.push_back(std::move(column));
}

const Column* ColumnTable::find(std::string_view name) const {
    const auto found = std::ranges::find(columns_, name, &Column::name);
    return found == columns_.end() ? nullptr : &*found;
}

ColumnTable ColumnTable::gather(std::span<const u32> rows) const {
    ColumnTable table = *this;
    for (Column& column : table.columns_) column = column.gather(rows);
    return table;
}

ColumnTable ColumnTable::scaled(double factor) const {
    ColumnTable table = *this;
    for (Column& column : table.columns_) column = column.scaled(factor);
    return table;
}

}  // namespace scanmill
