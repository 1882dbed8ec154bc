// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// LAZ files in memory, written by LASzip's own encoders.

#include "bytestreamin_array.hpp"
#include "bytestreamout_array.hpp"
#include "core/formats/las/las_support.hpp"
#include "lasreadpoint.hpp"
#include "laswritepoint.hpp"
#include "laszip.hpp"
#include "scanmill/io/output_buffer.hpp"
#if defined(__SANITIZE_ADDRESS__)
#include <sanitizer/lsan_interface.h>
#endif

namespace scanmill::test {

/// How LASzip compresses the points.
struct Compression {
    u32 method = LASZIP_COMPRESSOR_LAYERED_CHUNKED;  ///< for point formats 0 to 5 it becomes LASZIP_COMPRESSOR_CHUNKED
    u32 version = 0;  ///< of the parts of a point; 0: the usual one
    u32 chunk_size = 50;
    /// The numbers of points of the chunks, if they differ.
    std::vector<std::size_t> chunks = {};
};

inline constexpr u32 laszip_id = 22204;

/// The points, compressed, with the table of chunks. Pre: they begin at byte `begin` of the file.
inline std::string compressed_points(const LasBytes& las, const Compression& how, LASzip& laszip, std::size_t begin) {
#if defined(__SANITIZE_ADDRESS__)
    const __lsan::ScopedDisabler disabler;  // LASzip's writer does not free its table of chunks
#endif
    LASreadPoint reader;
    LASwritePoint writer;
    // The uncompressed records, as LASzip reads them into its own structs.
    std::string records;
    for (const std::string& point : las.points) records += point;
    ByteStreamInArrayLE in(reinterpret_cast<const U8*>(records.data()), static_cast<I64>(records.size()));
    reader.setup(laszip.num_items, laszip.items);
    reader.init(&in);
    ByteStreamOutArrayLE out;
    for (std::size_t i = 0; i < begin; ++i) out.putByte(0);
    writer.setup(laszip.num_items, laszip.items, &laszip);
    writer.init(&out);

    std::vector<std::array<double, 32>> room(laszip.num_items);
    std::vector<U8*> parts;
    for (auto& part : room) parts.push_back(reinterpret_cast<U8*>(part.data()));
    constexpr std::size_t point_type = 22;  // a byte of POINT14's struct that writers ask for
    std::size_t chunk = 0, in_chunk = 0;
    for (std::size_t i = 0; i < las.points.size(); ++i) {
        reader.read(parts.data());
        if (laszip.items[0].type == LASitem::POINT14) parts[0][point_type] |= 1;
        writer.write(parts.data());
        if (chunk < how.chunks.size() && ++in_chunk == how.chunks[chunk]) {
            writer.chunk();
            ++chunk;
            in_chunk = 0;
        }
    }
    writer.done();
    return {reinterpret_cast<const char*>(out.getData()) + begin, static_cast<std::size_t>(out.getSize()) - begin};
}

/// The same file as `las`, compressed. `spoil`, if given, changes what LASzip's record declares.
inline std::string laz_file(LasBytes las, const Compression& how = {},
                            const std::function<void(std::string& record)>& spoil = {}) {
    LASzip laszip;
    EXPECT_TRUE(laszip.setup(static_cast<U8>(las.point_format), static_cast<U16>(las.points.at(0).size()),
                             static_cast<U16>(how.method)));
    if (how.version) laszip.request_version(static_cast<U16>(how.version));
    laszip.set_chunk_size(how.chunks.empty() ? how.chunk_size : U32_MAX);
    U8* packed = nullptr;
    int size = 0;
    EXPECT_TRUE(laszip.pack(packed, size));
    std::string record(reinterpret_cast<const char*>(packed), static_cast<std::size_t>(size));
    if (spoil) spoil(record);
    las.add_record("laszip encoded", laszip_id, record);
    const std::size_t begin = las.header_size() + las.records.size();
    const std::string points = compressed_points(las, how, laszip, begin);
    constexpr u32 compressed = 128;
    las.point_format |= compressed;
    const std::string trailing = std::exchange(las.trailing, "");
    return las.file().substr(0, begin) + points + trailing;
}

/// Reproducible bytes that look random.
class Noise {
public:
    u32 next(u32 below) {
        state_ = state_ * 6364136223846793005u + 1442695040888963407u;
        return static_cast<u32>(state_ >> 33) % below;
    }

private:
    u64 state_ = 1;
};

inline constexpr std::array<std::size_t, 11> las_sizes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};

/// Points with all fields in use: neighbours in space with noise in every other byte, and `extra` described bytes.
inline LasBytes noisy_points(u32 format, std::size_t count, std::size_t extra = 0) {
    LasBytes las;
    las.minor_version = 4;
    las.point_format = format;
    las.scale = {0.001, 0.001, 0.01};
    las.offset = {500000, 4500000, 100};
    Noise noise;
    const std::size_t size = las_sizes[format] + extra;
    for (std::size_t i = 0; i < count; ++i) {
        const auto at = [&](u32 step) { return static_cast<std::int32_t>(i * step + noise.next(100)); };
        std::string point = las_point(size, at(13), at(7), static_cast<std::int32_t>(noise.next(1000)) - 500);
        for (std::size_t byte = 12; byte < size; ++byte)
            if (noise.next(4) == 0) point[byte] = static_cast<char>(noise.next(256));
        las.points.push_back(point);
    }
    std::string described;
    for (std::size_t i = 0; i < extra; ++i) described += las_extra(1, "extra " + std::to_string(i));
    if (extra > 0) las.add_record("LASF_Spec", 4, described);
    return las;
}

}  // namespace scanmill::test
