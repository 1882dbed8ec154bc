// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Restores the points of one chunk with LASzip's decoder.

#include <array>
#include <memory>

#include "bytestreamin_array.hpp"
#include "lasreadpoint.hpp"
#include "laz/chunks.hpp"

namespace scanmill::laz {

class ChunkDecoder {
public:
    /// Throws Error if the sizes of the chunk's layers contradict the chunk. Pre: `laszip` is from read_laszip_record()
    /// for this header; `parts` and `laszip` outlive the object.
    ChunkDecoder(const LasParts& parts, const LASzip& laszip, const Chunk& chunk);

    /// Restores the next points into records of the header's point size. Throws Error if the chunk is damaged.
    void read(std::span<char> records);
    /// Throws Error unless all bytes of the chunk were used. Pre: `chunk.points` points were read. Does nothing if the
    /// chunk holds more.
    void require_end() const;

private:
    /// The bytes of the chunk. Reading past them throws an int, which LASreadPoint catches.
    class Bytes : public ByteStreamInArrayLE {
    public:
        using ByteStreamInArrayLE::ByteStreamInArrayLE;
        /// A stream that cannot go back makes LASreadPoint decode what follows without looking for a table of chunks.
        BOOL isSeekable() const { return FALSE; }
    };

    void require_layers() const;
    void require_code(std::string_view code) const;
    [[noreturn]] void throw_damaged(const std::string& what) const;

    const LasHeader& header_;
    const LASzip& laszip_;
    Chunk chunk_;
    Bytes bytes_;
    LASzip one_chunk_;
    LASreadPoint reader_;
    u64 read_ = 0;
    /// Room for the parts of one point, each aligned.
    Array<double> room_;
    std::vector<U8*> parts_;
};

}  // namespace scanmill::laz
