// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Builds the hull and the weights of a mesh, and repairs the mesh where no surface fits.

#include <map>

#include "a_patch/checks.hpp"
#include "a_patch/repair.hpp"

namespace scanmill::a_patches {

struct ConstructionParams {
    double apex_factor = 1.5;
    Split split = Split::always;
    Curvature curvature = Curvature::distance;
};

/// Repairs a mesh by two rules until its hull carries a surface:
/// 1. Edges are bisected once where tetrahedra are inside out, the next sheet is too near, or a crease leaves
///    the tetrahedra beside its edge.
/// 2. Where that does not suffice, the surface follows the mesh: an edge without sound tetrahedra is open, and a
///    triangle whose part of the surface intersects another part is flat.
class Construction {
public:
    Construction(PatchMesh& mesh, const ConstructionParams& params, Execution& execution)
        : mesh_(mesh),
          params_(params),
          execution_(execution) {}

    Hull hull;  ///< refers to the mesh
    Weights weights;
    Repairs repairs;
    CreaseVerdicts verdicts;
    std::vector<u32> crossing;  ///< flat triangles that intersect each other; ascending

    /// Makes sharp edges smooth whose sides agree, and replaces normals that oppose a triangle.
    void prepare();
    /// Replaces normals that oppose a triangle.
    void prepare_normals() { replace_opposing(mesh_, repairs); }
    /// Pre: prepare(). Post: every edge beside which tetrahedra do not fit is open, or straight and needs none.
    void run();
    /// Triangles beside which another surface over the hull is not sound: at sharp edges, or because their parts
    /// intersect.
    std::vector<u32> violating_triangles(const PatchComplex& patches);

private:
    struct Faults {
        std::vector<Edge> edges;  ///< beside which tetrahedra are inside out or the surface may have several sheets
        std::vector<Edge> creases;  ///< the sharp ones of these edges
        /// Triangles beside the smooth ones of `edges`; in the rounds that bisect, also triangles too near to the next
        /// sheet.
        std::vector<u32> curved;
        bool empty() const { return edges.empty() && curved.empty(); }
    };

    void build();
    Faults faults() const;
    void repair(const Faults& faults);
    bool repair_crossing();
    /// Pairs of triangles whose parts of the surface intersect, among those where something has changed.
    std::vector<std::array<u32, 2>> crossing_pairs(const PatchComplex& patches) const;
    /// Whether something has changed at the vertex since the last search for intersections.
    bool may_cross(u32 vertex) const { return changed_.empty() || (vertex < changed_.size() && changed_[vertex]); }

    PatchMesh& mesh_;
    ConstructionParams params_;
    Execution& execution_;
    std::vector<u32> doubtful_;  ///< see doubtful_edges()
    std::vector<bool> changed_;  ///< by vertex, by the last repair_crossing()
    int round_ = 0;
};

}  // namespace scanmill::a_patches
