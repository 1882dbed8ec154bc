// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/las/detail/las_points.hpp"

#include <algorithm>

namespace scanmill {

namespace {

constexpr std::size_t description_size = 192;

/// Types 1 to 10 in the order in which LAS numbers them; 11 to 20 are two of each, 21 to 30 three.
constexpr std::array<ScalarType, 10> types{
    ScalarType::uint8, ScalarType::int8,   ScalarType::uint16, ScalarType::int16,   ScalarType::uint32,
    ScalarType::int32, ScalarType::uint64, ScalarType::int64,  ScalarType::float32, ScalarType::float64};

std::string name_in(std::string_view description) {
    std::string name;
    for (const char c : description.substr(4, 32)) {
        if (c == '\0') break;
        name += c >= ' ' && c <= '~' ? c : '?';
    }
    while (!name.empty() && name.back() == ' ') name.pop_back();
    return name;
}

/// Pre: the type is one of the thirty.
LasExtra described(std::string_view description, u32 type) {
    constexpr u32 scale_bit = 8, shift_bit = 16;
    LasExtra extra;
    extra.name = name_in(description);
    extra.type = types[(type - 1) % types.size()];
    extra.components = static_cast<u32>((type - 1) / types.size() + 1);
    const u32 options = little_endian<u8>(description.data() + 3);
    extra.is_scaled = (options & (scale_bit | shift_bit)) != 0;
    for (std::size_t i = 0; i < extra.components; ++i) {
        if (options & scale_bit) extra.scale[i] = little_endian<double>(description.data() + 112 + 8 * i);
        if (options & shift_bit) extra.shift[i] = little_endian<double>(description.data() + 136 + 8 * i);
    }
    return extra;
}

}  // namespace

bool describes_extra_bytes(const LasRecord& record) {
    constexpr u32 extra_bytes = 4;
    return record.user == "LASF_Spec" && record.id == extra_bytes;
}

std::vector<LasExtra> read_las_extra(const LasHeader& header, const std::vector<LasRecord>& records,
                                     const ReadOptions& options) {
    std::vector<LasExtra> extras;
    std::size_t at = las_point_size(header.point_format);
    std::size_t described_bytes = 0;
    for (const LasRecord& record : records) {
        if (!describes_extra_bytes(record)) continue;
        for (std::size_t i = 0; i + description_size <= record.content.size(); i += description_size) {
            const std::string_view description = record.content.substr(i, description_size);
            const u32 type = little_endian<u8>(description.data() + 2);
            if (type == 0 || type > 3 * types.size()) {
                at += little_endian<u8>(description.data() + 3);  // then this is their number
                continue;
            }
            LasExtra extra = described(description, type);
            extra.offset = at;
            const std::size_t size = extra.components * size_of(extra.type);
            if (at + size > header.point_size) {
                warn(options.on_warning,
                     "the extra bytes {} would lie beyond the {} bytes of a point; they were left out",
                     quote(extra.name), header.point_size);
                return extras;
            }
            at += size;
            described_bytes += size;
            extras.push_back(std::move(extra));
        }
    }
    const std::size_t rest = header.point_size - las_point_size(header.point_format) - described_bytes;
    if (rest > 0)
        warn(options.on_warning, "{} of each point {} of no described type and left out",
             count_text(rest, "extra byte", "extra bytes"), by_count(rest, "is", "are"));
    return extras;
}

namespace {

using Grid = Eigen::Matrix<std::int32_t, 3, 1>;

Grid grid_point(const char* point) {
    return {little_endian<std::int32_t>(point), little_endian<std::int32_t>(point + 4),
            little_endian<std::int32_t>(point + 8)};
}

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
        if (header_.point_format < 6)
            declare_old_fields();
        else
            declare_new_fields();
        declare_further_fields();
        declare_extras();
        decode();
        for (Field& field : fields_) field.finish();
        cloud_.columns = std::move(columns_);
        return std::move(cloud_);
    }

private:
    /// One or more numbers of each point on their way into a column.
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
        Grid low = grid_point(begin_), high = low;
        for_each_point([&](std::size_t, const char* point) {
            const Grid p = grid_point(point);
            low = low.cwiseMin(p);
            high = high.cwiseMax(p);
        });
        const Vec3 one = low.cast<double>().cwiseProduct(header_.scale) + header_.offset;
        const Vec3 other = high.cast<double>().cwiseProduct(header_.scale) + header_.offset;
        cloud_.frame.origin = distant_origin({one.cwiseMin(other), one.cwiseMax(other)});
    }

    /// The offset goes to the origin before the integers come to it: near zero a double has bits for the smallest step.
    void read_positions() {
        const Vec3 near_offset = header_.offset - cloud_.frame.origin;
        Array<Vec3> positions(header_.points);
        for_each_point([&](std::size_t row, const char* point) {
            positions[row] = grid_point(point).cast<double>().cwiseProduct(header_.scale) + near_offset;
        });
        cloud_.positions = std::move(positions);
    }

    /// A column of what `convert` makes of the number of type Source at `offset`.
    template <class Source, class Convert>
    void declare(std::string name, std::size_t offset, Convert convert, bool only_if_set = false) {
        using Target = decltype(convert(Source{}));
        const auto values = std::make_shared<Array<Target>>(header_.points);
        const std::size_t stride = header_.point_size;
        fields_.push_back({[=](const char* points, std::size_t first, std::size_t count) {
                               for (std::size_t i = 0; i < count; ++i)
                                   (*values)[first + i] = convert(little_endian<Source>(points + i * stride + offset));
                           },
                           [this, name = std::move(name), values, only_if_set] {
                               if (only_if_set &&
                                   std::ranges::all_of(*values, [](Target value) { return value == Target(0); }))
                                   return;
                               columns_.add(Column(name, 1, Buffer(std::move(*values))));
                           }});
    }

    template <class Source>
    void declare(std::string name, std::size_t offset) {
        declare<Source>(std::move(name), offset, [](Source value) { return value; });
    }

    /// Some bits of a byte.
    void declare_bits(std::string name, std::size_t offset, u32 shift, u32 bits, bool only_if_set) {
        declare<u8>(
            std::move(name), offset, [=](u8 byte) { return static_cast<u8>(byte >> shift & ((1u << bits) - 1)); },
            only_if_set);
    }

    void declare_old_fields() {
        declare<std::uint16_t>("intensity", 12);
        declare_bits("return_number", 14, 0, 3, false);
        declare_bits("number_of_returns", 14, 3, 3, false);
        declare_bits("classification", 15, 0, 5, false);
        declare<std::int8_t>("scan_angle", 16, [](std::int8_t angle) { return static_cast<float>(angle); });
        declare<u8>("user_data", 17);
        declare<std::uint16_t>("point_source_id", 18);
        declare_bits("scan_direction", 14, 6, 1, true);
        declare_bits("edge_of_flight_line", 14, 7, 1, true);
        declare_bits("synthetic", 15, 5, 1, true);
        declare_bits("key_point", 15, 6, 1, true);
        declare_bits("withheld", 15, 7, 1, true);
        after_basics_ = 20;
    }

    void declare_new_fields() {
        constexpr float step = 0.006f;  // degrees
        declare<std::uint16_t>("intensity", 12);
        declare_bits("return_number", 14, 0, 4, false);
        declare_bits("number_of_returns", 14, 4, 4, false);
        declare<u8>("classification", 16);
        declare<std::int16_t>("scan_angle", 18, [](std::int16_t angle) { return static_cast<float>(angle) * step; });
        declare<u8>("user_data", 17);
        declare<std::uint16_t>("point_source_id", 20);
        declare_bits("synthetic", 15, 0, 1, true);
        declare_bits("key_point", 15, 1, 1, true);
        declare_bits("withheld", 15, 2, 1, true);
        declare_bits("overlap", 15, 3, 1, true);
        declare_bits("scanner_channel", 15, 4, 2, true);
        declare_bits("scan_direction", 15, 6, 1, true);
        declare_bits("edge_of_flight_line", 15, 7, 1, true);
        after_basics_ = 22;
    }

    void declare_further_fields() {
        if (header_.has_gps_time()) {
            declare<double>("gps_time", after_basics_);
            after_basics_ += sizeof(double);
        }
        if (header_.has_colour()) {
            declare_colour(after_basics_);
            after_basics_ += 3 * sizeof(std::uint16_t);
        }
        if (header_.has_nir()) declare<std::uint16_t>("nir", after_basics_);
        if (header_.has_wave_packets()) warn(options_.on_warning, "the wave packets of the points were left out");
    }

    void declare_colour(std::size_t offset) {
        const auto colours = std::make_shared<Array<std::uint16_t>>(3 * header_.points);
        const std::size_t stride = header_.point_size;
        fields_.push_back({[=](const char* points, std::size_t first, std::size_t count) {
                               for (std::size_t i = 0; i < count; ++i)
                                   for (std::size_t channel = 0; channel < 3; ++channel)
                                       (*colours)[3 * (first + i) + channel] =
                                           little_endian<std::uint16_t>(points + i * stride + offset + 2 * channel);
                           },
                           [this, colours] { add_colour(std::move(*colours)); }});
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
            columns_.add(Column("colour16", 3, Buffer(std::move(colours))));
            return;
        }
        if (*factor != 1) warn(options_.on_warning, "the colours are bytes times {}; they were divided by it", *factor);
        Array<u8> bytes(colours.size());
        for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<u8>(colours[i] / *factor);
        columns_.add(Column("colour", 3, Buffer(std::move(bytes))));
    }

    void declare_extras() {
        for (const LasExtra& extra : extras_)
            visit_scalar(extra.type, [&](auto zero) {
                using Source = decltype(zero);
                if (extra.is_scaled)
                    declare_extra<Source, double>(extra, [&extra](Source value, std::size_t component) {
                        return static_cast<double>(value) * extra.scale[component] + extra.shift[component];
                    });
                else
                    declare_extra<Source, Source>(extra, [](Source value, std::size_t) { return value; });
            });
    }

    template <class Source, class Target, class Convert>
    void declare_extra(const LasExtra& extra, Convert convert) {
        const auto values = std::make_shared<Array<Target>>(extra.components * header_.points);
        const std::size_t stride = header_.point_size, width = extra.components, offset = extra.offset;
        fields_.push_back(
            {[=](const char* points, std::size_t first, std::size_t count) {
                 for (std::size_t i = 0; i < count; ++i)
                     for (std::size_t c = 0; c < width; ++c)
                         (*values)[(first + i) * width + c] =
                             convert(little_endian<Source>(points + i * stride + offset + c * sizeof(Source)), c);
             },
             [this, &extra, values] {
                 columns_.add(Column(free_name(extra.name), extra.components, Buffer(std::move(*values))));
             }});
    }

    /// The name, or one made of it when a column has it already.
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
        // Blocks that stay in the cache while field after field is picked out of them.
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
    std::size_t after_basics_ = 0;
    std::vector<Field> fields_;
    ColumnTable columns_;
    PointCloud cloud_;
};

}  // namespace

PointCloud read_las_points(const LasHeader& header, const std::vector<LasExtra>& extras, std::string_view bytes,
                           const ReadOptions& options) {
    return PointsReader(header, extras, bytes, options).read();
}

}  // namespace scanmill
