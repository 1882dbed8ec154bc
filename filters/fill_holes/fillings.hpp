// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The fillings of a mesh's loops: which of them intersect something or repeat an edge, and what replaces them.

#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "fill_holes/loop_filling.hpp"
#include "fill_holes/mesh_loops.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

/// A loop with its filling, which becomes plainer while it intersects something.
struct Hole {
    std::span<const u32> loop;
    FillingStage stage;
    bool open = false;
    std::vector<Vec3> positions;
    /// Indices below #vertices are the mesh's vertices.
    std::vector<Triangle> triangles;

    void demote();
};

/// The mesh with all fillings.
struct Assembly {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    /// By triangle behind the mesh's: its hole.
    std::vector<u32> owners;

    Assembly(const TriangleMesh& mesh, std::span<const Hole> holes);
};

/// Finds which fillings intersect something, or repeat an edge.
class Conflicts {
public:
    Conflicts(const TriangleMesh& mesh, std::span<const Hole> holes, unsigned threads);

    /// Demotes the fillings that have to give way; false if there is none.
    bool resolve(const Assembly& all, std::vector<Hole>& holes, const Execution& execution) const;

    /// The triangles of least total area that close the loop, do not intersect the mesh and repeat none of its edges;
    /// of equal ones those that join the first vertices. Empty if there are none, or too many to try.
    std::vector<Triangle> least_triangulation(std::span<const u32> loop, const Execution& execution) const;

private:
    Triangle joined(Triangle triangle) const;
    bool meets_mesh(const Triangle& triangle) const;
    std::vector<u32> owners_of_repeated_edges(const Assembly& all, std::span<const u32> begin,
                                              std::span<const Hole> holes) const;

    const TriangleMesh& mesh_;
    u32 vertices_, count_;
    TriangleTree tree_;
    Array<u32> lowest_;
    /// Of the mesh, between vertices of loops.
    std::unordered_set<u64> rim_edges_;
};

/// Fills the hole at its stage, or at the first plainer one that has a filling; otherwise it is open.
void fill(Hole& hole, const TriangleMesh& mesh, const MeshLoops& boundary, const Conflicts& conflicts,
          const Execution& execution);

}  // namespace scanmill
