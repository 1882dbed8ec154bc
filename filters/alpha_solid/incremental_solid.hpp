// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A solid to which cells are added, with a test of whether its boundary is a 2-manifold.
///
/// A new cell changes the boundary only at its four vertices, so only those need a new test. Tests are lazy: one
/// non-manifold vertex is enough to reject a solid, and as long as it stays non-manifold no other is tested.

#include <span>

#include "alpha_solid/components.hpp"
#include "scanmill/geometry/tets/vertex_stars.hpp"

namespace scanmill::alpha {

class IncrementalSolid {
public:
    /// `suspects` are the vertices whose triangles may not be exactly one closed fan; all others are known to be.
    IncrementalSolid(const TetMesh& tets, Array<u8> labels, std::span<const u32> suspects);

    /// Makes cells solid, and with each one every left-out cell that it joins to the solid across facets.
    void add(std::span<const u32> cells);
    /// Makes those of the cells solid that are joined to the solid across facets, perhaps through each other or through
    /// left-out cells; the others become left out.
    void add_joined(std::span<const u32> cells);

    enum class Verdict {
        manifold,
        not_manifold,
        many_suspects  ///< so many vertices are suspect that testing the whole boundary is cheaper: see suspect_only()
    };
    Verdict verdict();
    /// Replaces the suspects, as in the constructor.
    void suspect_only(std::span<const u32> vertices);
    /// Adds, round every non-manifold vertex, the cells with the least `price` that are not solid, all vertices at
    /// once; repeats until no vertex is non-manifold. `price` is per cell. Each pass makes a cell solid, so it ends.
    void repair(std::span<const double> price);

    const Array<u8>& labels() const { return labels_; }
    /// Vertices of solid cells.
    std::size_t covered() const { return covered_count_; }

private:
    void solidify(u32 cell);
    bool is_manifold_at(u32 vertex) { return stars_.surplus_parts(vertex, labels_) == 0; }

    const TetMesh& tets_;
    Array<u8> labels_;
    /// From `next_suspect_` on, oldest first: what was non-manifold from the start is likely to stay so for long. The
    /// first one is non-manifold unless its star has changed since its test.
    std::vector<u32> suspects_;
    std::size_t next_suspect_ = 0;
    bool next_changed_ = true;
    std::size_t many_;
    Array<u8> is_suspect_, covered_;
    std::size_t covered_count_ = 0;
    VertexStars stars_;
    std::vector<u32> stack_;
};

}  // namespace scanmill::alpha
