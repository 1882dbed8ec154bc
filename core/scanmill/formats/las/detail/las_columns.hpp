// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mapping from the records of LAS points to positions and columns, see las_format(). Both the whole reader and the
/// stream use it.

#include <functional>

#include "scanmill/data/bounds.hpp"
#include "scanmill/formats/las/las_header.hpp"

namespace scanmill {

using LasGrid = Eigen::Matrix<std::int32_t, 3, 1>;

/// The stored integers of a point's position.
inline LasGrid las_grid_point(const char* record) {
    return {little_endian<std::int32_t>(record), little_endian<std::int32_t>(record + 4),
            little_endian<std::int32_t>(record + 8)};
}

/// What only the points of a file tell about its columns. The order of adding does not matter.
struct LasFacts {
    /// The bounds of the stored integers. Pre of box(): a point was added.
    LasGrid low = LasGrid::Constant(std::numeric_limits<std::int32_t>::max());
    LasGrid high = LasGrid::Constant(std::numeric_limits<std::int32_t>::min());
    std::array<u8, 2> flag_bits{};  ///< bits of bytes 14 and 15 that any point has
    u32 colour_bits = 0;  ///< bits that any of the colours has
    bool colours_are_multiples = true;  ///< whether all colours are bytes times 257

    void add(const LasHeader& header, std::string_view records);
    /// Adds only to `low` and `high`.
    void add_bounds(const LasHeader& header, std::string_view records);
    void add(const LasFacts& more);
    /// The box of all positions relative to `origin`, exactly as las_positions() computes them.
    BoundingBox box(const LasHeader& header, const Vec3& origin) const;
};

/// Positions relative to `origin`. The origin is subtracted from the offset before the integers are added, because near
/// zero a double resolves the smallest step.
void las_positions(const LasHeader& header, const Vec3& origin, std::string_view records, std::span<Vec3> positions);

/// A column of the points: how many numbers of which type, and how they are decoded.
struct LasColumn {
    std::string name;
    ScalarType type;
    u32 components;
    /// Decodes `count` records of `stride` bytes into count × components numbers. `out` is aligned for the type.
    std::function<void(const char* records, std::size_t stride, std::size_t count, std::byte* out)> decode;
};

/// The columns of a file, in order. Warns about wave packets, colours and names.
std::vector<LasColumn> las_columns(const LasHeader& header, const std::vector<LasExtra>& extras, const LasFacts& facts,
                                   const ReadOptions& options);

/// The columns of some rows while they are decoded.
class LasTable {
public:
    LasTable(const std::vector<LasColumn>& columns, std::size_t rows);
    /// Decodes records of `stride` bytes into the rows from `first_row` on. Different rows may be decoded in parallel.
    void decode(std::size_t first_row, std::string_view records, std::size_t stride);
    ColumnTable finish();

private:
    const std::vector<LasColumn>& columns_;
    std::vector<Array<std::byte>> numbers_;
};

}  // namespace scanmill
