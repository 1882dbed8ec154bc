// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Reads LAS files whose points are in the file, and LAZ files whose points a decompressor restores. Both give the same
/// frame, positions and columns, see las_format().

#include "scanmill/formats/las/las_header.hpp"

namespace scanmill {

/// The parts of a LAS or LAZ file that lead to its points.
struct LasParts {
    LasHeader header;
    std::vector<LasRecord> records;
    std::string_view bytes;  ///< the whole file
    /// Called with bytes that are not needed again, from any thread: frees their pages. May be empty.
    std::function<void(std::string_view part)> release = {};
};

/// Restores all points of a compressed file, in order, as the records that an uncompressed file of the same point
/// format has. Calls `put` with one or more records at a time, in this thread; works on up to `threads` threads. Throws
/// Error if the points are damaged or if there are fewer than the header declares; returns exactly as many as it
/// declares.
using LasDecompress = std::function<void(const LasParts& parts, unsigned threads,
                                         const std::function<void(std::string_view records)>& put)>;

/// Names of compressed files: "LAZ", and how their points are compressed.
struct LazForm {
    LasDecompress decompress;
    /// "LASzip 2.2"; throws Error if the compression is unknown.
    std::function<std::string(const LasParts& parts)> encoding;
};

/// Reads the whole file. Without `laz`, compressed files are refused, with a hint how to convert them. With it, only
/// compressed files are read.
LoadedFile read_las(const FileBytes& file, const ReadOptions& options, const LazForm* laz = nullptr);

/// See Format::may_stream.
bool may_be_las_stream(std::string_view file, bool is_compressed);

/// See Format::open_stream. The points of compressed files are restored once, into an unnamed file in the temporary
/// folder that is as large as the uncompressed file. Warnings are those of read_las().
std::unique_ptr<PointStream> open_las_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads, const OnWorldPositions& on_positions,
                                             const LasDecompress& decompress = {});

}  // namespace scanmill
