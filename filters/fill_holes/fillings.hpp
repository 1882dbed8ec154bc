// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The triangulations of a mesh's loops: which of them intersect something or repeat an edge, and what replaces them.

#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "fill_holes/loop_filling.hpp"
#include "fill_holes/mesh_loops.hpp"
#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// A loop with its triangulation, which becomes plainer while it intersects something.
struct Hole {
    std::span<const u32> loop;
    FillingStage stage;
    bool open = false;
    std::vector<Vec3> positions;
    /// Indices below #vertices are the mesh's vertices.
    std::vector<Triangle> triangles;

    void demote();
};

/// The mesh with the triangulations of all loops.
struct Assembly {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    /// By triangle behind the mesh's: its hole.
    std::vector<u32> owners;

    Assembly(const TriangleMesh& mesh, std::span<const Hole> holes);
};

/// Finds the triangulations that intersect something or repeat an edge.
class Conflicts {
public:
    Conflicts(const TriangleMesh& mesh, std::span<const Hole> holes);

    /// Triangulates the holes at stage `avoiding` by least_triangulation(); those without a result stay open.
    void avoid(std::vector<Hole>& holes, const Execution& execution) const;

    /// Demotes the triangulations that have to give way; false if there is none.
    bool resolve(const Assembly& all, std::vector<Hole>& holes, const Execution& execution) const;

private:
    /// The mesh's triangles in some region: that is faster to search than the whole mesh.
    struct Nearby;
    /// The mesh's triangles whose boxes meet that of one of `others`. Cost: linear in the mesh's triangles.
    Nearby nearby(const TriangleTree& others, const Execution& execution) const;
    /// The triangles of least total area that close the loop, do not intersect the mesh and repeat none of its edges;
    /// ties: those that join the first vertices. Empty if there are none. `around`: the triangles whose boxes
    /// meet that of the loop, and others.
    std::vector<Triangle> least_triangulation(std::span<const u32> loop, const Nearby& around,
                                              const Execution& execution) const;
    /// Vertices of the mesh at one position are one corner.
    Triangle joined(Triangle triangle) const;
    std::vector<u32> owners_of_repeated_edges(const Assembly& all, std::span<const u32> begin,
                                              std::span<const Hole> holes) const;

    const TriangleMesh& mesh_;
    u32 vertices_, count_;
    Array<u32> lowest_;
    /// Edges of the mesh between vertices of loops.
    std::unordered_set<u64> loop_edges_;
};

/// Triangulates the hole at its stage, or at the first plainer one at which CGAL succeeds; otherwise its stage becomes
/// `avoiding`, see Conflicts::avoid().
void fill(Hole& hole, const TriangleMesh& mesh, const MeshLoops& boundary, const Execution& execution);

}  // namespace scanmill
