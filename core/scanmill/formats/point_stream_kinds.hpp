// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The kinds of file that open_point_stream() knows. Each gives nothing when the file is not one of those that it
/// reads, and may throw Error for one that nobody can read.

#include "scanmill/formats/mapped_file.hpp"
#include "scanmill/formats/point_stream.hpp"

namespace scanmill {

bool may_be_ply_stream(std::string_view file);
bool may_be_text_stream(std::string_view file);
std::unique_ptr<PointStream> open_ply_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads, const OnWorldPositions& on_positions);
std::unique_ptr<PointStream> open_text_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                              unsigned threads, const OnWorldPositions& on_positions);

struct PointStreamKind {
    std::string_view format;  ///< Format::name
    decltype(&may_be_ply_stream) may_be;
    decltype(&open_ply_stream) open;
};

}  // namespace scanmill
