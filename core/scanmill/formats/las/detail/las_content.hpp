// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Everything of a LAS file except its points, with the warnings about it.

#include "scanmill/formats/las/las_file.hpp"

namespace scanmill {

constexpr std::string_view las_magic = "LASF";

struct LasContent {
    LasParts parts;
    std::vector<LasExtra> extras;
    LengthUnit unit = LengthUnit::unknown;
    std::vector<std::string> comments;
    bool is_copc = false;

    /// The records of an uncompressed file.
    std::string_view points() const {
        return parts.bytes.substr(parts.header.points_begin, parts.header.points * parts.header.point_size);
    }
};

/// Whether the file's points are compressed, by its header or by a record of LASzip.
bool is_compressed(const LasParts& parts);

/// Throws Error for a file that is refused because of its header, or that is compressed although `reads_compressed` is
/// false, or the other way round.
LasContent read_las_content(const FileBytes& file, const ReadOptions& options, bool reads_compressed);

}  // namespace scanmill
