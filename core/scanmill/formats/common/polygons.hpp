// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Triangles from the faces of a file, which are lists of vertex numbers.
///
/// Indices may be of any number type. Throws Error with the first face whose index is negative, fractional or too
/// large.

#include "scanmill/data/mesh.hpp"

namespace scanmill {

/// Puts the triangles of the faces into the mesh, with the columns of the faces. A polygon a b c d … is cut into the
/// fan (a b c)(a c d) …, and its columns are repeated for each triangle; planarity and convexity are not checked. Faces
/// of fewer than three corners are left out. Warns about cut polygons and about faces left out. Pre: `faces` is a list
/// column.
void put_faces(TriangleMesh& mesh, const Column& faces, std::size_t vertices, const ColumnTable& columns,
               const std::function<void(std::string)>& on_warning);

/// The triangles of strips. Each number after the first two makes a triangle with the two numbers before it; every
/// second triangle has the opposite orientation. -1 begins a new strip. Triangles that use a vertex twice only change
/// the direction of the strip and are left out.
Array<Triangle> triangles_of_strips(const Column& strips, std::size_t vertices);

/// One vertex number per row. Pre: not a list column; `element` names the rows in messages.
Array<u32> vertex_numbers(const Column& column, std::size_t vertices, std::string_view element);

}  // namespace scanmill
