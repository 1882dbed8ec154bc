// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks of patches, computed from the tetrahedra alone.

#include <map>

#include "a_patch/weights.hpp"

namespace scanmill::a_patches {

/// Number of tetrahedra that are inside out.
std::size_t inverted_tets(const PatchComplex& patches);

/// Judges the edges of a sequence of complexes. Samples a sharp edge only if its weights differ from the last time.
class CreaseVerdicts {
public:
    /// Edges beside which the surface may have several sheets or a gap; ascending. Such an edge has a weight of the
    /// wrong sign, or it is sharp and samples show one of two defects:
    /// - A line from the mesh to an apex, or to the segment between two apexes, does not meet the surface exactly once.
    /// - The crease leaves the thirds of the triangles beside the edge.
    std::vector<u32> doubtful_edges(const PatchComplex& patches, Execution& execution);

private:
    struct Verdict {
        std::vector<PatchWeights> weights;
        bool is_sound;
    };
    std::map<Edge, Verdict> known_;
};

/// Number of doubtful edges, plus the number of weights over triangles with a wrong sign.
std::size_t sign_violations(const PatchComplex& patches, CreaseVerdicts& verdicts, Execution& execution);

/// The largest difference between the gradients on the two sides of a triangle that tetrahedra share, relative to the
/// longer gradient. It is measured at three points per triangle, not across sharp edges.
double c1_jump(const PatchComplex& patches, Execution& execution);

/// Pairs of triangles of the mesh, each the lower one first, whose parts of the surface intersect in a tessellation
/// with 4 segments per edge; ascending. A part may intersect itself. Only these triangles are looked at: `suspects`,
/// those whose boxes meet theirs, and `beside_creases`. Cost: about 0.1 ms per triangle.
std::vector<std::array<u32, 2>> crossing_triangles(const PatchComplex& patches, const Hull& hull,
                                                   std::span<const u32> suspects, std::span<const u32> beside_creases,
                                                   Execution& execution);

}  // namespace scanmill::a_patches
