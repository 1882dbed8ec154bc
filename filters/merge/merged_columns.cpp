// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cstring>
#include <limits>
#include <numeric>
#include <string>

#include "merge/merge_steps.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::merging {

namespace {

Buffer<std::byte> bytes_end_to_end(std::span<const Column> parts) {
    std::size_t size = 0;
    for (const Column& part : parts) size += part.bytes().size();
    Array<std::byte> bytes(size);
    std::size_t at = 0;
    for (const Column& part : parts) {
        if (!part.bytes().empty()) std::memcpy(bytes.data() + at, part.bytes().data(), part.bytes().size());
        at += part.bytes().size();
    }
    return bytes;
}

Buffer<u64> offsets_end_to_end(std::span<const Column> parts) {
    Array<u64> offsets{0};
    for (const Column& part : parts) {
        const u64 before = offsets.back();
        for (std::size_t row = 1; row <= part.rows(); ++row) offsets.push_back(before + part.offsets()[row]);
    }
    return offsets;
}

Column as_doubles(std::span<const Column> parts) {
    Array<double> values;
    for (const Column& part : parts)
        visit_scalar(part.type(), [&](auto zero) {
            for (const auto value : part.values<decltype(zero)>()) values.push_back(static_cast<double>(value));
        });
    return Column(parts.front().name(), parts.front().components(), Buffer<double>(std::move(values)))
        .with_length_exponent(parts.front().length_exponent());
}

/// The rows of all parts, end to end. Pre: at least one part; all are lists of one type, or all have the same number of
/// components. Different types become float64; 64-bit integers beyond 2^53 are then rounded.
Column joined(std::span<const Column> parts) {
    const Column& first = parts.front();
    if (!std::ranges::all_of(parts, [&](const Column& part) { return part.type() == first.type(); })) {
        assert(!first.is_list());
        return as_doubles(parts);
    }
    return {first.name(),
            first.type(),
            first.components(),
            bytes_end_to_end(parts),
            first.is_list() ? offsets_end_to_end(parts) : Buffer<u64>(),
            first.length_exponent()};
}

const std::string newest = "source";
const std::string older = "-of-source";

/// Whether the name is "source", "source-of-source" and so on.
bool names_a_source(const std::string& name) {
    if (!name.starts_with(newest)) return false;
    std::string_view rest = std::string_view(name).substr(newest.size());
    while (rest.starts_with(older)) rest.remove_prefix(older.size());
    return rest.empty();
}

/// The column with its name in the result. Directions are rotated by the pose.
Column placed(const Column& column, const RigidTransform* pose) {
    if (names_a_source(column.name())) return column.renamed(column.name() + older);
    return pose ? turned(column, pose->rotation) : column;
}

std::string shape(const Column& column) {
    if (column.is_list()) return fmt::format("lists of {}", name_of(column.type()));
    return column.components() == 1 ? std::string(name_of(column.type()))
                                    : fmt::format("{} x {}", column.components(), name_of(column.type()));
}

bool is_floating(const Column& column) {
    return !column.is_list() && (column.type() == ScalarType::float32 || column.type() == ScalarType::float64);
}

/// A column that has the same number in `rows` rows, and the name, type, components and exponent of `like`.
Column constant(const Column& like, std::size_t rows, double value) {
    const auto filled = [&](auto zero) {
        Array<decltype(zero)> values(rows * like.components(), static_cast<decltype(zero)>(value));
        return Column(like.name(), like.components(), Buffer<decltype(zero)>(std::move(values)))
            .with_length_exponent(like.length_exponent());
    };
    return like.type() == ScalarType::float32 ? filled(float{}) : filled(double{});
}

class Merger {
public:
    Merger(std::vector<ColumnTable> tables, std::vector<std::size_t> rows, std::span<const u32> numbers,
           Context& context)
        : tables_(std::move(tables)),
          rows_(std::move(rows)),
          numbers_(numbers),
          context_(context) {}

