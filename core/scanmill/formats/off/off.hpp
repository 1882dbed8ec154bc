// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// OFF, the object file format of Geomview, as text.
///
/// Read: the keyword OFF (it may be missing when the extension is .off) with the prefixes ST, C and N in any
/// combination, the counts on its line or the next, one vertex and one face per line, `#` comments, blank lines.
/// Prefixed vertices give the columns `normal` (float64), colours and `texture` (2, float64); numbers after a plain
/// vertex's coordinates are taken as its colour. Faces are cut into triangles; numbers after a face's indices are its
/// colour. Colours of whole numbers from 0 to 255 become `colour` (3 or 4, uint8), others the columns `red`, `green`,
/// `blue`, `alpha` (float64); a single number per face becomes `colour_index`. Colours that not every row has are left
/// out and told. Comments "unit mm" and "frame NAME" give the frame. The number of edges is not used. 4OFF, nOFF and
/// OFF BINARY are refused. Written: with double precision, the vertices' columns `normal` (3 floats), `colour` (3 or 4
/// × uint8) and `texture` (2 floats) under the prefixes N, C and ST, and the faces' `colour`; other columns, sharp and
/// described edges are told.
/// Source: Geomview manual, section 4.1 (OFF files).

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

Recognition recognise_off(std::string_view head, u64 file_size);
LoadedFile read_off(const FileBytes& file, const ReadOptions& options);
void write_off(const Value& value, OutputBuffer& out, const WriteOptions& options);

}  // namespace scanmill
