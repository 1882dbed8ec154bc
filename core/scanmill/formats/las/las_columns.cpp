// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/las/detail/las_columns.hpp"

#include <algorithm>

namespace scanmill {

namespace {

constexpr std::size_t flags_begin = 14;
/// Greatest byte, and what some programs multiply a colour's bytes by to fill 16 bits.
constexpr u32 byte_mask = 0xff, byte_multiple = 257, byte_shift = 256;

std::size_t colours_begin(const LasHeader& header) {
    const std::size_t fields = header.point_format < 6 ? 20 : 22;
    return fields + (header.has_gps_time() ? sizeof(double) : 0);
}

/// A width that the compiler uses to remove the loop over components.
using One = std::integral_constant<std::size_t, 1>;
constexpr auto unchanged = [](auto value, std::size_t) { return value; };

/// Lists the columns of a point format.
class Columns {
public:
    Columns(const LasHeader& header, const LasFacts& facts, const ReadOptions& options)
        : header_(header),
          facts_(facts),
          options_(options) {}

    std::vector<LasColumn> list(const std::vector<LasExtra>& extras) {
        header_.point_format < 6 ? add_old_fields() : add_new_fields();
        std::size_t offset = colours_begin(header_);
        if (header_.has_gps_time()) add<double>("gps_time", offset - sizeof(double));
        if (header_.has_colour()) {
            add_colour(offset);
            offset += 3 * sizeof(std::uint16_t);
        }
        if (header_.has_nir()) add<std::uint16_t>("nir", offset);
        if (header_.has_wave_packets()) warn(options_.on_warning, "the wave packets of the points were left out");
        for (const LasExtra& extra : extras) visit_scalar(extra.type, [&](auto zero) { add_extra(extra, zero); });
        return std::move(columns_);
    }

private:
    /// Adds a column of `width` numbers of type Source at byte `offset` of each record. convert(number, component)
    /// converts each number.
    template <class Source, class Width, class Convert>
    void add(std::string name, std::size_t offset, Width width, Convert convert) {
        using Target = decltype(convert(Source{}, std::size_t(0)));
        const auto decode = [=](const char* records, std::size_t stride, std::size_t count, std::byte* out) {
            auto* numbers = reinterpret_cast<Target*>(out);
            for (std::size_t i = 0; i < count; ++i)
                for (std::size_t c = 0; c < width; ++c)
                    numbers[i * width + c] =
                        convert(little_endian<Source>(records + i * stride + offset + c * sizeof(Source)), c);
        };
        columns_.push_back({std::move(name), scalar_type_of<Target>(), static_cast<u32>(width), decode});
    }

    template <class Source>
    void add(const char* name, std::size_t offset) {
        add<Source>(name, offset, One(), unchanged);
    }

    /// Adds a column of some bits of a byte.
    void add_bits(const char* name, std::size_t offset, u32 shift, u32 bits) {
        add<u8>(name, offset, One(),
                [=](u8 byte, std::size_t) { return static_cast<u8>(byte >> shift & ((1u << bits) - 1)); });
    }

    /// The same for flags: those that are not set in any point give no column.
    void add_flags(const char* name, std::size_t offset, u32 shift, u32 bits = 1) {
        if (facts_.flag_bits[offset - flags_begin] >> shift & ((1u << bits) - 1)) add_bits(name, offset, shift, bits);
    }

    template <class Source>
    void add_scan_angle(std::size_t offset, float step) {
        add<Source>("scan_angle", offset, One(),
                    [=](Source angle, std::size_t) { return static_cast<float>(angle) * step; });
    }

    /// Adds the fields of point formats 0 to 5.
    void add_old_fields() {
        add<std::uint16_t>("intensity", 12);
        add_bits("return_number", 14, 0, 3);
        add_bits("number_of_returns", 14, 3, 3);
        add_bits("classification", 15, 0, 5);
        add_scan_angle<std::int8_t>(16, 1);
        add<u8>("user_data", 17);
        add<std::uint16_t>("point_source_id", 18);
        add_flags("scan_direction", 14, 6);
        add_flags("edge_of_flight_line", 14, 7);
        add_flags("synthetic", 15, 5);
        add_flags("key_point", 15, 6);
        add_flags("withheld", 15, 7);
    }

    void add_new_fields() {
        add<std::uint16_t>("intensity", 12);
        add_bits("return_number", 14, 0, 4);
        add_bits("number_of_returns", 14, 4, 4);
        add<u8>("classification", 16);
        add_scan_angle<std::int16_t>(18, 0.006f);
        add<u8>("user_data", 17);
        add<std::uint16_t>("point_source_id", 20);
        add_flags("synthetic", 15, 0);
        add_flags("key_point", 15, 1);
        add_flags("withheld", 15, 2);
        add_flags("overlap", 15, 3);
        add_flags("scanner_channel", 15, 4, 2);
        add_flags("scan_direction", 15, 6);
        add_flags("edge_of_flight_line", 15, 7);
    }

    /// What the colours have to be divided by to become bytes; 0 if they have 16 bits.
    u32 colour_factor() const {
        if (facts_.colour_bits <= byte_mask) return 1;
        if (facts_.colours_are_multiples) return byte_multiple;
        return (facts_.colour_bits & byte_mask) == 0 ? byte_shift : 0;
    }

