// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Normals of a mesh for shading.

#include <array>
#include <vector>

#include "scanmill/data/mesh.hpp"

namespace scanmill {

class SurfaceNormals {
public:
    /// Copies nothing but the triangles around every vertex; the mesh must outlive the object.
    /// Pre: consistent and finite. Cost: linear, 40 bytes per triangle.
    SurfaceNormals(const TriangleMesh& mesh, unsigned threads);

    /// The unit normal at a point of a triangle, which is given by the weights of its corners. Zero in a triangle
    /// without area.
    ///
    /// The normals of the corners are interpolated: those of the face column `corner-normals`, else of the vertex
    /// column `normal`, else the sums of the area vectors of the facets around the vertex's position that are within 40
    /// degrees of this facet. Beside a vertex of more than 64 facets, the facet's own normal is used.
    Vec3 at(u32 triangle, const std::array<double, 3>& weights) const;
    /// The facet's unit normal; zero without area.
    Vec3 facet(u32 triangle) const;

private:
    Vec3 corner(u32 triangle, std::size_t corner, const Vec3& facet) const;

    const TriangleMesh& mesh_;
    const Column *corner_normals_ = nullptr, *vertex_normals_ = nullptr;
    Array<Vec3> area_vectors_;
    /// For every vertex the lowest one at its position, and the triangles around each of these; empty if the mesh has
    /// normals.
    Array<u32> lowest_, begin_, around_;
};

}  // namespace scanmill
