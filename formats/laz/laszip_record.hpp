// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The variable length record in which LASzip describes how the points of a file are compressed.

#include <memory>

#include "laszip.hpp"
#include "scanmill/formats/las/las_file.hpp"

namespace scanmill::laz {

/// Reads the record. Its items are those of the file's point format and size, in versions that LASzip's decoders know;
/// only then may these decoders be made. Throws Error if the record is missing, if it describes an unknown or newer
/// compression, or if it contradicts the header.
std::unique_ptr<LASzip> read_laszip_record(const LasParts& parts);

/// Whether all points are one run, without a table of chunks.
inline bool is_one_run(const LASzip& laszip) { return laszip.compressor == LASZIP_COMPRESSOR_POINTWISE; }
inline bool has_layers(const LASzip& laszip) { return laszip.compressor == LASZIP_COMPRESSOR_LAYERED_CHUNKED; }
/// Whether chunks have different numbers of points, which the table of chunks contains.
inline bool has_chunk_counts(const LASzip& laszip) { return laszip.chunk_size == U32_MAX; }

/// "LASzip 2.2".
std::string version_of(const LASzip& laszip);

}  // namespace scanmill::laz
