// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// From the faces of a file, lists of vertex numbers, to triangles.
///
/// A polygon a b c d … is cut into the fan (a b c)(a c d) …; the columns of the face are repeated for each of its
/// triangles. Nothing is said about planarity or convexity: fans are what every format's readers agree on. Faces of
/// fewer than three corners are left out. Indices may be of any number type; negative, fractional or too large ones are
/// refused.

#include "scanmill/data/mesh.hpp"

namespace scanmill {

struct Fans {
    Array<Triangle> triangles;
    /// The face that each triangle came from; empty when triangle i is face i.
    Array<u32> face_of;
    std::size_t polygons = 0;  ///< faces of more than three corners
    std::size_t left_out = 0;  ///< faces of fewer than three corners
};

/// Pre: `faces` is a list column. Throws Error naming the first face with an index outside 0 … vertices - 1.
Fans triangulated(const Column& faces, std::size_t vertices);

/// Strips of triangles: each further number makes a triangle with the two before it, every other one turned round; -1
/// begins a new strip. Triangles that name a vertex twice only serve to steer the strip and are left out.
Array<Triangle> triangles_of_strips(const Column& strips, std::size_t vertices);

/// One vertex number per row, checked as above. Pre: not a list column; `element` names the rows in messages.
Array<u32> vertex_numbers(const Column& column, std::size_t vertices, std::string_view element);

/// The fans' triangles and the faces' columns put into a mesh; what was cut or left out is told.
void put_faces(TriangleMesh& mesh, Fans fans, const ColumnTable& columns,
               const std::function<void(std::string)>& on_warning);

}  // namespace scanmill
