// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The columns that the scans of an E57 file become, and their numbers, which grow block by block.

#include <map>
#include <span>
#include <string>
#include <vector>

#include "e57/scan.hpp"

namespace scanmill::e57_format {

/// The numbers of one field of a block. One of the two arrays is used, depending on Field::is_integer.
struct FieldBlock {
    Array<std::int64_t> integers;
    Array<double> reals;

    double number(std::size_t row) const { return integers.empty() ? reals[row] : static_cast<double>(integers[row]); }
};
using Block = std::map<std::string, FieldBlock, std::less<>>;  // by the field's name

/// What a column takes from one scan.
struct ColumnSource {
    std::vector<std::string> fields;  ///< one per component
    std::vector<double> low, high;  ///< range of colours that are scaled, one per component; empty for other columns
};

struct ColumnPlan {
    std::string name;
    ScalarType type = ScalarType::float64;
    int length_exponent = 0;
    bool is_direction = false;  ///< turned by the pose
    bool is_flag = false;  ///< kept only if a number is not 0
    std::map<u32, ColumnSource> sources;  ///< by the number of the scan

    u32 components() const { return static_cast<u32>(sources.begin()->second.fields.size()); }
};

/// The columns that all scans have, in the order of the first scan's fields. Warns about columns that are left out
/// because a scan lacks them, and about texts. Scans without records have no say.
std::vector<ColumnPlan> planned_columns(std::span<const Scan> scans,
                                        const std::function<void(std::string)>& on_warning);

/// The numbers of one column.
class GrowingColumn {
public:
    explicit GrowingColumn(ColumnPlan plan) : plan_(std::move(plan)) {}

    const ColumnPlan& plan() const { return plan_; }
    void reserve(std::size_t rows) { bytes_.reserve(rows * row_size()); }
    std::size_t row_size() const { return plan_.components() * size_of(plan_.type); }
    /// Appends the chosen rows of a block of the scan.
    void append(const Scan& scan, const Block& block, std::span<const u32> rows);
    /// The number of rows with a number that is not 0.
    u64 set_rows() const { return set_rows_; }
    Column finished() &&;

private:
    template <class T>
    void append_as(const Scan& scan, const Block& block, std::span<const u32> rows);

    ColumnPlan plan_;
    Array<std::byte> bytes_;
    u64 set_rows_ = 0;
};

}  // namespace scanmill::e57_format
