// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Gives equal positions one number: how a soup of triangles becomes an indexed mesh.
///
/// Equal means equal bits after -0 has become +0; nothing is merged by nearness. Vertices are numbered by first
/// appearance. Cost: one hash-table look-up per corner (open addressing, half empty), about 40 bytes per vertex.

#include "scanmill/data/points.hpp"

namespace scanmill {

class CornerMerger {
public:
    /// `corners` is how many will come; a guess only costs time.
    explicit CornerMerger(std::size_t corners);

    /// The number of the vertex at p.
    u32 add(const Vec3& p);

    std::size_t size() const { return positions_.size(); }
    Array<Vec3> take_positions() { return std::move(positions_); }

private:
    struct Slot {
        u32 vertex;
        u32 mark;  // the other half of the hash: most misses are settled without a look at the position
    };
    void grow();

    Array<Vec3> positions_;
    Array<Slot> slots_;
    std::size_t mask_ = 0;
};

}  // namespace scanmill
