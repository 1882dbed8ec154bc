// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>

#include "scanmill/formats/common/built_in.hpp"
#include "scanmill/formats/las/detail/las_header.hpp"

namespace scanmill {

namespace {

using Grid = Eigen::Matrix<std::int32_t, 3, 1>;

Grid grid_point(const char* point) {
    return {little_endian<std::int32_t>(point), little_endian<std::int32_t>(point + 4),
            little_endian<std::int32_t>(point + 8)};
}

/// A width that the compiler uses to remove the loop over components.
using One = std::integral_constant<std::size_t, 1>;
constexpr auto unchanged = [](auto value, std::size_t) { return value; };

class PointsReader {
public:
    PointsReader(const LasHeader& header, const std::vector<LasExtra>& extras, std::string_view bytes,
                 const ReadOptions& options)
        : header_(header),
          extras_(extras),
          begin_(bytes.data() + header.points_begin),
          options_(options) {}

    PointCloud read() {
        find_origin();
        read_positions();
        declare_further_fields(header_.point_format < 6 ? declare_old_fields() : declare_new_fields());
        for (const LasExtra& extra : extras_) visit_scalar(extra.type, [&](auto zero) { declare_extra(extra, zero); });
        decode();
        for (Field& field : fields_) field.finish();
        cloud_.columns = std::move(columns_);
        return std::move(cloud_);
    }

private:
    /// One or more numbers of each point that become a column.
    struct Field {
        std::function<void(const char* points, std::size_t first, std::size_t count)> decode;
        std::function<void()> finish;
    };

    template <class Action>
    void for_each_point(Action&& action) const {
        const char* point = begin_;
        for (std::size_t row = 0; row < header_.points; ++row, point += header_.point_size) action(row, point);
    }

    void find_origin() {
        constexpr std::size_t piece_size = 1 << 12;
        std::vector<std::size_t> begin;
        for (std::size_t row = 0; row < header_.points; row += piece_size) begin.push_back(row);
        begin.push_back(header_.points);
        const auto read = [&](std::size_t piece, Array<Vec3>& buffer) -> std::span<const Vec3> {
            buffer.resize(begin[piece + 1] - begin[piece]);
            const char* point = begin_ + begin[piece] * header_.point_size;
            for (Vec3& p : buffer) {
                p = grid_point(point).cast<double>().cwiseProduct(header_.scale) + header_.offset;
                point += header_.point_size;
            }
            return buffer;
        };
        BoundingBox box;
        Array<Vec3> buffer;
        for (std::size_t piece = 0; piece + 1 < begin.size(); ++piece)
            for (const Vec3& p : read(piece, buffer)) box.add(p);
        cloud_.frame.origin = distant_origin(robust_box({begin, read}, box).robust);
    }

    /// The origin is subtracted from the offset before the integers are added, because near zero a double resolves the
    /// smallest step.
    void read_positions() {
        const Vec3 near_offset = header_.offset - cloud_.frame.origin;
        Array<Vec3> positions(header_.points);
        for_each_point([&](std::size_t row, const char* point) {
            positions[row] = grid_point(point).cast<double>().cwiseProduct(header_.scale) + near_offset;
        });
        cloud_.positions = std::move(positions);
    }

    /// Declares a field of `width` numbers of type Source at byte `offset` of each point. convert(number, component)
    /// converts each number; `finish` receives all results in one array.
    template <class Source, class Width, class Convert, class Finish>
    void declare(std::size_t offset, Width width, Convert convert, Finish finish) {
        using Target = decltype(convert(Source{}, std::size_t(0)));
        const auto values = std::make_shared<Array<Target>>(width * header_.points);
        const std::size_t stride = header_.point_size;
        const auto decode = [=](const char* points, std::size_t first, std::size_t count) {
            for (std::size_t i = 0; i < count; ++i)
                for (std::size_t c = 0; c < width; ++c)
                    (*values)[(first + i) * width + c] =
                        convert(little_endian<Source>(points + i * stride + offset + c * sizeof(Source)), c);
        };
        fields_.push_back({decode, [=] { finish(std::move(*values)); }});
    }

    template <class Source>
    void declare(const char* name, std::size_t offset) {
        declare<Source>(offset, One(), unchanged, [=, this](Array<Source> values) { add(name, 1, std::move(values)); });
    }

    /// Declares a column of some bits of a byte. A flag that is not set in any point gives no column.
    void declare_bits(const char* name, std::size_t offset, u32 shift, u32 bits, bool is_flag = false) {
        const auto extract = [=](u8 byte, std::size_t) { return static_cast<u8>(byte >> shift & ((1u << bits) - 1)); };
        declare<u8>(offset, One(), extract, [=, this](Array<u8> values) {
            const bool is_set = std::ranges::any_of(values, [](u8 value) { return value != 0; });
            if (is_set || !is_flag) add(name, 1, std::move(values));
        });
    }

