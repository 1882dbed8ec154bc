// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/point_stream.hpp"

#include "scanmill/base/error.hpp"

namespace scanmill {

PointStream::~PointStream() = default;

void PointStream::read(std::size_t piece, Array<Vec3>& positions) const {
    const FiniteBounds world = read_near(piece, positions);
    if (positions.size() != pieces_[piece + 1] - pieces_[piece] || !world.are_within(world_.box)) throw_changed();
}

FiniteBounds PointStream::read_near(std::size_t piece, Array<Vec3>& positions) const {
    const FiniteBounds world = read_world(piece, positions);
    if (frame_.origin != Vec3::Zero())
        for (Vec3& p : positions) p -= frame_.origin;
    return world;
}

PointCloud PointStream::gather(std::span<const u32> rows, unsigned threads) const {
    FiniteBounds world;
    PointCloud cloud = gather_near(rows, threads, world);
    if (!world.are_within(world_.box)) throw_changed();
    cloud.frame = frame_;
    return cloud;
}

PointCloud PointStream::gather_near(std::span<const u32> rows, unsigned threads, FiniteBounds& world) const {
    PointCloud cloud = gather_world(rows, threads);
    world = finite_bounds(cloud.positions.span());
    if (frame_.origin != Vec3::Zero()) cloud.positions = translated(cloud.positions, -frame_.origin);
    return cloud;
}

void PointStream::throw_changed() { throw Error("the scan's file changed while it was read").hint("run it again"); }

void PointStream::choose_origin() {
    const auto read = [this](std::size_t piece, Array<Vec3>& buffer) -> std::span<const Vec3> {
        this->read(piece, buffer);
        return buffer;
    };
    frame_.origin = Vec3::Zero();
    box_ = scanmill::robust_box({pieces_, read}, world_.box);
    frame_.origin = distant_origin(box_);
    if (frame_.origin == Vec3::Zero()) return;
    const BoundingBox moved{world_.box.low - frame_.origin, world_.box.high - frame_.origin};
    box_ = scanmill::robust_box({pieces_, read}, moved);
}

}  // namespace scanmill
