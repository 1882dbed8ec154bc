// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the cache calls the value in a scan file, learned piece by piece: the value itself never is in memory.

#include <functional>

#include "scanmill/cache/value_file.hpp"
#include "scanmill/data/point_stream.hpp"

namespace scanmill {

class StreamedContent {
public:
    /// To be told all positions while the stream is opened: most scans lie near zero, and these are theirs.
    void add_world(std::span<const Vec3> positions) { positions_.add(std::as_bytes(positions)); }
    /// The name that EncodedValue gives to the point cloud of the file. Pre: add_world() was told all of this stream,
    /// and this is called once. Cost: one more pass over the file for each column, and one for the positions of a scan
    /// that is far from zero, for the arrays are hashed as they lie in a value file, one behind the other; up to four
    /// pieces for each thread are in memory.
    /// `on_piece` is called for every piece, from this thread, and may throw what is to end it.
    ValueName of(const PointStream& stream, unsigned threads, const std::function<void()>& on_piece = {});

private:
    ArraysHash positions_;
};

}  // namespace scanmill
