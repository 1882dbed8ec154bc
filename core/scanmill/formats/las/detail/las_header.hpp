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
    u32 extended_records = 0;  ///< after the points
    std::string system, software;

    bool has_gps_time() const { return point_format >= 6 || (point_format & 1) != 0 || point_format == 4; }
    bool has_colour() const;
    bool has_nir() const { return point_format == 8 || point_format == 10; }
    bool has_wave_packets() const;
};

/// Throws Error when the file is shorter than its header, the version or the point format is unknown, or sizes, scale
/// or offset are invalid. Does not check the points: see require_las_points().
LasHeader read_las_header(std::string_view bytes);

/// Throws Error unless there are points, and the file has room for all of them.
void require_las_points(const LasHeader& header, std::string_view bytes);

/// A variable length record: its owner, its number and its content.
struct LasRecord {
    std::string user;
    u32 id = 0;
    std::string_view content;
};

/// The records between header and points. Warns of records that run into the points and leaves them out.
std::vector<LasRecord> read_las_records(const LasHeader& header, std::string_view bytes, const ReadOptions& options);

/// Whether the record is the directory of GeoTIFF keys.
bool holds_geo_keys(const LasRecord& record);

/// The unit of x, y and z: the options' when known, else metre or foot by the GeoTIFF keys, else unknown. Warns of
/// degrees, other units, and a different unit for heights.
LengthUnit las_unit(const std::vector<LasRecord>& records, const ReadOptions& options);

/// Extra bytes of a point, as the file describes them.
struct LasExtra {
    std::string name;
    ScalarType type = ScalarType::uint8;
    u32 components = 1;
    std::size_t offset = 0;  ///< of the first component in a point
    bool is_scaled = false;  ///< by the two below, one for each component
    std::array<double, 3> scale{1, 1, 1};
    std::array<double, 3> shift{0, 0, 0};
};

/// Whether the record is the description of extra bytes.
bool describes_extra_bytes(const LasRecord& record);

/// The described extra bytes, in order. Warns of extra bytes without a type, without a description or beyond the
/// point's size, and leaves them out.
std::vector<LasExtra> read_las_extra(const LasHeader& header, const std::vector<LasRecord>& records,
                                     const ReadOptions& options);

}  // namespace scanmill
