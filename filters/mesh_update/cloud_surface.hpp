// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The surface of a local cloud, and the closed loops of edges where it ends.
///
/// The paper takes all edges of cocone's surface between two boundary points. The test for boundary points alone finds
/// a third of a gently curved border, so no loop closes. Here an edge is a boundary edge if exactly one triangle of the
/// surface has it.
///
/// Source: Woo, Dey 2005, section 3.2.

#include <vector>

#include "scanmill/data/mesh.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::updating {

struct CloudLoop {
    /// Boundary half-edges of the surface, end to end; the surface is on their left.
    Array<u32> half_edges;
    double length = 0;
    /// Whether the loop surrounds a part that was not scanned, rather than the cloud.
    bool is_hole = false;
};

struct CloudSurface {
    /// cocone()'s surface: vertices in the order of the cloud, without those in no triangle.
    TriangleMesh mesh;
    std::vector<CloudLoop> loops;  ///< those used, in the order of boundary_loops()
    std::size_t ignored_loops = 0;
    std::size_t boundary_edges = 0;  ///< edges in one triangle
    std::size_t paper_edges = 0;  ///< edges between two boundary points
    /// Median distance of a point of the cloud to the nearest other one.
    double spacing = 0;
};

/// The longest loop of every component of the surface is used, and its other loops if they have at least a tenth of
/// that length; the rest are pinholes. Ignored are loops of fewer than 8 edges, components whose longest loop is
/// shorter than a tenth of the cloud's longest, and loops of which most runs within two spacings of another component.
///
/// Pre: finite positions. Throws Error for a cloud without a surface or without a boundary.
/// Ties: of equally long loops, the first.
/// Cost: that of delaunay() and cocone().
CloudSurface cloud_surface(const Buffer<Vec3>& positions, const Frame& frame, Context& context);

/// By triangle, a number that the triangles connected with it through edges share. Pre: as half_edges::opposites().
Array<u32> components_of(std::span<const u32> opposite);

}  // namespace scanmill::updating
