// SPDX-License-Identifier: GPL-3.0-or-later
#include "laz/chunk_decoder.hpp"

#include <algorithm>

namespace scanmill::laz {

namespace {

/// Layered chunks begin with a point and the number of points, then the size of each layer.
constexpr std::size_t count_size = 4, layer_size = 4;

/// The number of layers of a part of a point.
std::size_t layers_of(const LASitem& item) {
    switch (item.type) {
        case LASitem::POINT14: return 9;
        case LASitem::RGBNIR14: return 2;
        case LASitem::BYTE14: return item.size;
        default: return 1;
    }
}

/// Room that LASzip needs for a part: it restores POINT14 as a larger struct.
std::size_t room_of(const LASitem& item) { return item.type == LASitem::POINT14 ? 64 : item.size; }

/// Converts LASzip's struct of a point of formats 6 to 10 to the 30 bytes of a LAS record. The struct has the old
/// fields first, then the new ones from byte 20 and the time at byte 32.
void put_point14(const U8* from, char* to) {
    constexpr std::size_t channel_and_flags = 22, classification = 23, returns = 24, time = 32;
    const u32 channel = from[channel_and_flags] >> 2 & 3u, flags = from[channel_and_flags] >> 4;
    const u32 direction_and_edge = from[14] >> 6;
    std::memcpy(to, from, 14);  // position and intensity
    to[14] = static_cast<char>(from[returns]);
    to[15] = static_cast<char>(flags | channel << 4 | direction_and_edge << 6);
    to[16] = static_cast<char>(from[classification]);
    to[17] = static_cast<char>(from[17]);      // user data
    std::memcpy(to + 18, from + 20, 2);        // scan angle
    std::memcpy(to + 20, from + 18, 2);        // point source
    std::memcpy(to + 22, from + time, 8);
}

}  // namespace

ChunkDecoder::ChunkDecoder(const LasParts& parts, const LASzip& laszip, const Chunk& chunk)
    : header_(parts.header),
      laszip_(laszip),
      chunk_(chunk) {
    if (has_layers(laszip))
        require_layers();
    else
        require_code(chunk.bytes.substr(std::min(header_.point_size, chunk.bytes.size())));
    // LASreadPoint first reads the 8 bytes that precede the chunks, unless all points are one run. A stream that cannot
    // go back makes it ignore them, so that any bytes do.
    const std::size_t ignored = is_one_run(laszip) ? 0 : address_size;
    bytes_.init(reinterpret_cast<const U8*>(chunk.bytes.data()) - ignored,
                static_cast<I64>(chunk.bytes.size() + ignored));
    std::size_t size = 0;
    for (U16 i = 0; i < laszip.num_items; ++i) size += (room_of(laszip.items[i]) + 7) / 8;
    room_.assign(size, 0);
    size = 0;
    for (U16 i = 0; i < laszip.num_items; ++i) {
        parts_.push_back(reinterpret_cast<U8*>(room_.data() + size));
        size += (room_of(laszip.items[i]) + 7) / 8;
    }
    // For LASreadPoint the chunk is the first of a file whose chunks have this many points.
    one_chunk_.compressor = laszip.compressor;
    one_chunk_.coder = laszip.coder;
    one_chunk_.chunk_size = static_cast<U32>(std::min<u64>(chunk.points, U32_MAX - 1));
    one_chunk_.num_items = laszip.num_items;
    one_chunk_.items = new LASitem[laszip.num_items];  // LASzip deletes them
    std::copy_n(laszip.items, laszip.num_items, one_chunk_.items);
    if (!reader_.setup(one_chunk_.num_items, one_chunk_.items, &one_chunk_) || !reader_.init(&bytes_))
        throw_damaged("LASzip has no decoder for it");
}

/// LASzip adds the sizes of layers in 32 bits and trusts the sum.
void ChunkDecoder::require_layers() const {
    std::size_t layers = 0;
    for (U16 i = 0; i < laszip_.num_items; ++i) layers += layers_of(laszip_.items[i]);
    const u64 head = header_.point_size + count_size + layers * layer_size;
    if (chunk_.bytes.size() < head)
        throw_damaged(fmt::format("it has {}, but its layers begin at byte {}",
                                  count_text(chunk_.bytes.size(), "byte", "bytes"), head));
    const char* at = chunk_.bytes.data() + header_.point_size;
    if (const u32 count = little_endian<u32>(at); count < chunk_.points)
        throw_damaged(fmt::format("it declares {} instead of {}", count_text(count, "point", "points"), chunk_.points));
    u64 sum = head;
    for (std::size_t i = 0; i < layers; ++i) {
        const u64 size = little_endian<u32>(at + count_size + i * layer_size);
        if (size > chunk_.bytes.size() - sum)
            throw_damaged(fmt::format("layer {} has {} at byte {}, but the chunk has {}", i + 1,
                                      count_text(size, "byte", "bytes"), sum, chunk_.bytes.size()));
        require_code(chunk_.bytes.substr(sum, size));
        sum += size;
    }
    if (sum != chunk_.bytes.size())
        throw_damaged(
            fmt::format("its layers take {}, but it has {}", count_text(sum, "byte", "bytes"), chunk_.bytes.size()));
}

void ChunkDecoder::require_code(std::string_view code) const {
    if (is_impossible(code)) throw_damaged("its code begins with a number that no encoder writes");
}

void ChunkDecoder::throw_damaged(const std::string& what) const {
    throw Error("chunk {} of {} is damaged: {}", chunk_.number, chunk_.of, what)
        .hint("the file is truncated or damaged: fetch or export it again");
}

void ChunkDecoder::read(std::span<char> records) {
    const bool is_new = laszip_.items[0].type == LASitem::POINT14;
    for (std::size_t at = 0; at < records.size(); at += header_.point_size, ++read_) {
        if (!reader_.read(parts_.data()))
            throw_damaged(fmt::format("{} of its {} {} restored", read_, count_text(chunk_.points, "point", "points"),
                                      by_count(read_, "was", "were")));
        char* to = records.data() + at;
        for (std::size_t i = 0; i < parts_.size(); ++i) {
            const LASitem& item = laszip_.items[i];
            if (i == 0 && is_new)
                put_point14(parts_[i], to);
            else
                std::memcpy(to, parts_[i], item.size);
            to += item.size;
        }
    }
}

void ChunkDecoder::require_end() const {
    if (!chunk_.is_whole) return;
    const auto used = static_cast<u64>(bytes_.tell()) - address_size;
    if (used != chunk_.bytes.size())
        throw_damaged(
            fmt::format("its points end after {} of its {}", used, count_text(chunk_.bytes.size(), "byte", "bytes")));
}

}  // namespace scanmill::laz
