// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a LAS file says of itself before its points: the public header and the variable length records.

#include <bit>
#include <cstring>

#include "scanmill/data/frame.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

struct LasHeader {
    u32 minor_version = 0;
    std::size_t size = 0;  ///< bytes of the header
    std::size_t points_begin = 0;
    u32 records = 0;
    u32 point_format = 0;  ///< without the bits of compression
    bool is_compressed = false;
    std::size_t point_size = 0;
    u64 points = 0;
    Vec3 scale, offset;
    u32 extended_records = 0;  ///< behind the points
    std::string system, software;

    bool has_gps_time() const { return point_format >= 6 || (point_format & 1) != 0 || point_format == 4; }
    bool has_colour() const;
    bool has_nir() const { return point_format == 8 || point_format == 10; }
    bool has_wave_packets() const;
};

/// Bytes that points of a format take at least, without extra bytes.
std::size_t las_point_size(u32 point_format);

/// Throws Error when the file is shorter than its header, the version or the point format is unknown, or sizes, scale
/// or offset make no sense. The points are not looked for: see require_las_points().
LasHeader read_las_header(std::string_view bytes);

/// Throws Error unless there are points, and the file has room for all of them.
void require_las_points(const LasHeader& header, std::string_view bytes);

/// A variable length record: whose, which, and its content.
struct LasRecord {
    std::string user;
    u32 id = 0;
    std::string_view content;
};

/// The records between header and points. When they would run into the points, those that do are left out and told.
std::vector<LasRecord> read_las_records(const LasHeader& header, std::string_view bytes, const ReadOptions& options);

/// Whether the record is the directory of GeoTIFF keys.
bool holds_geo_keys(const LasRecord& record);

/// The unit of x, y and z: the options' when known, else by the GeoTIFF keys among the records metre or foot, else
/// unknown. What is doubtful is told: degrees, other units, another unit for heights.
LengthUnit las_unit(const std::vector<LasRecord>& records, const ReadOptions& options);

}  // namespace scanmill
