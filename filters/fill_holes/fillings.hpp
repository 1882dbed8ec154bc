// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Triangulates the loops of a mesh, and replaces triangulations that intersect something or repeat an edge.

#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "fill_holes/loop_filling.hpp"
#include "fill_holes/mesh_loops.hpp"
#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// A loop with its triangulation. While the triangulation intersects something, it is replaced by a plainer one.
struct Hole {
    std::span<const u32> loop;
    FillingStage stage;
    bool open = false;
    std::vector<Vec3> positions;
    /// Indices below #vertices are vertices of the mesh; higher ones are rows of `positions`, plus #vertices.
    std::vector<Triangle> triangles;

    void demote();
};

/// The mesh with the triangulations of all loops.
struct Assembly {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    /// For each triangle after those of the mesh, the index of its hole.
    std::vector<u32> owners;

    Assembly(const TriangleMesh& mesh, std::span<const Hole> holes);
};

/// Finds the triangulations that intersect something or repeat an edge.
class Conflicts {
public:
    Conflicts(const TriangleMesh& mesh, std::span<const Hole> holes);

    /// Triangulates the holes at stage `avoiding` by least_triangulation(). Holes without a result stay open.
    void avoid(std::vector<Hole>& holes, const Execution& execution) const;

    /// Demotes the triangulations that lose a conflict. Returns false if there is none.
    bool resolve(const Assembly& all, std::vector<Hole>& holes, const Execution& execution) const;

private:
    /// The mesh's triangles in a region. Searching them is faster than searching the whole mesh.
    struct Nearby;
    /// Finds the mesh's triangles whose boxes meet the box of a triangle in `others`. Cost: linear in the mesh's
    /// triangles.
    Nearby nearby(const TriangleTree& others, const Execution& execution) const;
    /// Finds the triangles of least total area that close the loop, do not intersect the mesh and repeat none of its
    /// edges. Ties: the triangles that join the first vertices. Empty if there is no such triangulation. `around`: at
    /// least the mesh's triangles whose boxes meet the loop's box.
    std::vector<Triangle> least_triangulation(std::span<const u32> loop, const Nearby& around,
                                              const Execution& execution) const;
    /// The triangle with each vertex of the mesh replaced by the lowest vertex at its position.
    Triangle joined(Triangle triangle) const;
    std::vector<u32> owners_of_repeated_edges(const Assembly& all, std::span<const u32> begin,
                                              std::span<const Hole> holes) const;

    const TriangleMesh& mesh_;
    u32 vertices_, count_;
    Array<u32> lowest_;
    /// Edges of the mesh between vertices of loops.
    std::unordered_set<u64> loop_edges_;
};

/// Triangulates the hole at its stage. If CGAL fails, tries the plainer stages in turn. If all of them fail, the stage
/// becomes `avoiding`: see Conflicts::avoid().
void fill(Hole& hole, const TriangleMesh& mesh, const MeshLoops& boundary, const Execution& execution);

}  // namespace scanmill
