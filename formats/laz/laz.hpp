// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// LAZ, LAS whose points are compressed by LASzip, and COPC, LAZ with an octree, read as its whole content.
///
/// LASzip's own decoders restore the records of the points, for point formats 0 to 10 and the methods 1 (one run of
/// points), 2 (chunks of points) and 3 (chunks of layers). The LAS reader maps the records to columns, see
/// las_format(). The octree of COPC is ignored.
///
/// Errors: a missing, unknown or contradictory record of LASzip; a missing, truncated or damaged table of chunks; a
/// damaged chunk; fewer points than the header declares. A chunk is damaged if its decoder needs more or fewer bytes
/// than the table of chunks gives it. The points must not end before the last chunk; further points in it are ignored.
///
/// Streams, see open_las_stream(): the points are restored once, on all threads. Files of method 1 have one run of
/// points, which one thread restores.
/// Cost: that of LASzip. Memory while restoring, beside the result: a stream has at most 4 chunks per thread, of at
/// most 8 MB each.

#include "scanmill/formats/las/las_file.hpp"

namespace scanmill::laz {

LoadedFile read_laz(const FileBytes& file, const ReadOptions& options);
bool may_stream_laz(std::string_view file);
std::unique_ptr<PointStream> open_laz_stream(std::unique_ptr<MappedFile> file, const ReadOptions& options,
                                             unsigned threads, const OnWorldPositions& on_positions);

}  // namespace scanmill::laz
