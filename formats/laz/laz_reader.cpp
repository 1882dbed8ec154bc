// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "laz/chunk_decoder.hpp"
#include "laz/laz.hpp"
#include "scanmill/base/parallel.hpp"

namespace scanmill::laz {

namespace {

using Put = std::function<void(std::string_view records)>;

/// Chunks of at most this many bytes of records are restored in parallel, each as a whole.
constexpr u64 most_buffered = u64(8) << 20;

/// Restores the points of one chunk after the other, piece by piece.
void decompress_serially(const LasParts& parts, const LASzip& laszip, const std::vector<Chunk>& chunks,
                         const Put& put) {
    constexpr std::size_t piece_size = std::size_t(1) << 21;
    const std::size_t size = parts.header.point_size, piece_points = piece_size / size;
    Array<char> records;
    for (const Chunk& chunk : chunks) {
        ChunkDecoder decoder(parts, laszip, chunk);
        for (u64 read = 0; read < chunk.points;) {
            const auto points = static_cast<std::size_t>(std::min<u64>(piece_points, chunk.points - read));
            records.resize(points * size);
            decoder.read(records);
            put({records.data(), records.size()});
            read += points;
        }
        decoder.require_end();
        if (parts.release) parts.release(chunk.bytes);
    }
}

void decompress(const LasParts& parts, unsigned threads, const Put& put) {
    const std::unique_ptr<LASzip> laszip = read_laszip_record(parts);
    const std::vector<Chunk> chunks = chunks_of(parts, *laszip);
    const std::size_t size = parts.header.point_size;
    const auto is_small = [&](const Chunk& chunk) { return chunk.points <= most_buffered / size; };
    if (threads <= 1 || !std::ranges::all_of(chunks, is_small)) return decompress_serially(parts, *laszip, chunks, put);
    for_each_in_order<Array<char>>(
        threads, chunks.size(),
        [&](std::size_t i, Array<char>& records) {
            records.resize(chunks[i].points * size);
            ChunkDecoder decoder(parts, *laszip, chunks[i]);
            decoder.read(records);
            decoder.require_end();
            if (parts.release) parts.release(chunks[i].bytes);
        },
        [&](std::size_t, const Array<char>& records) {
            put({records.data(), records.size()});
        });
}

}  // namespace

LoadedFile read_laz(const FileBytes& file, const ReadOptions& options) {
    const LazForm form{decompress, [](const LasParts& parts) { return version_of(*read_laszip_record(parts)); }};
    return read_las(file, options, &form);
}

bool may_stream_laz(std::string_view file) { return may_be_las_stream(file, true); }

std::unique_ptr<PointStream> open_laz_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads, const OnWorldPositions& on_positions) {
    return open_las_stream(std::move(file), options, threads, on_positions, decompress);
}

}  // namespace scanmill::laz
