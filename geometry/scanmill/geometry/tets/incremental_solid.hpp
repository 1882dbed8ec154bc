// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A solid to which cells are added, with a test of whether its boundary is a 2-manifold.
///
/// A new cell changes the boundary only at its four vertices, so only those need a new test. Tests are lazy, because
/// one non-manifold vertex is enough to reject a solid. As long as it stays non-manifold, no other vertex is tested.

#include <span>

#include "scanmill/base/execution.hpp"
#include "scanmill/geometry/tets/vertex_stars.hpp"

namespace scanmill {

namespace cell_label {
/// The state of a cell while a solid is being chosen. Only `solid` cells are in the solid.
enum Label : u8 {
    outside = 0,
    solid = 1,
    left_out = 2  ///< in a component of the solid that is not kept
};
}  // namespace cell_label

class IncrementalSolid {
public:
    /// `suspects` are the vertices whose boundary triangles may not form exactly one closed fan. Pre: all other
    /// vertices have one closed fan, or no boundary triangle.
    IncrementalSolid(const TetMesh& tets, Array<u8> labels, std::span<const u32> suspects);

    /// Makes the cells solid, and every left-out cell that they join to the solid across facets.
    void add(std::span<const u32> cells);
    /// Makes a cell solid if it is joined to the solid across facets, perhaps through others of these cells or through
    /// left-out cells. The other cells become left out.
    void add_joined(std::span<const u32> cells);

    enum class Verdict {
        manifold,
        not_manifold,
        many_suspects  ///< so many vertices are suspect that testing the whole boundary is cheaper: see suspect_only()
    };
    Verdict verdict();
    /// Replaces the suspects; see the constructor.
    void suspect_only(std::span<const u32> vertices);
    /// Adds cells until no vertex is non-manifold. In each pass, it adds around every non-manifold vertex the cells
    /// with the smallest `price` among those that are not solid. `price` is per cell. Each pass makes a cell solid, so
    /// the repair ends. Throws Cancelled.
    void repair(std::span<const double> price, const Execution& execution);

    const Array<u8>& labels() const { return labels_; }
    /// Number of vertices of solid cells.
    std::size_t covered() const { return covered_count_; }

private:
    void solidify(u32 cell);
    bool is_manifold_at(u32 vertex) { return stars_.surplus_parts(vertex, labels_) == 0; }

    const TetMesh& tets_;
    Array<u8> labels_;
    /// The suspects are the elements from `next_suspect_` on. The oldest come first, because a vertex that was
    /// non-manifold from the start is likely to stay so for long. The suspect at `next_suspect_` is non-manifold unless
    /// its star has changed since its test.
    std::vector<u32> suspects_;
    std::size_t next_suspect_ = 0;
    bool next_changed_ = true;
    std::size_t many_;
    Array<u8> is_suspect_, covered_;
    std::size_t covered_count_ = 0;
    VertexStars stars_;
    std::vector<u32> stack_;
};

}  // namespace scanmill
