// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/spatial/spatial_order.hpp"

#include <cassert>

#include "scanmill/data/points.hpp"

namespace scanmill {

namespace {

struct Entry {
    u64 code;
    u32 row;
};

/// Inserts two zero bits above each of 21 bits.
u64 spread(u64 bits) {
    bits = (bits | bits << 32) & 0x1f00000000ffff;
    bits = (bits | bits << 16) & 0x1f0000ff0000ff;
    bits = (bits | bits << 8) & 0x100f00f00f00f00f;
    bits = (bits | bits << 4) & 0x10c30c30c30c30c3;
    return (bits | bits << 2) & 0x1249249249249249;
}

/// Stable sort by the 16 bits from `shift` on.
void sort_by_digit(const Array<Entry>& from, Array<Entry>& to, int shift) {
    std::vector<std::size_t> next(std::size_t(1) << 16, 0);
    for (const Entry& entry : from) ++next[entry.code >> shift & 0xffff];
    std::size_t sum = 0;
    for (std::size_t& count : next) sum += std::exchange(count, sum);
    for (const Entry& entry : from) to[next[entry.code >> shift & 0xffff]++] = entry;
}

}  // namespace

Array<u32> spatial_order(std::span<const Vec3> positions) {
    assert(positions.size() <= ~u32(0));
    constexpr double steps = (1 << 21) - 1;
    const BoundingBox box = bounding_box(positions);
    const double extent = positions.empty() ? 0 : (box.high - box.low).maxCoeff();
    Array<Entry> entries(positions.size()), other(positions.size());
    for (std::size_t row = 0; row < positions.size(); ++row) {
        u64 code = 0;
        for (int axis = 0; axis < 3 && extent > 0; ++axis) {
            const double share = (positions[row][axis] - box.low[axis]) / extent;
            code |= spread(static_cast<u64>(share * steps)) << axis;
        }
        entries[row] = {code, static_cast<u32>(row)};
    }
    for (int shift = 0; shift < 64; shift += 16) {
        sort_by_digit(entries, other, shift);
        entries.swap(other);
    }
    Array<u32> rows(entries.size());
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i] = entries[i].row;
    return rows;
}

}  // namespace scanmill
