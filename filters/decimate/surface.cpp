// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/surface.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace scanmill::decimating {

namespace {

float rounded_up(double value) {
    const float nearest = static_cast<float>(value);
    return static_cast<double>(nearest) >= value ? nearest
                                                 : std::nextafterf(nearest, std::numeric_limits<float>::infinity());
}

}  // namespace

Surface::Surface(const OriginalSurface& original_, EditableMesh mesh_, std::span<const Vec3> positions,
                 std::span<const Vec3> extra)
    : original(original_),
      mesh(std::move(mesh_)),
      positions_(positions),
      extra_(extra),
      heads_(mesh.rows(), EditableMesh::none),
      nexts_(positions.size() + extra.size(), EditableMesh::none),
      errors_(mesh.rows(), std::array<float, 2>{0, 0}),
      boxes_({}) {
    build_boxes();
}

BoundingBox Surface::box_of(u32 row) const {
    BoundingBox box;
    for (const u32 vertex : mesh.triangle(row)) box.add(positions_[vertex]);
    return box;
}

void Surface::build_boxes() {
    Array<BoundingBox> boxes(mesh.rows(), BoundingBox{});
    for (u32 row = 0; row < mesh.rows(); ++row)
        if (!mesh.is_empty(row)) boxes[row] = box_of(row);
    boxes_ = BoxTree(boxes);
}

void Surface::tidy() {
    if (2 * boxes_.size() < boxes_.leaves()) build_boxes();
}

void Surface::apply(const Removal& removal, u32 stamp) {
    star_.clear();
    mesh.for_each_around(removal.vertex, [&](u32 half_edge) { star_.push_back(half_edge / 3); });
    for (const u32 row : star_) heads_[row] = EditableMesh::none;
    rows_.clear();
    mesh.remove(removal.vertex, removal.triangles, rows_);
    for (std::size_t i = 0; i < removal.points.size(); ++i) assign(removal.points[i], rows_[removal.owners[i]]);
    for (std::size_t i = 0; i < rows_.size(); ++i) {
        errors_[rows_[i]] = {rounded_up(removal.errors[i].outside), rounded_up(removal.errors[i].inside)};
        boxes_.change(rows_[i], box_of(rows_[i]), stamp);
    }
    for (const u32 row : star_)
        if (mesh.is_empty(row)) boxes_.change(row, {}, stamp);
}

void Surface::apply_flip(u32 half_edge, const Removal& flip, u32 stamp) {
    const u32 rows[2] = {half_edge / 3, mesh.opposite(half_edge) / 3};
    for (const u32 row : rows) heads_[row] = EditableMesh::none;
    mesh.flip(half_edge);
    for (std::size_t i = 0; i < flip.points.size(); ++i) assign(flip.points[i], rows[flip.owners[i]]);
    for (int i = 0; i < 2; ++i) {
        errors_[rows[i]] = {rounded_up(flip.errors[i].outside), rounded_up(flip.errors[i].inside)};
        boxes_.change(rows[i], box_of(rows[i]), stamp);
    }
}

}  // namespace scanmill::decimating