    template <class Source>
    void declare_scan_angle(std::size_t offset, float step) {
        const auto degrees = [=](Source angle, std::size_t) { return static_cast<float>(angle) * step; };
        declare<Source>(offset, One(), degrees,
                        [this](Array<float> angles) { add("scan_angle", 1, std::move(angles)); });
    }

    template <class T>
    void add(std::string name, u32 components, Array<T> values) {
        columns_.add(Column(std::move(name), components, Buffer(std::move(values))));
    }

    /// Declares the fields of point formats 0 to 5. Returns the offset after these fields.
    std::size_t declare_old_fields() {
        declare<std::uint16_t>("intensity", 12);
        declare_bits("return_number", 14, 0, 3);
        declare_bits("number_of_returns", 14, 3, 3);
        declare_bits("classification", 15, 0, 5);
        declare_scan_angle<std::int8_t>(16, 1);
        declare<u8>("user_data", 17);
        declare<std::uint16_t>("point_source_id", 18);
        declare_bits("scan_direction", 14, 6, 1, true);
        declare_bits("edge_of_flight_line", 14, 7, 1, true);
        declare_bits("synthetic", 15, 5, 1, true);
        declare_bits("key_point", 15, 6, 1, true);
        declare_bits("withheld", 15, 7, 1, true);
        return 20;
    }

    std::size_t declare_new_fields() {
        declare<std::uint16_t>("intensity", 12);
        declare_bits("return_number", 14, 0, 4);
        declare_bits("number_of_returns", 14, 4, 4);
        declare<u8>("classification", 16);
        declare_scan_angle<std::int16_t>(18, 0.006f);
        declare<u8>("user_data", 17);
        declare<std::uint16_t>("point_source_id", 20);
        declare_bits("synthetic", 15, 0, 1, true);
        declare_bits("key_point", 15, 1, 1, true);
        declare_bits("withheld", 15, 2, 1, true);
        declare_bits("overlap", 15, 3, 1, true);
        declare_bits("scanner_channel", 15, 4, 2, true);
        declare_bits("scan_direction", 15, 6, 1, true);
        declare_bits("edge_of_flight_line", 15, 7, 1, true);
        return 22;
    }

    void declare_further_fields(std::size_t offset) {
        if (header_.has_gps_time()) {
            declare<double>("gps_time", offset);
            offset += sizeof(double);
        }
        if (header_.has_colour()) {
            declare<std::uint16_t>(offset, 3u, unchanged,
                                   [this](Array<std::uint16_t> colours) { add_colour(std::move(colours)); });
            offset += 3 * sizeof(std::uint16_t);
        }
        if (header_.has_nir()) declare<std::uint16_t>("nir", offset);
        if (header_.has_wave_packets()) warn(options_.on_warning, "the wave packets of the points were left out");
    }

    void add_colour(Array<std::uint16_t> colours) {
        const auto are_bytes_times = [&](u32 factor) {
            return std::ranges::all_of(colours,
                                       [&](u32 value) { return value % factor == 0 && value / factor <= 255; });
        };
        constexpr std::array<u32, 3> factors{1, 257, 256};
        const auto factor = std::ranges::find_if(factors, are_bytes_times);
        if (factor == factors.end()) {
            warn(options_.on_warning, "the colours have 16 bits; they are kept as 'colour16', not 'colour'");
            return add("colour16", 3, std::move(colours));
        }
        if (*factor != 1) warn(options_.on_warning, "the colours are bytes times {}; they were divided by it", *factor);
        Array<u8> bytes(colours.size());
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<u8>(colours[i] / *factor);
        add("colour", 3, std::move(bytes));
    }

    template <class Source>
    void declare_extra(const LasExtra& extra, Source) {
        const auto finish = [&extra, this](auto values) {
            add(free_name(extra.name), extra.components, std::move(values));
        };
        const auto scaled = [&extra](Source value, std::size_t component) {
            return static_cast<double>(value) * extra.scale[component] + extra.shift[component];
        };
        if (extra.is_scaled)
            declare<Source>(extra.offset, extra.components, scaled, finish);
        else
            declare<Source>(extra.offset, extra.components, unchanged, finish);
    }

