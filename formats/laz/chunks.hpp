// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The chunks of a LAZ file: runs of points that are restored independently.

#include <vector>

#include "laz/laszip_record.hpp"

namespace scanmill::laz {

/// The bytes before the first chunk, which contain the address of the table of chunks.
constexpr std::size_t address_size = 8;

/// Whether an arithmetic code begins with the one number of 32 bits that no encoder writes. It would lead LASzip's
/// decoder beyond its tables; all other codes keep it within them.
inline bool is_impossible(std::string_view code) { return code.starts_with("\xff\xff\xff\xff"); }

struct Chunk {
    std::string_view bytes;
    u64 points = 0;
    std::size_t number = 0;  ///< from 1, for messages
    std::size_t of = 0;      ///< number of chunks of the file
    bool is_whole = true;    ///< whether `points` are all its points
};

/// The chunks that hold the points that the header declares, in order. The last one may hold more points. Throws Error
/// if the table of chunks is missing or damaged, if the chunks hold fewer points, or if the points end before the last
/// chunk.
/// Cost: memory in proportion to the size of the file, whatever the table declares.
std::vector<Chunk> chunks_of(const LasParts& parts, const LASzip& laszip);

}  // namespace scanmill::laz
