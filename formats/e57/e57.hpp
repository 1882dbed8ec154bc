// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// E57 (ASTM E2807), the exchange format of terrestrial scanners, read by libE57Format. A file contains scans; each is
/// a view with a pose.
///
/// Positions: cartesianX, Y, Z; without them, the spherical coordinates r, azimuth a, elevation e are converted to
/// (r cos e cos a, r cos e sin a, r sin e). The scan's pose maps a point p to R(q) p + t, into the file's common frame.
/// An identity pose changes no bit. The unit is the metre. Points whose cartesianInvalidState or sphericalInvalidState
/// is not 0 are left out and counted.
///
/// Columns: `intensity` (as stored, with scale and offset; the declared limits are comments), `colour` (3 × uint8) if
/// the colour limits allow bytes, `colour16` (3 × uint16) for larger integers, and bytes scaled from the limits for
/// other numbers. `normal` from the extension nor:normalX, Y, Z, turned by the pose. Every other field keeps its name
/// in lower case: `row_index`, `column_index`, `time_stamp`, `return_index`, `return_count`, … Flags
/// (`intensity_invalid`, `colour_invalid`, `time_stamp_invalid`) are kept if a point has them set; the values that they
/// belong to are kept as stored. Integers have the smallest type that holds their declared range, scaled integers are
/// float64, floats keep their precision. `approach` (3 × float32) is the unit vector to the scanner, at the scan's own
/// origin; it is present if the scan has rows and columns or spherical coordinates, because other scans may be merged
/// from several stations.
///
/// Several scans become one cloud, in the order of the file, with a column `scan` (uint32, from 0). Columns that not
/// every scan has are left out, with a warning. ReadOptions::view chooses one scan.
///
/// Throws Error for what checked_contents() refuses; a wrong checksum; a file without scans; no points, or fewer than
/// promised; more points than the file's bits can hold; a quaternion whose length is more than 0.1 % off 1; a scan
/// without coordinates; coordinates that are text. Images are left out, with a warning.
///
/// Memory: the columns, and one block of 65,536 points. Only one thread at a time parses XML, because xerces-c starts
/// and ends with each file.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::e57_format {

LoadedFile read_e57(const FileBytes& file, const ReadOptions& options);

/// The number of scans. Does not call libE57Format, so a damaged file cannot harm the caller. Throws Error as
/// checked_contents() does.
u32 count_scans(std::string_view bytes);

}  // namespace scanmill::e57_format