    void add_colour(std::size_t offset) {
        const u32 factor = colour_factor();
        if (factor == 0) {
            warn(options_.on_warning, "the colours have 16 bits; they are kept as 'colour16', not 'colour'");
            return add<std::uint16_t>("colour16", offset, 3u, unchanged);
        }
        if (factor != 1) warn(options_.on_warning, "the colours are bytes times {}; they were divided by it", factor);
        add<std::uint16_t>("colour", offset, 3u,
                           [=](std::uint16_t value, std::size_t) { return static_cast<u8>(value / factor); });
    }

    template <class Source>
    void add_extra(const LasExtra& extra, Source) {
        const std::string name = free_name(extra.name);
        if (!extra.is_scaled) return add<Source>(name, extra.offset, std::size_t(extra.components), unchanged);
        add<Source>(name, extra.offset, std::size_t(extra.components),
                    [scale = extra.scale, shift = extra.shift](Source value, std::size_t component) {
                        return static_cast<double>(value) * scale[component] + shift[component];
                    });
    }

    /// The wanted name, with a number appended if it is empty or if a column has this name.
    std::string free_name(const std::string& wanted) {
        const auto is_taken = [&](const std::string& name) {
            return std::ranges::find(columns_, name, &LasColumn::name) != columns_.end();
        };
        std::string name = wanted.empty() ? "extra" : wanted;
        if (!is_taken(name) && !wanted.empty()) return name;
        for (std::size_t number = 1; is_taken(name) || number == 1; ++number)
            name = (wanted.empty() ? "extra" : wanted + "_extra") + std::string("_") + std::to_string(number);
        warn(options_.on_warning, "the extra bytes {} are called '{}': their own name is empty or taken", quote(wanted),
             name);
        return name;
    }

    const LasHeader& header_;
    const LasFacts& facts_;
    const ReadOptions& options_;
    std::vector<LasColumn> columns_;
};

}  // namespace

void LasFacts::add(const LasHeader& header, std::string_view records) {
    add_bounds(header, records);
    const std::size_t colours = header.has_colour() ? colours_begin(header) : 0;
    const char* const end = records.data() + records.size();
    for (const char* record = records.data(); record < end; record += header.point_size) {
        for (std::size_t i = 0; i < flag_bits.size(); ++i)
            flag_bits[i] = static_cast<u8>(flag_bits[i] | little_endian<u8>(record + flags_begin + i));
        if (colours == 0) continue;
        for (std::size_t i = 0; i < 3; ++i) {
            const u32 value = little_endian<std::uint16_t>(record + colours + i * sizeof(std::uint16_t));
            colour_bits |= value;
            colours_are_multiples &= (value >> 8) == (value & byte_mask);
        }
    }
}

void LasFacts::add_bounds(const LasHeader& header, std::string_view records) {
    const char* const end = records.data() + records.size();
    for (const char* record = records.data(); record < end; record += header.point_size) {
        const LasGrid point = las_grid_point(record);
        low = low.cwiseMin(point);
        high = high.cwiseMax(point);
    }
}

void LasFacts::add(const LasFacts& more) {
    low = low.cwiseMin(more.low);
    high = high.cwiseMax(more.high);
    for (std::size_t i = 0; i < flag_bits.size(); ++i) flag_bits[i] = static_cast<u8>(flag_bits[i] | more.flag_bits[i]);
    colour_bits |= more.colour_bits;
    colours_are_multiples &= more.colours_are_multiples;
}

BoundingBox LasFacts::box(const LasHeader& header, const Vec3& origin) const {
    // The products and sums are monotonic, so the extreme integers give the extreme coordinates.
    BoundingBox box;
    for (const LasGrid& corner : {low, high})
        box.add(corner.cast<double>().cwiseProduct(header.scale) + (header.offset - origin));
    return box;
}

void las_positions(const LasHeader& header, const Vec3& origin, std::string_view records, std::span<Vec3> positions) {
    const Vec3 near_offset = header.offset - origin;
    const char* record = records.data();
    for (Vec3& position : positions) {
        position = las_grid_point(record).cast<double>().cwiseProduct(header.scale) + near_offset;
        record += header.point_size;
    }
}

std::vector<LasColumn> las_columns(const LasHeader& header, const std::vector<LasExtra>& extras, const LasFacts& facts,
                                   const ReadOptions& options) {
    return Columns(header, facts, options).list(extras);
}

LasTable::LasTable(const std::vector<LasColumn>& columns, std::size_t rows) : columns_(columns) {
    for (const LasColumn& column : columns) numbers_.emplace_back(rows * column.components * size_of(column.type));
}

void LasTable::decode(std::size_t first_row, std::string_view records, std::size_t stride) {
    // Blocks stay in the cache while one field after the other is read from them.
    constexpr std::size_t block = 2048;
    const std::size_t rows = records.size() / stride;
    for (std::size_t begin = 0; begin < rows; begin += block) {
        const std::size_t count = std::min(block, rows - begin);
        for (std::size_t i = 0; i < columns_.size(); ++i) {
            const std::size_t size = columns_[i].components * size_of(columns_[i].type);
            columns_[i].decode(records.data() + begin * stride, stride, count,
                               numbers_[i].data() + (first_row + begin) * size);
        }
    }
}

ColumnTable LasTable::finish() {
    ColumnTable table;
    for (std::size_t i = 0; i < columns_.size(); ++i)
        table.add(Column(columns_[i].name, columns_[i].type, columns_[i].components,
                         Buffer<std::byte>(std::move(numbers_[i])), {}));
    return table;
}

}  // namespace scanmill
