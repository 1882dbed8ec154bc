// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mesh while it is decimated: its triangles, the points of the original surface that each one represents, the
/// errors, and a tree of boxes.

#include <span>

#include "decimate/edit.hpp"
#include "decimate/original_surface.hpp"
#include "scanmill/geometry/spatial/box_tree.hpp"

namespace scanmill::decimating {

class Surface {
public:
    /// Keeps references. `data`: points beside the vertices. Call assign() for them before the first edit.
    Surface(const OriginalSurface& original, EditableMesh mesh, std::span<const Vec3> data);

    const OriginalSurface& original;
    const EditableMesh& mesh() const { return mesh_; }
    const Vec3& position(u32 vertex) const { return original.position(vertex); }

    /// Points are numbered: the vertices of the original surface, then the data points.
    const Vec3& point(u32 number) const {
        const std::size_t vertices = original.positions().size();
        return number < vertices ? original.position(number) : data_[number - vertices];
    }
    void assign(u32 number, u32 row) {
        nexts_[number] = heads_[row];
        heads_[row] = number;
    }
    /// Calls action(number) for every point that the triangle represents: removed vertices inside smooth faces, and
    /// data points.
    template <class Action>
    void for_each_point(u32 row, Action&& action) const {
        for (u32 number = heads_[row]; number != EditableMesh::none; number = nexts_[number]) action(number);
    }
    /// Errors at the triangle's points and along the paths at its edges, computed when the triangle was made.
    SignedErrors errors(u32 row) const { return {errors_[row][0], errors_[row][1]}; }

    BoundingBox box_of(u32 row) const { return box_of(mesh_.triangle(row)); }
    BoundingBox box_of(const Triangle& triangle) const;
    const BoxTree& boxes() const { return boxes_; }

    /// The remaining vertices at both ends of the feature edge through a removable vertex. Calls passed(v) for every
    /// removed vertex v on that edge. Pre: the class of `vertex` is crease or boundary.
    template <class Passed>
    std::array<u32, 2> line_ends(u32 vertex, Passed&& passed) const {
        const FeatureNetwork& features = original.features();
        const auto is_left = [&](u32 other) { return mesh_.is_used(other); };
        const auto [one, other] = features.line_neighbours(vertex);
        return {features.follow_line(vertex, one, is_left, passed),
                features.follow_line(vertex, other, is_left, passed)};
    }
    /// Whether the edge of the half-edge represents a part of a feature line.
    bool is_feature(u32 half_edge) const;

    /// Applies the edit and appends the new rows to `new_rows`. `stamp`: marks the changed boxes. Pre: no triangle at
    /// `edit.element` has changed since the planning.
    void apply(const Edit& edit, u32 stamp, std::vector<u32>& new_rows);
    /// Rebuilds the tree of boxes if most triangles are gone.
    void tidy();

private:
    void build_boxes();

    EditableMesh mesh_;
    std::span<const Vec3> data_;
    Array<u32> heads_;  ///< by row: its first point
    Array<u32> nexts_;  ///< by point: the next point of the same row
    Array<std::array<float, 2>> errors_;  ///< by row: outside, inside; rounded up
    BoxTree boxes_;
};

}  // namespace scanmill::decimating
