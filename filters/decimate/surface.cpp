// SPDX-License-Identifier: GPL-3.0-or-later
#include "decimate/surface.hpp"

#include <cmath>

namespace scanmill::decimating {

namespace {

float rounded_up(double value) {
    const float nearest = static_cast<float>(value);
    return static_cast<double>(nearest) >= value ? nearest
                                                 : std::nextafterf(nearest, std::numeric_limits<float>::infinity());
}

}  // namespace

Surface::Surface(const OriginalSurface& original_surface, EditableMesh mesh, std::span<const Vec3> data)
    : original(original_surface),
      mesh_(std::move(mesh)),
      data_(data),
      heads_(mesh_.rows(), EditableMesh::none),
      nexts_(original.positions().size() + data.size(), EditableMesh::none),
      errors_(mesh_.rows(), std::array<float, 2>{0, 0}),
      boxes_({}) {
    build_boxes();
}

BoundingBox Surface::box_of(const Triangle& triangle) const {
    BoundingBox box;
    for (const u32 vertex : triangle) box.add(position(vertex));
    return box;
}

void Surface::build_boxes() {
    Array<BoundingBox> boxes(mesh_.rows(), BoundingBox{});
    for (u32 row = 0; row < mesh_.rows(); ++row)
        if (!mesh_.is_empty(row)) boxes[row] = box_of(row);
    boxes_ = BoxTree(boxes);
}

void Surface::tidy() {
    if (2 * boxes_.size() < boxes_.leaves()) build_boxes();
}

bool Surface::is_feature(u32 half_edge) const {
    if (mesh_.is_boundary(half_edge)) return true;
    const u32 a = mesh_.start(half_edge), b = mesh_.end(half_edge);
    const FeatureNetwork& features = original.features();
    if (features.vertex_class(a) == VertexClass::smooth || features.vertex_class(b) == VertexClass::smooth)
        return false;
    const auto is_left = [&](u32 vertex) { return mesh_.is_used(vertex); };
    bool found = false;
    features.for_each_line(
        a, [&](u32, u32 next) { found = found || features.follow_line(a, next, is_left, [](u32) {}) == b; });
    return found;
}

void Surface::apply(const Edit& edit, u32 stamp, std::vector<u32>& new_rows) {
    for (const u32 row : edit.old_rows) heads_[row] = EditableMesh::none;
    const std::size_t first = new_rows.size();
    if (edit.is_flip) {
        mesh_.flip(edit.element);
        new_rows.insert(new_rows.end(), edit.old_rows.begin(), edit.old_rows.end());
    } else {
        mesh_.remove(edit.element, edit.ring_triangles, new_rows);
    }
    const std::span<const u32> rows = std::span(new_rows).subspan(first);
    for (std::size_t i = 0; i < edit.points.size(); ++i) assign(edit.points[i], rows[edit.owners[i]]);
    for (std::size_t i = 0; i < rows.size(); ++i) {
        errors_[rows[i]] = {rounded_up(edit.errors[i].outside), rounded_up(edit.errors[i].inside)};
        boxes_.change(rows[i], box_of(rows[i]), stamp);
    }
    for (const u32 row : edit.old_rows)
        if (mesh_.is_empty(row)) boxes_.change(row, {}, stamp);
}

}  // namespace scanmill::decimating
