// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/las/las_header.hpp"

#include <algorithm>
#include <cmath>

namespace scanmill {

namespace {

constexpr std::size_t format_at = 104;
constexpr u32 compression_bits = 0xc0;

constexpr std::array<std::size_t, 11> point_sizes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// A text field of fixed width, up to the first zero and without trailing blanks. Unprintable characters become '?'.
std::string text_at(std::string_view bytes, std::size_t begin, std::size_t width) {
    std::string text;
    for (const char c : bytes.substr(begin, width)) {
        if (c == '\0') break;
        text += c >= ' ' && c <= '~' ? c : '?';
    }
    while (!text.empty() && text.back() == ' ') text.pop_back();
    return text;
}

Vec3 vector_at(const char* source) {
    Vec3 vector;
    for (int axis = 0; axis < 3; ++axis) vector[axis] = little_endian<double>(source + 8 * axis);
    return vector;
}

std::size_t least_header(u32 minor_version) { return minor_version < 3 ? 227 : minor_version == 3 ? 235 : 375; }

void require_valid(const LasHeader& header, std::string_view bytes) {
    if (header.point_format >= point_sizes.size())
        throw Error("has points of format {}; LAS has 0 to {}", header.point_format, point_sizes.size() - 1);
    if (header.points_begin < header.size || header.points_begin > bytes.size())
        throw Error("the points begin at byte {}, but the header has {} and the file {}", header.points_begin,
                    count_text(header.size, "byte", "bytes"), count_text(bytes.size(), "byte", "bytes"))
            .hint(truncated_hint);
    if (header.point_size < point_sizes[header.point_format])
        throw Error("points of format {} take {} bytes or more; the header declares {}", header.point_format,
                    point_sizes[header.point_format], header.point_size)
            .hint(truncated_hint);
    for (int axis = 0; axis < 3; ++axis)
        if (!std::isfinite(header.scale[axis]) || header.scale[axis] == 0 || !std::isfinite(header.offset[axis]))
            throw Error("the scale {} and the offset {} of {} are invalid", header.scale[axis], header.offset[axis],
                        "xyz"[axis])
                .hint(truncated_hint);
}

constexpr std::size_t description_size = 192;

/// Types 1 to 10 of LAS. Types 11 to 20 are pairs of these types, types 21 to 30 triples.
constexpr std::array<ScalarType, 10> types{
    ScalarType::uint8, ScalarType::int8,   ScalarType::uint16, ScalarType::int16,   ScalarType::uint32,
    ScalarType::int32, ScalarType::uint64, ScalarType::int64,  ScalarType::float32, ScalarType::float64};

/// The extra bytes of a description, without their offset. Pre: `type` is from 1 to 30.
LasExtra described(std::string_view description, u32 type) {
    constexpr u32 scale_bit = 8, shift_bit = 16;
    LasExtra extra;
    extra.name = text_at(description, 4, 32);
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

bool LasHeader::has_colour() const {
    constexpr std::array<u32, 6> formats{2, 3, 5, 7, 8, 10};
    return std::ranges::find(formats, point_format) != formats.end();
}

bool LasHeader::has_wave_packets() const {
    constexpr std::array<u32, 4> formats{4, 5, 9, 10};
    return std::ranges::find(formats, point_format) != formats.end();
}

bool is_marked_compressed(std::string_view head) {
    return head.size() > format_at && (little_endian<u8>(head.data() + format_at) & compression_bits) != 0;
}

LasHeader read_las_header(std::string_view bytes) {
    constexpr std::size_t versions_end = 96;
    if (bytes.size() < versions_end)
        throw Error("is {} long; the header of a LAS file takes {} or more", count_text(bytes.size(), "byte", "bytes"),
                    least_header(0));
    const char* const at = bytes.data();
    LasHeader header;
    const u32 major = little_endian<u8>(at + 24);
    header.minor_version = little_endian<u8>(at + 25);
    if (major != 1 || header.minor_version > 4)
        throw Error("is of LAS version {}.{}; 1.0 to 1.4 are read", major, header.minor_version);
    header.size = little_endian<std::uint16_t>(at + 94);
    const std::size_t least = least_header(header.minor_version);
    if (header.size < least || header.size > bytes.size())
        throw Error("the header of LAS 1.{} takes {} bytes or more; it declares {}, and the file has {}",
                    header.minor_version, least, header.size, bytes.size())
            .hint(truncated_hint);

    header.system = text_at(bytes, 26, 32);
    header.software = text_at(bytes, 58, 32);
    header.points_begin = little_endian<u32>(at + 96);
    header.records = little_endian<u32>(at + 100);
    const u32 format = little_endian<u8>(at + format_at);
    header.is_compressed = (format & compression_bits) != 0;
    header.point_format = format & ~compression_bits;
    header.point_size = little_endian<std::uint16_t>(at + 105);
    header.points = little_endian<u32>(at + 107);
    header.scale = vector_at(at + 131);
    header.offset = vector_at(at + 155);
    if (header.minor_version >= 4) {
        header.extended_records = little_endian<u32>(at + 243);
        // The old field of 32 bits is zero if it cannot hold the number of points. Some programs write only the old
        // field.
        if (const u64 points = little_endian<u64>(at + 247); points > 0) header.points = points;
    }
    require_valid(header, bytes);
    return header;
}

void require_las_points(const LasHeader& header, std::string_view bytes) {
    const std::size_t room = bytes.size() - header.points_begin;
    if (header.points == 0)
        throw Error("holds no points: its header declares 0, and {} follow it", count_text(room, "byte", "bytes"));
    if (!header.is_compressed && header.points > room / header.point_size)
        throw Error("promises {} of {} bytes; the {} from byte {} on hold {}",
                    count_text(header.points, "point", "points"), header.point_size, count_text(room, "byte", "bytes"),
                    header.points_begin, room / header.point_size)
            .hint(truncated_hint);
    require_countable(header.points, "points");
}

std::vector<LasRecord> read_las_records(const LasHeader& header, std::string_view bytes, const ReadOptions& options) {
    constexpr std::size_t record_header = 54;
    std::vector<LasRecord> records;
    std::size_t at = header.size;
    for (u32 i = 0; i < header.records; ++i) {
        const std::size_t room = header.points_begin - at;
        const std::size_t length = room < record_header ? 0 : little_endian<std::uint16_t>(bytes.data() + at + 20);
        if (room < record_header || length > room - record_header) {
            warn(options.on_warning,
                 "variable length record {} of {} runs into the points; it and those after it were left out", i + 1,
                 header.records);
            break;
        }
        records.push_back({text_at(bytes, at + 2, 16), little_endian<std::uint16_t>(bytes.data() + at + 18),
                           bytes.substr(at + record_header, length)});
        at += record_header + length;
    }
    return records;
}

bool holds_geo_keys(const LasRecord& record) { return record.user == "LASF_Projection" && record.id == 34735; }

LengthUnit las_unit(const std::vector<LasRecord>& records, const ReadOptions& options) {
    constexpr u32 model_type = 1024, linear_unit = 3076, height_unit = 4099;
    constexpr u32 geographic = 2, metre = 9001, foot = 9002;
    u32 model = 0, unit = 0, height = 0;
    for (const LasRecord& record : records) {
        if (!holds_geo_keys(record)) continue;
        // Every entry has four numbers of 16 bits: the key, the location of its value (0: in this entry), the number of
        // values and the value.
        for (std::size_t at = 8; at + 8 <= record.content.size(); at += 8) {
            const auto number = [&](std::size_t i) -> u32 {
                return little_endian<std::uint16_t>(record.content.data() + at + 2 * i);
            };
            if (number(1) != 0) continue;
            if (number(0) == model_type) model = number(3);
            if (number(0) == linear_unit) unit = number(3);
            if (number(0) == height_unit) height = number(3);
        }
    }
    if (model == geographic) {
        warn(options.on_warning,
             "x and y are degrees of longitude and latitude by the file's GeoTIFF keys, not lengths: project them "
             "first");
        return options.unit;
    }
    if (options.unit != LengthUnit::unknown) return options.unit;
    if (unit == 0) return LengthUnit::unknown;
    if (height != 0 && height != unit) {
        warn(options.on_warning,
             "lengths are of unit {} but heights of unit {} by the GeoTIFF keys; the unit stays unknown", unit, height);
        return LengthUnit::unknown;
    }
    if (unit == metre) return LengthUnit::metre;
    if (unit == foot) return LengthUnit::foot;
    warn(options.on_warning,
         "the unit {} of the GeoTIFF keys is neither metre ({}) nor foot ({}); the unit stays unknown", unit, metre,
         foot);
    return LengthUnit::unknown;
}

bool describes_extra_bytes(const LasRecord& record) {
    constexpr u32 extra_bytes = 4;
    return record.user == "LASF_Spec" && record.id == extra_bytes;
}

std::vector<LasExtra> read_las_extra(const LasHeader& header, const std::vector<LasRecord>& records,
                                     const ReadOptions& options) {
    std::vector<LasExtra> extras;
    std::size_t at = point_sizes[header.point_format];
    std::size_t described_bytes = 0;
    for (const LasRecord& record : records) {
        if (!describes_extra_bytes(record)) continue;
        for (std::size_t i = 0; i + description_size <= record.content.size(); i += description_size) {
            const std::string_view description = record.content.substr(i, description_size);
            const u32 type = little_endian<u8>(description.data() + 2);
            if (type == 0 || type > 3 * types.size()) {
                at += little_endian<u8>(description.data() + 3);  // the number of undescribed bytes
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
    const std::size_t rest = header.point_size - point_sizes[header.point_format] - described_bytes;
    if (rest > 0)
        warn(options.on_warning, "{} of each point {} without a described type and left out",
             count_text(rest, "extra byte", "extra bytes"), by_count(rest, "is", "are"));
    return extras;
}

}  // namespace scanmill
