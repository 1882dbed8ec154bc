// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mesh with its filled holes, the input rows that supply column values of new rows, and the marks of new
/// triangles.

#include <span>
#include <vector>

#include "fill_holes/closing_solid.hpp"
#include "fill_holes/fillings.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct FilledMesh {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    /// For each vertex and for each triangle, the input row that supplies its column values.
    Array<u32> vertex_rows, triangle_rows;
    /// Number of triangles of the input; they come first.
    std::size_t kept = 0;
    /// Number of copies of vertices, at the same positions; they come last.
    std::size_t copies = 0;
    /// Area of the input's triangles that are left out.
    double replaced_area = 0;
    /// By triangle: 1 if it fills a hole.
    Array<u8> filled;

    /// Twice the area vector of one triangle.
    Vec3 twice_area(std::size_t t) const;
    double area() const;
    /// Area of the triangles that fill a hole, minus the area of the input's triangles that are left out; at least 0.
    double filled_area() const;
};

/// Assigns rows of the input as fill_holes() describes. Pre: `all` was assembled from `holes`.
FilledMesh filled_mesh(const TriangleMesh& mesh, Assembly all, std::span<const Hole> holes);

/// Replaces the triangles by those of `closed`. Triangles that existed before keep their order and rows; new triangles
/// follow. A new triangle has the values of the first triangle at its lowest vertex. New triangles fill a hole if they
/// are connected to an edge that was on the boundary; otherwise they replace others on the same vertices. Vertices from
/// `first_new` on are dropped if no triangle uses them. Returns the number of input triangles that are left out.
std::size_t replace_triangles(FilledMesh& filled, const ClosingSolid& closed, std::size_t first_new);

/// Adds all columns of the input, and the columns `filled`. Keeps sharp edges and rows of edge columns whose edges
/// still exist.
TriangleMesh with_columns(const TriangleMesh& mesh, FilledMesh filled, Context& context);

}  // namespace scanmill
