// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Opens scan files as point streams.

#include <memory>

#include "scanmill/data/point_stream.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

/// Looks over the whole file once, on up to `threads` threads, so that bounds and origin are known. `on_positions`,
/// when there is one, is told every piece meanwhile, in order and from this thread; also of a file that then gives
/// nothing.
///
/// Nothing when the file cannot be read so, or not at all, or when there is something to be said of it: the caller then
/// reads it whole, and read_points() says it. Read so are: PLY, binary, whose first element is `vertex` without lists
/// and whose other elements are empty, with nothing but ends of lines behind; XYZ and CSV text of three columns in
/// lines that end with LF. All coordinates must be finite. What declared units and frames give cause to say goes to
/// options.on_warning. The file must not change as long as the stream is there; read() tells when it shows that it did.
/// Cost: binary, as fast as the file is read; text, its numbers are parsed. Memory: the positions of four pieces for
/// each thread, at most 1.5 MB each, 8 bytes per piece (24 more in texts), and the bytes of one piece for each thread:
/// pages of the file are given back piece by piece.
std::unique_ptr<PointStream> open_point_stream(const std::filesystem::path& path, const ReadOptions& options,
                                               unsigned threads, const OnWorldPositions& on_positions = {});

/// Whether the file begins like one that open_point_stream() reads; what stands further back may still forbid it.
/// Looks at its first bytes, and its last.
bool may_be_point_stream(const std::filesystem::path& path);

}  // namespace scanmill
