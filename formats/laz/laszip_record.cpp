// SPDX-License-Identifier: GPL-3.0-or-later
#include "laz/laszip_record.hpp"

#include <algorithm>
#include <cstring>

namespace scanmill::laz {

namespace {

constexpr const char* newer_hint =
    "convert the file with the program that wrote it, or with a new version of a free one: pdal translate in.laz "
    "out.las";
constexpr const char* damaged_hint = "the file is damaged: fetch or export it again";

const LasRecord& require_record(const LasParts& parts) {
    constexpr u32 laszip_id = 22204;
    const auto is_laszip = [](const LasRecord& record) {
        return record.user == "laszip encoded" && record.id == laszip_id;
    };
    const auto found = std::ranges::find_if(parts.records, is_laszip);
    if (found == parts.records.end())
        throw Error(
            "its points are compressed, but none of its {} describes how: LASzip's record 'laszip encoded' {} "
            "is missing",
            count_text(parts.records.size(), "variable length record", "variable length records"), laszip_id)
            .hint(damaged_hint);
    return *found;
}

/// The type of a part, which damaged files set to numbers that the enumeration does not have.
unsigned type_of(const LASitem& item) {
    unsigned type = 0;
    static_assert(sizeof item.type == sizeof type);
    std::memcpy(&type, &item.type, sizeof type);
    return type;
}

/// The name of a part of a point in the specification of LAZ; its number if it has none.
std::string name_of(const LASitem& item) {
    switch (type_of(item)) {
        case LASitem::BYTE: return "BYTE";
        case LASitem::POINT10: return "POINT10";
        case LASitem::GPSTIME11: return "GPSTIME11";
        case LASitem::RGB12: return "RGB12";
        case LASitem::WAVEPACKET13: return "WAVEPACKET13";
        case LASitem::POINT14: return "POINT14";
        case LASitem::RGB14: return "RGB14";
        case LASitem::RGBNIR14: return "RGBNIR14";
        case LASitem::WAVEPACKET14: return "WAVEPACKET14";
        case LASitem::BYTE14: return "BYTE14";
        default: return "of type " + std::to_string(type_of(item));
    }
}

int newest_version(const LASitem& item) {
    switch (item.type) {
        case LASitem::WAVEPACKET13: return 1;
        case LASitem::POINT10:
        case LASitem::GPSTIME11:
        case LASitem::RGB12:
        case LASitem::BYTE: return 2;
        default: return 4;
    }
}

/// Whether LASzip's decoders know the version of a part that they have.
bool is_known(const LASitem& item) {
    const bool is_new = newest_version(item) == 4;
    const int oldest = !is_new ? 1 : item.type == LASitem::WAVEPACKET14 ? 3 : 2;
    return item.version >= oldest && item.version <= newest_version(item);
}

void require_known_method(const LASzip& laszip) {
    if (laszip.compressor < LASZIP_COMPRESSOR_POINTWISE || laszip.compressor >= LASZIP_COMPRESSOR_TOTAL_NUMBER_OF)
        throw Error("its points are compressed by method {} of {}; methods 1 to {} are read", laszip.compressor,
                    version_of(laszip), LASZIP_COMPRESSOR_TOTAL_NUMBER_OF - 1)
            .hint(newer_hint);
    if (laszip.coder != LASZIP_CODER_ARITHMETIC)
        throw Error("its points are coded by coder {} of {}; coder {} is read", laszip.coder, version_of(laszip),
                    LASZIP_CODER_ARITHMETIC)
            .hint(newer_hint);
}

void require_items(const LASzip& laszip, const LasHeader& header) {
    const auto refuse_layout = [&](const std::string& found) {
        throw Error("LASzip's record describes {}; the header declares point format {} of {} bytes", found,
                    header.point_format, header.point_size)
            .hint(damaged_hint);
    };
    LASzip expected;
    if (!expected.setup(static_cast<U8>(header.point_format), static_cast<U16>(header.point_size),
                        LASZIP_COMPRESSOR_LAYERED_CHUNKED))
        refuse_layout("an unknown point");
    if (laszip.num_items != expected.num_items)
        refuse_layout(count_text(laszip.num_items, "part of a point", "parts of a point") + " instead of " +
                      std::to_string(expected.num_items));
    for (U16 i = 0; i < laszip.num_items; ++i) {
        const LASitem &item = laszip.items[i], &wanted = expected.items[i];
        if (type_of(item) != type_of(wanted) || item.size != wanted.size)
            refuse_layout(fmt::format("the part {} of {} bytes instead of {} of {}", name_of(item), item.size,
                                      name_of(wanted), wanted.size));
        if (!is_known(item))
            throw Error("the part {} of its points is compressed in version {}, by {}; the newest that is read is {}",
                        name_of(item), item.version, version_of(laszip), newest_version(item))
                .hint(newer_hint);
    }
    if (has_layers(laszip) != (laszip.items[0].type == LASitem::POINT14))
        refuse_layout(fmt::format("method {}, which has {}", laszip.compressor,
                                  has_layers(laszip) ? "point formats 6 to 10" : "point formats 0 to 5"));
}

}  // namespace

std::unique_ptr<LASzip> read_laszip_record(const LasParts& parts) {
    constexpr std::size_t head_size = 34, item_size = 6;
    const std::string_view content = require_record(parts).content;
    const std::size_t items =
        content.size() < head_size ? 0 : little_endian<std::uint16_t>(content.data() + head_size - 2);
    // LASzip trusts the number of items.
    if (items == 0 || content.size() != head_size + items * item_size)
        throw Error("LASzip's record has {} for {}; it needs {}", count_text(content.size(), "byte", "bytes"),
                    count_text(items, "part of a point", "parts of a point"),
                    head_size + std::max<std::size_t>(items, 1) * item_size)
            .hint(damaged_hint);
    auto laszip = std::make_unique<LASzip>();
    // Its own check of the parts is less strict and less clear than require_items().
    laszip->unpack(reinterpret_cast<const U8*>(content.data()), static_cast<int>(content.size()));
    require_known_method(*laszip);
    require_items(*laszip, parts.header);
    if (!is_one_run(*laszip) && laszip->chunk_size == 0)
        throw Error("LASzip's record declares chunks of 0 points").hint(damaged_hint);
    return laszip;
}

std::string version_of(const LASzip& laszip) {
    return fmt::format("LASzip {}.{}", laszip.version_major, laszip.version_minor);
}

}  // namespace scanmill::laz
