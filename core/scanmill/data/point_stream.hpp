// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A point file that is read piece by piece, as often as needed. For code that visits every point and keeps few; the
/// scan is never in memory as a whole.
///
/// Frame, positions and columns equal those of read_points(), bit for bit. open_point_stream() decides which files can
/// be streamed: binary PLY, texts of three columns, LAS and LAZ.

#include <functional>
#include <memory>
#include <span>

#include "scanmill/data/points.hpp"
#include "scanmill/data/robust_box.hpp"

namespace scanmill {

/// Called with the positions of a piece as in the file: frame().origin is not subtracted.
using OnWorldPositions = std::function<void(std::span<const Vec3>)>;

class PointStream {
public:
    virtual ~PointStream();
    PointStream(const PointStream&) = delete;
    PointStream& operator=(const PointStream&) = delete;

    const Frame& frame() const { return frame_; }
    /// The box of all points, relative to frame().origin.
    const BoundingBox& bounds() const { return box_.all; }
    /// The box of all points and the box without stray points, relative to frame().origin. Equals robust_box() of the
    /// positions.
    const RobustBox& robust_box() const { return box_; }
    /// The index of the first point of every piece; at the end, the number of points. A piece has at most 2^16 points
    /// and may be empty.
    const std::vector<std::size_t>& pieces() const { return pieces_; }
    std::size_t size() const { return pieces_.back(); }

    /// Reads the positions of a piece. Callable from several threads. Throws Error if the file has visibly changed
    /// since it was opened: another number of rows, or coordinates outside bounds().
    void read(std::size_t piece, Array<Vec3>& positions) const;
    /// All columns of a piece, without the positions. Callable from several threads. Cost: one pass over the piece.
    virtual ColumnTable read_columns(std::size_t piece) const = 0;
    /// The points at `rows` with all their columns. Pre: `rows` ascend. Throws Error under the conditions of read().
    PointCloud gather(std::span<const u32> rows, unsigned threads) const;

    /// Replaces the frame name of the file.
    void rename_frame(std::string name) { frame_.name = std::move(name); }

protected:
    PointStream() = default;
    /// Throws the Error for a file that has changed.
    [[noreturn]] static void throw_changed();
    /// Reads the world positions of a piece and returns their bounds. Reads a different number of positions if the file
    /// has changed.
    virtual FiniteBounds read_world(std::size_t piece, Array<Vec3>& positions) const = 0;
    virtual PointCloud gather_world(std::span<const u32> rows, unsigned threads) const = 0;
    /// The same relative to frame().origin, with the bounds of the world positions. The default subtracts the origin.
    /// Formats that store positions more finely than a double of the full coordinate override both.
    virtual FiniteBounds read_near(std::size_t piece, Array<Vec3>& positions) const;
    virtual PointCloud gather_near(std::span<const u32> rows, unsigned threads, FiniteBounds& world) const;
    /// Sets the frame's origin as readers do, and the boxes relative to it. Pre: world_ bounds all pieces.
    void choose_origin();

    Frame frame_;
    FiniteBounds world_;  ///< bounds of the pieces read so far, in the file's coordinates
    RobustBox box_;
    std::vector<std::size_t> pieces_;
};

}  // namespace scanmill
