// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The parts of a LAS file before its points: the public header and the variable length records.

#include <array>

#include "scanmill/formats/common/reading.hpp"
#include "scanmill/io/output_buffer.hpp"

namespace scanmill {

struct LasHeader {
    u32 minor_version = 0;
    std::size_t size = 0;  ///< bytes of the header
    std::size_t points_begin = 0;
    u32 records = 0;
    u32 point_format = 0;  ///< without the compression bits
    bool is_compressed = false;
    std::size_t point_size = 0;
    u64 points = 0;
    Vec3 scale, offset;
    u32 extended_records = 0;  ///< number of variable length records after the points
    std::string system, software;

    bool has_gps_time() const { return point_format >= 6 || (point_format & 1) != 0 || point_format == 4; }
    bool has_colour() const;
    bool has_nir() const { return point_format == 8 || point_format == 10; }
    bool has_wave_packets() const;
};

/// Throws Error if the file is shorter than its header, if the version or the point format is unknown, or if sizes,
/// scale or offset are invalid. Does not check the points: see require_las_points().
LasHeader read_las_header(std::string_view bytes);

/// Whether the point format in a header says that the points are compressed. `head` may be shorter than a header.
bool is_marked_compressed(std::string_view head);

/// Throws Error if the file has no points or, unless they are compressed, is too short for all its points.
void require_las_points(const LasHeader& header, std::string_view bytes);

/// A variable length record: its owner, its number and its content.
struct LasRecord {
    std::string user;
    u32 id = 0;
    std::string_view content;
};

/// The records between header and points. Leaves out records that overlap the points, with a warning.
std::vector<LasRecord> read_las_records(const LasHeader& header, std::string_view bytes, const ReadOptions& options);

/// Whether the record is the directory of GeoTIFF keys.
bool holds_geo_keys(const LasRecord& record);

/// The unit of x, y and z: the unit in the options if known, else metre or foot if the GeoTIFF keys declare it, else
/// unknown. Warns about degrees, other units, and a different unit for heights.
LengthUnit las_unit(const std::vector<LasRecord>& records, const ReadOptions& options);

/// Extra bytes of a point, as the file describes them.
struct LasExtra {
    std::string name;
    ScalarType type = ScalarType::uint8;
    u32 components = 1;
    std::size_t offset = 0;  ///< bytes from a point's begin to the first component
    bool is_scaled = false;  ///< whether `scale` and `shift`, one for each component, apply
    std::array<double, 3> scale{1, 1, 1};
    std::array<double, 3> shift{0, 0, 0};
};

/// Whether the record is the description of extra bytes.
bool describes_extra_bytes(const LasRecord& record);

/// The described extra bytes, in order. Leaves out extra bytes without a type, without a description or beyond the
/// point's size, with a warning.
std::vector<LasExtra> read_las_extra(const LasHeader& header, const std::vector<LasRecord>& records,
                                     const ReadOptions& options);

}  // namespace scanmill
