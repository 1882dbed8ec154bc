// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/las_extra.hpp"

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
             counted(rest, "extra byte", "extra bytes"), by_count(rest, "is", "are"));
    return extras;
}

}  // namespace scanmill
