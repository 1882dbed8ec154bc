// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parallel loops within a thread budget, cut into chunks whose borders do not depend on the number of threads.
///
/// Work that merges per-chunk results in chunk order gives the same bytes for any budget. With a budget of 1 everything
/// runs in the calling thread. Exceptions of the body reach the caller.

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace scanmill {

/// Calls body(begin, end) for [0, chunk), [chunk, 2 chunk) … up to `count`, in any order and on up to `threads`
/// threads.
void for_each_chunk(unsigned threads, std::size_t count, std::size_t chunk,
                    const std::function<void(std::size_t begin, std::size_t end)>& body);

/// Runs `body` where oneTBB sees `threads` threads (never more than the machine has): for libraries that parallelise
/// themselves.
void within_thread_budget(unsigned threads, const std::function<void()>& body);

// Pieces that are made on several threads and taken one by one, in order: for results that depend on the order, as a
// hash does, or that only have room for a few pieces at a time.

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
