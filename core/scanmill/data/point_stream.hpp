// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A point file that is read piece by piece, as often as needed, for what looks at every point and keeps few: the scan
/// never is in memory as a whole.
///
/// What comes out is, bit for bit, what read_points() gives: the same frame, the same positions relative to it, the
/// same columns. Binary PLY and texts of three columns can be read so; open_point_stream() says which.

#include <functional>
#include <memory>
#include <span>

#include "scanmill/data/bounds.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

/// Told the positions of a piece as the file has them: frame().origin is not subtracted.
using OnWorldPositions = std::function<void(std::span<const Vec3>)>;

class PointStream {
public:
    virtual ~PointStream();
    PointStream(const PointStream&) = delete;
    PointStream& operator=(const PointStream&) = delete;

    const Frame& frame() const { return frame_; }
    /// Of all points, relative to frame().origin.
    const BoundingBox& bounds() const { return bounds_; }
    /// Where the pieces begin, and one more: the number of points. A piece may be empty, and has at most 2^16 points.
    const std::vector<std::size_t>& pieces() const { return pieces_; }
    std::size_t size() const { return pieces_.back(); }

    /// The positions of a piece, in `room`. From several threads at once, each with room of its own. Throws Error when
    /// the file no longer holds what it held when it was opened, as far as that shows: other rows, or coordinates
    /// outside bounds().
    void read(std::size_t piece, Array<Vec3>& room) const;
    /// All columns of a piece, without the positions. Several threads may call it at once. Cost: one pass over the
    /// piece.
    virtual ColumnTable read_columns(std::size_t piece) const = 0;
    /// These points with all their columns. Pre: `rows` ascending. Throws Error as read().
    PointCloud gather(std::span<const u32> rows, unsigned threads) const;

    /// Calls the frame otherwise than the file does.
    void rename_frame(std::string name) { frame_.name = std::move(name); }

protected:
    PointStream() = default;
    /// Throws the Error of a file that changed.
    [[noreturn]] static void throw_changed();
    /// World positions of a piece, `room` sized to fit what the file has now, and their bounds.
    virtual FiniteBounds read_world(std::size_t piece, Array<Vec3>& room) const = 0;
    virtual PointCloud gather_world(std::span<const u32> rows, unsigned threads) const = 0;
    /// Sets the frame's origin to what readers choose, and the bounds relative to it. Pre: world_ bounds all pieces.
    void choose_origin();

    Frame frame_;
    FiniteBounds world_;  ///< of the pieces that were looked over, as the file has them
    BoundingBox bounds_;
    std::vector<std::size_t> pieces_;
};

}  // namespace scanmill