    ColumnTable merged() {
        ColumnTable result;
        std::vector<std::string> seen;
        for (const ColumnTable& table : tables_)
            for (const Column& column : table) {
                if (std::ranges::find(seen, column.name()) != seen.end()) continue;
                seen.push_back(column.name());
                if (const std::vector<Column> parts = parts_of(column.name()); !parts.empty())
                    result.add(joined(parts));
            }
        return result;
    }

private:
    /// One column per cloud, suitable for joined(). Empty, with a warning, if the columns cannot be joined.
    std::vector<Column> parts_of(const std::string& name) {
        std::vector<Column> parts;
        std::vector<u32> inputs;  // numbers of the inputs that have the column
        for (std::size_t input = 0; input < tables_.size(); ++input)
            if (const Column* column = tables_[input].find(name)) {
                parts.push_back(*column);
                inputs.push_back(numbers_[input]);
            }
        const Column first = parts.front();
        const bool is_even =
            std::ranges::all_of(parts, [&](const Column& part) { return part.components() == first.components(); });
        const std::size_t without = tables_.size() - parts.size();
        const std::string lack =
            fmt::format("{} of {} inputs {} it", without, tables_.size(), by_count(without, "lacks", "lack"));
        if (without > 0 && !(is_even && std::ranges::all_of(parts, is_floating))) {
            context_.warn(fmt::format("the column '{}' is left out: {}", name, lack));
            return {};
        }
        const auto other = std::ranges::find_if(parts, [&](const Column& part) {
            return part.components() != first.components() || part.type() != first.type();
        });
        if (other != parts.end()) {
            const std::string found =
                fmt::format("{} in input {}, {} in input {}", shape(first), inputs.front(), shape(*other),
                            inputs[static_cast<std::size_t>(other - parts.begin())]);
            if (first.is_list() || !is_even) {
                context_.warn(fmt::format("the column '{}' is left out: it is {}", name, found));
                return {};
            }
            const bool rounds = std::ranges::any_of(parts, [](const Column& part) {
                return part.type() == ScalarType::int64 || part.type() == ScalarType::uint64;
            });
            context_.warn(fmt::format("the column '{}' is carried as float64: it is {}{}", name, found,
                                      rounds ? "; whole numbers beyond 2^53 are rounded" : ""));
        }
        if (without > 0) {
            context_.warn(fmt::format("the column '{}' has NaN for some points: {}", name, lack));
            for (std::size_t input = 0; input < tables_.size(); ++input)
                if (!tables_[input].find(name))
                    parts.insert(parts.begin() + static_cast<std::ptrdiff_t>(input),
                                 constant(first, rows_[input], std::numeric_limits<double>::quiet_NaN()));
        }
        return parts;
    }

    std::vector<ColumnTable> tables_;
    std::vector<std::size_t> rows_;
    std::span<const u32> numbers_;
    Context& context_;
};

Column source_column(std::span<const std::shared_ptr<const PointCloud>> clouds, std::span<const u32> numbers) {
    Array<u32> source;
    for (std::size_t cloud = 0; cloud < clouds.size(); ++cloud)
        source.insert(source.end(), clouds[cloud]->size(), numbers[cloud]);
    return {newest, 1, Buffer<u32>(std::move(source))};
}

}  // namespace

PointCloud with_default_uncertainty(const PointCloud& cloud, ScalarType type, double value) {
    const Column* given = cloud.columns.find("uncertainty");
    if (given && given->components() != 1) return cloud;
    PointCloud result{cloud.frame, cloud.positions, {}};
    for (const Column& column : cloud.columns) {
        if (&column != given) {
            result.columns.add(column);
            continue;
        }
        if (!is_floating(column)) {
            result.columns.add(column.with_length_exponent(1));
            continue;
        }
        visit_scalar(column.type(), [&](auto zero) {
            const auto before = column.values<decltype(zero)>();
            Array<decltype(zero)> values(before.begin(), before.end());
            for (auto& number : values)
                if (number != number) number = static_cast<decltype(zero)>(value);
            result.columns.add(
                Column("uncertainty", 1, Buffer<decltype(zero)>(std::move(values))).with_length_exponent(1));
        });
    }
    if (!given) {
        const Column like("uncertainty", type, 1, {}, {}, 1);
        result.columns.add(constant(like, cloud.size(), value));
    }
    return result;
}

ColumnTable merged_columns(std::span<const std::shared_ptr<const PointCloud>> clouds,
                           std::span<const RigidTransform> poses, std::span<const u32> numbers, Context& context) {
    std::vector<u32> all(clouds.size());
    std::iota(all.begin(), all.end(), 0u);
    if (numbers.empty()) numbers = all;
    std::vector<ColumnTable> tables(clouds.size());
    std::vector<std::size_t> rows;
    for (const auto& cloud : clouds) rows.push_back(cloud->size());
    std::size_t with_source = 0;
    for (std::size_t cloud = 0; cloud < clouds.size(); ++cloud) {
        for (const Column& column : clouds[cloud]->columns)
            tables[cloud].add(placed(column, poses.empty() ? nullptr : &poses[cloud]));
        if (clouds[cloud]->columns.find(newest)) ++with_source;
    }
    if (with_source > 0)
        context.warn(fmt::format("{} of {} already {} a column 'source'; it was renamed 'source{}'", with_source,
                                 count_text(clouds.size(), "input", "inputs"), by_count(with_source, "has", "have"),
                                 older));
    ColumnTable result = Merger(std::move(tables), std::move(rows), numbers, context).merged();
    result.add(source_column(clouds, numbers));
    return result;
}

}  // namespace scanmill::merging
