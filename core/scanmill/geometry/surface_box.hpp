// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The bounding box of a mesh's surface.

#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

/// Of the vertices that triangles use: one that no triangle names is no part of the surface, wherever it lies.
/// Non-finite vertices are passed over; empty without triangles.
BoundingBox surface_box(const TriangleMesh& mesh);

}  // namespace scanmill
