// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mesh while it is decimated: its triangles, and the points of the original surface that each of them stands for.

#include <span>
#include <vector>

#include "decimate/original_surface.hpp"
#include "scanmill/geometry/mesh/editable_mesh.hpp"
#include "scanmill/geometry/spatial/box_tree.hpp"

namespace scanmill::decimating {

/// What a removal may do.
struct Limits {
    SignedErrors error;
    /// Of the angle between a new triangle's normal and the mean normal of those it replaces.
    double normal_cosine = 0.5;
    /// Sine of the least angle of a new triangle.
    double angle_sine = 0;
    u32 max_valence = 25;
    bool accumulated = false;
};

/// A vertex's removal, as planned.
struct Removal {
    u32 vertex = EditableMesh::none;
    bool is_possible = false;
    std::vector<EditableMesh::RingTriangle> triangles;
    std::vector<SignedErrors> errors;  ///< by triangle
    std::vector<u32> points;  ///< of the star's triangles, and the vertex itself if it is smooth
    std::vector<u32> owners;  ///< by point: the triangle it is assigned to
};

class Surface {
public:
    /// `extra`: data points with the triangle of the mesh each is assigned to. Keeps references.
    Surface(const OriginalSurface& original, EditableMesh mesh, std::span<const Vec3> positions,
            std::span<const Vec3> extra);

    const OriginalSurface& original;
    EditableMesh mesh;

    /// Points are numbered: the vertices, then the extra points.
    const Vec3& point(u32 number) const {
        return number < positions_.size() ? positions_[number] : extra_[number - positions_.size()];
    }
    template <class Action>
    void for_each_point(u32 row, Action&& action) const {
        for (u32 number = heads_[row]; number != EditableMesh::none; number = nexts_[number]) action(number);
    }
    void assign(u32 number, u32 row) {
        nexts_[number] = heads_[row];
        heads_[row] = number;
    }
    const SignedErrors errors(u32 row) const { return {errors_[row][0], errors_[row][1]}; }
    std::span<const Vec3> all_positions() const { return positions_; }
    const BoxTree& boxes() const { return boxes_; }
    BoundingBox box_of(u32 row) const;

    /// Pre: planned on the mesh as it is. `stamp`: of the changed boxes.
    void apply(const Removal& removal, u32 stamp);
    void apply_flip(u32 half_edge, const Removal& flip, u32 stamp);
    /// Builds the tree of boxes anew if most triangles are gone.
    void tidy();

private:
    void build_boxes();

    std::span<const Vec3> positions_, extra_;
    Array<u32> heads_;  ///< by row: its first point
    Array<u32> nexts_;  ///< by point: the next one of the same row
    Array<std::array<float, 2>> errors_;  ///< by row: outside, inside; rounded up
    BoxTree boxes_;
    std::vector<u32> rows_, star_;
};

}  // namespace scanmill::decimating
