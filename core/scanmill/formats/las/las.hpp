// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// LAS, the exchange format of airborne and terrestrial lidar: versions 1.0 to 1.4, point formats 0 to 10.
///
/// Positions are the stored integers times the file's scale plus its offset. The sum is formed near frame.origin, so
/// that also steps too small for a double of the full coordinate are kept. Columns: `intensity` (uint16),
/// `return_number`, `number_of_returns`, `classification`, `user_data` (uint8), `scan_angle` (float32, degrees),
/// `point_source_id` (uint16), and where the point format has them `gps_time` (float64), `nir` (uint16) and colours:
/// `colour` (3, uint8) when all are bytes, stored as they are or times 256 or 257, which is told; else `colour16` (3,
/// uint16), told, too. Flags (`synthetic`, `key_point`, `withheld`, `overlap`, `scan_direction`, `edge_of_flight_line`)
/// and `scanner_channel` are columns (uint8) when any point has one set. Described extra bytes are columns of their own
/// names and types, float64 when they have a scale or an offset; the unit is metre or foot when the GeoTIFF keys say
/// so.
///
/// Left out and told: variable length records, wave packets, undescribed extra bytes, bytes behind the last point. LAZ,
/// the compressed form, COPC included, is recognised and refused, with what to convert it by.

#include "scanmill/formats/common/format.hpp"

namespace scanmill {

Recognition recognise_las(std::string_view head, u64 file_size);
LoadedFile read_las(const FileBytes& file, const ReadOptions& options);

}  // namespace scanmill
