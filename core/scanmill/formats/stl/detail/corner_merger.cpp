// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/stl/detail/corner_merger.hpp"

#include <bit>
#include <cstring>

#include "scanmill/formats/common/reading.hpp"

namespace scanmill {

namespace {

constexpr u32 empty = ~u32(0);

u64 hash_of(const Vec3& p) {
    // Floats widened to double leave the low bits zero: multiply and fold the high half down, coordinate by coordinate.
    u64 hash = 0;
    for (int axis = 0; axis < 3; ++axis) {
        hash = (hash ^ std::bit_cast<u64>(p[axis])) * 0x9E3779B97F4A7C15u;
        hash ^= hash >> 32;
    }
    return hash * 0xD6E8FEB86659FD93u;
}

bool same_bits(const Vec3& a, const Vec3& b) { return std::memcmp(a.data(), b.data(), sizeof(Vec3)) == 0; }

}  // namespace

CornerMerger::CornerMerger(std::size_t corners) {
    // A closed triangulation has about six corners per vertex.
    constexpr std::size_t corners_per_vertex = 6;
    const std::size_t guess = corners / corners_per_vertex + 16;
    positions_.reserve(guess);
    slots_.assign(std::bit_ceil(2 * guess), Slot{empty, 0});
    mask_ = slots_.size() - 1;
}

u32 CornerMerger::add(const Vec3& corner) {
    const Vec3 p = corner.array() + 0.0;  // -0 + 0 is +0, every other number stays
    const u64 hash = hash_of(p);
    const u32 mark = static_cast<u32>(hash);
    std::size_t at = (hash >> 32) & mask_;
    for (; slots_[at].vertex != empty; at = (at + 1) & mask_)
        if (slots_[at].mark == mark && same_bits(positions_[slots_[at].vertex], p)) return slots_[at].vertex;
    const u32 vertex = static_cast<u32>(positions_.size());
    slots_[at] = {vertex, mark};
    positions_.push_back(p);
    if (2 * positions_.size() > slots_.size()) grow();
    return vertex;
}

void CornerMerger::grow() {
    require_countable(2 * positions_.size(), "vertices");
    slots_.assign(2 * slots_.size(), Slot{empty, 0});
    mask_ = slots_.size() - 1;
    for (u32 vertex = 0; vertex < positions_.size(); ++vertex) {
        const u64 hash = hash_of(positions_[vertex]);
        std::size_t at = (hash >> 32) & mask_;
        while (slots_[at].vertex != empty) at = (at + 1) & mask_;
        slots_[at] = {vertex, static_cast<u32>(hash)};
    }
}

}  // namespace scanmill