    /// The wanted name, with a number appended if it is empty or if a column has this name.
    std::string free_name(const std::string& wanted) {
        std::string name = wanted.empty() ? "extra" : wanted;
        if (!columns_.find(name) && !wanted.empty()) return name;
        for (std::size_t number = 1; columns_.find(name) || number == 1; ++number)
            name = (wanted.empty() ? "extra" : wanted + "_extra") + std::string("_") + std::to_string(number);
        warn(options_.on_warning, "the extra bytes {} are called '{}': their own name is empty or taken", quote(wanted),
             name);
        return name;
    }

    void decode() {
        // Blocks stay in the cache while one field after the other is read from them.
        constexpr std::size_t block = 2048;
        for (std::size_t first = 0; first < header_.points; first += block) {
            const std::size_t count = std::min<std::size_t>(block, header_.points - first);
            for (const Field& field : fields_) field.decode(begin_ + first * header_.point_size, first, count);
        }
    }

    const LasHeader& header_;
    const std::vector<LasExtra>& extras_;
    const char* begin_;
    const ReadOptions& options_;
    std::vector<Field> fields_;
    ColumnTable columns_;
    PointCloud cloud_;
};

constexpr std::string_view magic = "LASF";

bool is_compressed(const LasHeader& header, const std::vector<LasRecord>& records) {
    return header.is_compressed ||
           std::ranges::any_of(records, [](const LasRecord& record) { return record.user == "laszip encoded"; });
}

[[noreturn]] void refuse_compressed(const FileBytes& file, const std::vector<LasRecord>& records) {
    const bool is_copc = std::ranges::any_of(records, [](const LasRecord& record) { return record.user == "copc"; });
    throw Error("is {} file, LAS in compressed form; it is not read", is_copc ? "a COPC" : "a LAZ")
        .hint(fmt::format("decompress it with a free program: pdal translate {0} out.las, or: laszip -i {0} -o out.las",
                          shell_word(file.path)));
}

void warn_left_out(const LasHeader& header, const std::vector<LasRecord>& records, std::string_view bytes,
                   bool unit_is_used, const ReadOptions& options) {
    std::vector<std::string> list;
    constexpr std::size_t most_listed = 6;
    for (const LasRecord& record : records)
        if (!describes_extra_bytes(record))
            list.push_back(fmt::format("{} {}{}", record.user.empty() ? "?" : record.user, record.id,
                                       unit_is_used && holds_geo_keys(record) ? " except its unit" : ""));
    if (const std::size_t count = list.size(); count > 0) {
        list.resize(std::min(count, most_listed));
        warn(options.on_warning, "{} left out ({}{})",
             count_text(count, "variable length record was", "variable length records were"), fmt::join(list, ", "),
             count > most_listed ? ", …" : "");
    }
    if (header.extended_records > 0)
        warn(options.on_warning, "{} left out",
             count_text(header.extended_records, "record after the points was", "records after the points were"));
    const std::size_t rest = bytes.size() - header.points_begin - header.points * header.point_size;
    if (rest > 0 && header.extended_records == 0)
        warn(options.on_warning, "{} after the last point ignored", count_text(rest, "byte", "bytes"));
}

Recognition recognise(std::string_view head, u64) {
    return head.starts_with(magic) ? Recognition::certain : Recognition::no;
}

LoadedFile read(const FileBytes& file, const ReadOptions& options) {
    if (!file.bytes.starts_with(magic))
        throw Error("is not a LAS file: it begins with {}, not with {}", quote(file.bytes.substr(0, magic.size())),
                    magic);
    const LasHeader header = read_las_header(file.bytes);
    const std::vector<LasRecord> records = read_las_records(header, file.bytes, options);
    if (is_compressed(header, records)) refuse_compressed(file, records);
    require_las_points(header, file.bytes);
    const LengthUnit unit = las_unit(records, options);
    const bool unit_is_used = unit != LengthUnit::unknown && options.unit == LengthUnit::unknown;
    warn_left_out(header, records, file.bytes, unit_is_used, options);
    const std::vector<LasExtra> extras = read_las_extra(header, records, options);
    std::vector<std::string> comments;
    for (const std::string& comment : {header.system, header.software})
        if (!comment.empty()) comments.push_back(comment);
    PointCloud cloud = PointsReader(header, extras, file.bytes, options).read();
    cloud.frame.unit = unit;
    return {std::make_shared<const PointCloud>(std::move(cloud)), "LAS",
            fmt::format("binary little-endian, 1.{}, point format {}", header.minor_version, header.point_format),
            std::move(comments)};
}

}  // namespace

Format las_format() {
    Format las{"LAS", {"las", "laz"}, recognise, read, {}};
    las.memory_per_byte = 5;
    return las;
}

}  // namespace scanmill
