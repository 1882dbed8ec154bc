// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kinds of file that open_point_stream() knows. Each gives nothing when the file is not one of those that it
/// reads.

#include "scanmill/formats/mapped_file.hpp"
#include "scanmill/formats/point_stream.hpp"

namespace scanmill {

std::unique_ptr<PointStream> open_ply_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads);
std::unique_ptr<PointStream> open_text_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                              unsigned threads);

/// The bounds of one piece, and whether it is finite.
struct PieceBounds {
    BoundingBox box;
    bool finite = true;

    explicit PieceBounds(std::span<const Vec3> positions);
};

/// Pieces that a thread does in a row, with the same room.
inline constexpr std::size_t pieces_at_once = 8;

}  // namespace scanmill
