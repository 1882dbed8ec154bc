// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The mesh with its filled holes: where new rows take their values from, and which rows are marked.

#include <span>
#include <vector>

#include "fill_holes/closing_solid.hpp"
#include "fill_holes/fillings.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct FilledMesh {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    /// The rows of the input whose values these have.
    Array<u32> vertex_rows, triangle_rows;
    /// The first triangles are the input's.
    std::size_t kept = 0;
    /// The last vertices are copies of others, at their positions.
    std::size_t copies = 0;
    /// Area of the input's triangles that are left out.
    double replaced_area = 0;
    /// By triangle: 1 if it fills a hole.
    Array<u8> filled;

    /// Twice the area vector of one triangle.
    Vec3 twice_area(std::size_t t) const;
    double area() const;
    /// Area of the triangles that fill a hole, minus that of the input's triangles that they replace; at least 0.
    double filled_area() const;
};

/// Values as fill_holes() describes them. Pre: `all` was made of these holes.
FilledMesh filled_mesh(const TriangleMesh& mesh, Assembly all, std::span<const Hole> holes);

/// The same with the triangles of `closed`: those that exist keep their order and rows, new ones follow. A new triangle
/// has the values of the first triangle at its first vertex. It fills a hole if it is connected, through new triangles,
/// to an edge that was on the boundary; otherwise it replaces others on the same vertices. Returns how many
/// triangles of the input are left out.
std::size_t replace_triangles(FilledMesh& filled, const ClosingSolid& closed, std::size_t first_new);

/// Adds all columns of the input, and `filled`. Sharp edges and rows of edge columns stay while their edge exists.
TriangleMesh with_columns(const TriangleMesh& mesh, FilledMesh filled, Context& context);

}  // namespace scanmill
