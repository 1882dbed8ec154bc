// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Face-connected components of cells, and the points that they cover.

#include <span>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/tets.hpp"
#include "scanmill/geometry/spatial/lists.hpp"
#include "scanmill/geometry/tets/incremental_solid.hpp"

namespace scanmill::alpha {

using enum cell_label::Label;

/// Keeps the face-connected component of solid cells with the most points, and labels the other components `left_out`.
/// Ties: the component with the lower lowest point (by x, then y, then z), then the one with the lower highest point.
void keep_largest_component(const TetMesh& tets, std::span<u8> labels);

/// Per vertex: 1 if one of its cells is solid, else 0.
Array<u8> coverage(const TetMesh& tets, std::span<const u8> labels, unsigned threads);
std::size_t covered_points(const TetMesh& tets, std::span<const u8> labels);

/// The number of points in each component of an alpha-solid to which cells are added.
///
/// Components are joined across facets. Components that merely touch may share points. When two components are joined,
/// the cells of the smaller one are visited once. Therefore each cell is visited at most O(log n) times.
class IncrementalComponents {
public:
    /// Cells that are not `outside` are in the alpha-solid. Cost: about 40 bytes per cell.
    IncrementalComponents(const TetMesh& tets, std::span<const u8> labels);

    /// Pre: the cells were outside.
    void add(std::span<const u32> cells);

    /// The largest number of points in a component, and the number of components with as many points.
    std::size_t most_points() const { return most_points_; }
    std::size_t components_with_most() const { return components_with_[most_points_]; }

private:
    void add(u32 cell);
    void join(u32 a, u32 b);
    std::size_t common_points(u32 smaller, u32 larger);
    bool contains(u32 component, u32 vertex);

    const TetMesh& tets_;
    DisjointSets components_;
    Array<u8> is_in_;
    /// The next cell of the component; its cells form a ring.
    Array<u32> next_;
    /// Set at the root of each component.
    Array<u32> cell_count_, point_count_;
    Lists<> cells_at_;
    /// By number of points: the number of components with that many points.
    Array<u32> components_with_;
    std::size_t most_points_ = 0;
    /// Per vertex, the last pass of common_points() that visited it.
    Array<u32> visited_;
    u32 pass_ = 0;
};

}  // namespace scanmill::alpha
