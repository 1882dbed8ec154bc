// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// From one kind to another, and from doubtful to clean: what a conversion between files needs.

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

/// The mesh's vertices, all of them and in order, with their columns and frame; shares their memory.
PointCloud points_of(const TriangleMesh& mesh);

template <class Geometry>
struct Cleaned {
    Geometry result;
    std::size_t points = 0;     ///< points or vertices left out
    std::size_t triangles = 0;  ///< triangles left out
};

/// The points whose three coordinates are finite, in order, with all columns.
Cleaned<PointCloud> without_invalid_points(const PointCloud& cloud);

/// The vertices whose three coordinates are finite, in order, and what connects only such vertices: triangles, edges
/// and sharp edges with their columns. Unused vertices stay.
Cleaned<TriangleMesh> without_invalid_points(const TriangleMesh& mesh);

}  // namespace scanmill
