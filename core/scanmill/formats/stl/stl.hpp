// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// STL: triangles without connectivity, in single precision.
///
/// Read: binary and ascii, several solids too (then a face column `solid` numbers them from 0). A file is binary when
/// its size is exactly what its triangle count asks for, even if it begins with "solid". Corners of equal bits become
/// one vertex, see corner_merger.hpp. Stored normals are not kept: they repeat what the corners say. Attribute bytes
/// become the face column `attribute` (uint16) when one is not zero. Degenerate facets are kept, and counted in a
/// warning. Written: binary. Facet normals are unit, computed in double from the positions, zero for degenerate
/// triangles. Unit and frame name lie in the 80 bytes of the header, which never begins with "solid". What STL cannot
/// carry is told: columns, sharp edges, unused vertices, more than single precision. Source: StereoLithography
/// Interface Specification, 3D Systems, 1989.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

Recognition recognise_stl(std::string_view head, u64 file_size);
LoadedFile read_stl(const FileBytes& file, const ReadOptions& options);
void write_stl(const Value& value, OutputBuffer& out, const WriteOptions& options);

/// The header that write_stl() makes for a frame, 80 bytes padded with blanks, and what it declares, as comments.
std::string stl_header(const Frame& frame);
std::vector<std::string> stl_header_comments(std::string_view header);

constexpr std::size_t stl_header_size = 80;
constexpr std::size_t stl_facet_size = 50;

}  // namespace scanmill
