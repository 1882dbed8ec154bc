// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Pieces that are made on several threads and taken one by one, in order: for results that depend on the order, as a
/// hash does, or that only have room for a few pieces at a time.

#include <algorithm>
#include <vector>

#include "scanmill/filter/parallel.hpp"

namespace scanmill {

/// Calls make(piece, room) for 0 … count - 1, on up to `threads` threads, and take(piece, room) in this thread, in
/// order, with what was made. Rooms are used again: four for each thread, with one thread a single one. An exception
/// of either ends it and reaches the caller.
template <class Room, class Make, class Take>
void for_each_in_order(unsigned threads, std::size_t count, Make&& make, Take&& take) {
    constexpr std::size_t rooms_of_a_thread = 4;
    std::vector<Room> rooms(std::min(count, threads > 1 ? threads * rooms_of_a_thread : 1));
    for (std::size_t first = 0; first < count; first += rooms.size()) {
        const std::size_t pieces = std::min(rooms.size(), count - first);
        for_each_chunk(threads, pieces, 1, [&](std::size_t i, std::size_t) { make(first + i, rooms[i]); });
        for (std::size_t i = 0; i < pieces; ++i) take(first + i, rooms[i]);
    }
}

}  // namespace scanmill
