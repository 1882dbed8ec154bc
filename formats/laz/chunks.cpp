// SPDX-License-Identifier: GPL-3.0-or-later
#include "laz/chunks.hpp"

#include <algorithm>

#include "bytestreamin_array.hpp"
#include "integercompressor.hpp"

namespace scanmill::laz {

namespace {

constexpr const char* interrupted_hint =
    "the file is truncated, or the program that wrote it was interrupted: fetch or export it again";
constexpr std::size_t table_head = 8;

/// A chunk as the table stores it.
struct Entry {
    u64 points = 0, size = 0;
};

/// The address of the table, which precedes the chunks. If the writer could not go back, the address ends the file.
u64 table_address(const LasParts& parts) {
    const u64 begin = parts.header.points_begin, size = parts.bytes.size();
    if (size - begin < address_size)
        throw Error("{} from byte {} on; the address of the table of chunks takes {}",
                    count_text(size - begin, "byte follows", "bytes follow"), begin, address_size)
            .hint(interrupted_hint);
    const auto address_at = [&](u64 at) { return little_endian<u64>(parts.bytes.data() + at); };
    u64 address = address_at(begin);
    if (address == ~u64(0)) address = address_at(size - address_size);
    if (address < begin + address_size || address > size || size - address < table_head)
        throw Error("the table of chunks would begin at byte {}; the file has {}, and its chunks begin at byte {}",
                    address, count_text(size, "byte", "bytes"), begin + address_size)
            .hint(interrupted_hint);
    return address;
}

/// Reads the table with LASzip's decoder.
std::vector<Entry> read_entries(const LasParts& parts, const LASzip& laszip, u64 address) {
    const char* const head = parts.bytes.data() + address;
    if (const u32 version = little_endian<u32>(head); version != 0)
        throw Error("the table of chunks at byte {} has version {}; version 0 is read", address, version)
            .hint(interrupted_hint);
    const u32 count = little_endian<u32>(head + 4);
    // A chunk begins with an uncompressed point.
    const u64 most = (address - parts.header.points_begin) / parts.header.point_size;
    if (count > most)
        throw Error("the table of chunks has {}; the bytes before it hold {} at most",
                    count_text(count, "entry", "entries"), most)
            .hint(interrupted_hint);
    std::vector<Entry> entries;
    if (count == 0) return entries;
    const std::string_view coded = parts.bytes.substr(address + table_head);
    try {
        if (is_impossible(coded)) throw EOF;
        ByteStreamInArrayLE stream(reinterpret_cast<const U8*>(coded.data()), static_cast<I64>(coded.size()));
        ArithmeticDecoder decoder;
        decoder.init(&stream);
        IntegerCompressor numbers(&decoder, 32, 2);
        numbers.initDecompressor();
        Entry last;
        for (u32 i = 0; i < count; ++i) {
            if (has_chunk_counts(laszip))
                last.points = static_cast<u32>(numbers.decompress(static_cast<I32>(last.points), 0));
            last.size = static_cast<u32>(numbers.decompress(static_cast<I32>(last.size), 1));
            entries.push_back(last);
        }
    } catch (int) {
        throw Error("the table of chunks at byte {} is truncated or damaged after {} of {}", address, entries.size(),
                    count_text(count, "entry", "entries"))
            .hint(interrupted_hint);
    }
    return entries;
}

}  // namespace

std::vector<Chunk> chunks_of(const LasParts& parts, const LASzip& laszip) {
    const LasHeader& header = parts.header;
    if (is_one_run(laszip)) return {{parts.bytes.substr(header.points_begin), header.points, 1, 1, false}};
    const u64 address = table_address(parts);
    const std::vector<Entry> entries = read_entries(parts, laszip, address);
    std::vector<Chunk> chunks;
    u64 at = header.points_begin + address_size, points = 0;
    const auto is_filled = [&](const Entry& entry) {
        return entry.size > 0 && (entry.points > 0 || !has_chunk_counts(laszip));
    };
    for (std::size_t i = 0; i < entries.size(); ++i) {
        const Entry& entry = entries[i];
        if (points == header.points) {
            if (!is_filled(entry)) continue;
            throw Error("promises {}; they end with chunk {} of {}", count_text(header.points, "point", "points"), i,
                        count_text(entries.size(), "chunk", "chunks"))
                .hint(interrupted_hint);
        }
        if (entry.size < header.point_size || entry.size > address - at)
            throw Error("chunk {} of {} would have {} from byte {} on; the table of chunks begins at byte {}", i + 1,
                        entries.size(), count_text(entry.size, "byte", "bytes"), at, address)
                .hint(interrupted_hint);
        const u64 held = has_chunk_counts(laszip) ? entry.points : laszip.chunk_size;
        const u64 used = std::min<u64>(held, header.points - points);
        // The table has no number of points for the last of equally large chunks; it is what the header declares.
        const bool is_whole = !has_chunk_counts(laszip) || used == held;
        if (used > 0) chunks.push_back({parts.bytes.substr(at, entry.size), used, i + 1, entries.size(), is_whole});
        at += entry.size;
        points += used;
    }
    if (points < header.points)
        throw Error("promises {}; its {} hold {}", count_text(header.points, "point", "points"),
                    count_text(entries.size(), "chunk", "chunks"), points)
            .hint(interrupted_hint);
    return chunks;
}

}  // namespace scanmill::laz
