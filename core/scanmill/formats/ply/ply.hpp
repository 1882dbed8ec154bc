// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// PLY, the Stanford polygon format: what is kept of it, and how values are written.
///
/// Read: ascii and both binary byte orders, any elements and properties. `vertex` with x, y, z (of any type, kept as
/// double) and columns (see ply_table.hpp); `face` with a list vertex_indices or vertex_index, cut into triangles;
/// `tristrips`; `edge` with vertex1, vertex2 and columns; `sharp_edge` with vertex1, vertex2, our own. Any other
/// element is passed over and told. Numbers in text keep all their digits, whatever type the header gives coordinates.
/// Comments "unit mm" and "frame NAME" give the frame.
/// Written: binary little-endian; coordinates as float when every one is exactly a float, else double. 64-bit integers
/// become double (PLY has none). Everything else comes back as it was.
/// Source: G. Turk, The PLY polygon file format, 1994.

#include <memory>

#include "scanmill/data/point_stream.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/io/mapped_file.hpp"

namespace scanmill {

Recognition recognise_ply(std::string_view head, u64 file_size);
LoadedFile read_ply(const FileBytes& file, const ReadOptions& options);
void write_ply_points(const Value& value, OutputBuffer& out, const WriteOptions& options);
void write_ply_mesh(const Value& value, OutputBuffer& out, const WriteOptions& options);

/// Whether open_ply_stream() may open the file; bytes further back may still prevent it.
bool may_be_ply_stream(std::string_view file);
/// Null for a file that cannot be streamed. May throw Error for one that no reader accepts.
std::unique_ptr<PointStream> open_ply_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads, const OnWorldPositions& on_positions);

}  // namespace scanmill
