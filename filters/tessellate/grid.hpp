// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Builds the triangles above a triangle of the mesh.

#include <span>

#include "tessellate/strip.hpp"

namespace scanmill::tessellation {

/// Vertices along an edge or inside a triangle, with their shares of the row's length.
struct Row {
    std::vector<u32> vertices;
    std::vector<double> shares;
    std::vector<double> insets{};  ///< on an edge: Sample::inset
};

/// The points inside a triangle. They are on `rows` - 1 triangles around the base point. The smaller such a triangle
/// is, the fewer segments it has.
struct Grid {
    unsigned segments = 1, rows = 1;
    bool is_triangular = false;  ///< an undivided triangle has a triangular grid instead
    std::vector<double> shares;  ///< by row: share of the way from the base point to the edges; the last row is on them
    std::vector<SurfacePoint> points;
    u32 first_vertex = 0;
    double worst = 0;  ///< distance found between the triangles and the surface

    /// Number of segments of row r within one third.
    unsigned segments_of(unsigned r) const { return (segments * r + rows - 1) / rows; }
};

/// Numbers of the points on triangles around a base point: first the base point, then those on the lines from there to
/// the corners, then those of the thirds.
class ThirdsNumbers {
public:
    explicit ThirdsNumbers(const Grid& grid) : grid_(grid), before_(grid.rows + 1, 0) {
        for (unsigned r = 1; r < grid.rows; ++r) before_[r + 1] = before_[r] + grid.segments_of(r) - 1;
    }
    u32 count() const { return 1 + 3 * (grid_.rows - 1) + 3 * before_.back(); }
    /// Point k of row r = 0 … rows - 1; row 0 is the base point.
    u32 operator()(u32 third, u32 r, u32 k) const {
        if (r == 0) return 0;
        if (k == 0) return 1 + third * (grid_.rows - 1) + r - 1;
        if (k == grid_.segments_of(r)) return 1 + (third + 1) % 3 * (grid_.rows - 1) + r - 1;
        return 1 + 3 * (grid_.rows - 1) + third * before_.back() + before_[r] + k - 1;
    }

private:
    const Grid& grid_;
    std::vector<u32> before_;  ///< inner points of a third in the rows before
};

/// Number of an inner vertex of an undivided triangle of level n >= 3, given by its steps from corner 0 to corners 1
/// and 2.
inline u32 grid_vertex(u32 i, u32 j) { return (i + j - 1) * (i + j - 2) / 2 + j - 1; }

/// Makes the triangles between a row on an edge and a row inside the triangle, both in the edge's direction. The row
/// with the smaller next share goes on; if the shares are equal, the edge's row does. Calls add(a, b, c) with a and b
/// in one row.
template <class Add>
void join(const Row& edge, const Row& inner, Add&& add) {
    std::size_t i = 0, j = 0;
    const std::size_t edges = edge.vertices.size() - 1, inners = inner.vertices.size() - 1;
    while (i < edges || j < inners)
        if (i < edges && (j == inners || edge.shares[i + 1] <= inner.shares[j + 1])) {
            add(edge.vertices[i], edge.vertices[i + 1], inner.vertices[j]);
            ++i;
        } else {
            add(inner.vertices[j + 1], inner.vertices[j], edge.vertices[i]);
            ++j;
        }
}

/// A row of `count` points at equal distances. The share of a single point is 0.
template <class VertexAt>
Row inner_row(u32 count, VertexAt&& vertex_at) {
    Row row;
    for (u32 k = 0; k < count; ++k) {
        row.vertices.push_back(vertex_at(k));
        row.shares.push_back(count > 1 ? static_cast<double>(k) / (count - 1) : 0);
    }
    return row;
}

/// Calls add(third, a, b, c) for the triangles of rows around a base point, whose inner vertices begin at `first`. a
/// and b are in one row; c is in the next row or the one before.
template <class Add>
void connect_thirds(const Grid& grid, u32 first, const std::array<Row, 3>& edges, Add&& add) {
    const ThirdsNumbers numbers(grid);
    for (u32 third = 0; third < 3; ++third) {
        Row inner{{first}, {0}};
        for (u32 r = 1; r <= grid.rows; ++r) {
            const Row outer = r == grid.rows ? edges[third] : inner_row(grid.segments_of(r) + 1, [&](u32 k) {
                return first + numbers(third, r, k);
            });
            join(outer, inner, [&](u32 a, u32 b, u32 c) { add(third, a, b, c); });
            inner = outer;
        }
    }
}

/// Calls add(0, a, b, c) for the triangles of a triangular grid, whose inner vertices begin at `first`.
template <class Add>
void connect_triangular(const Grid& grid, u32 first, const std::array<Row, 3>& edges, Add&& add) {
    const u32 n = grid.segments;
    if (n == 1) {
        add(0, edges[0].vertices[0], edges[1].vertices[0], edges[2].vertices[0]);
        return;
    }
    const auto at = [&](u32 i, u32 j) { return first + grid_vertex(i, j); };
    for (std::size_t i = 0; i < 3; ++i) {
        const Row inner = inner_row(n <= 3 ? 1 : n - 2, [&](u32 k) {
            if (n <= 3) return first;
            return i == 0 ? at(k + 1, 1) : i == 1 ? at(n - 2 - k, k + 1) : at(1, n - 2 - k);
        });
        join(edges[i], inner, [&](u32 a, u32 b, u32 c) { add(0, a, b, c); });
    }
    for (u32 i = 1; i + 2 < n; ++i)
        for (u32 j = 1; i + j + 1 < n; ++j) {
            add(0, at(i, j), at(i + 1, j), at(i, j + 1));
            if (i + j + 2 < n) add(0, at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
        }
}

/// Calls add(third, a, b, c) for the triangles between the points of a grid, which begin at `first`, and the points on
/// the edges. Corners may be equal.
template <class Add>
void connect(const Grid& grid, u32 first, const std::array<Row, 3>& edges, Add&& add) {
    grid.is_triangular ? connect_triangular(grid, first, edges, add) : connect_thirds(grid, first, edges, add);
}

/// Limits of a grid's refinement.
struct Fineness {
    std::optional<double> max_error;  ///< if empty: as fine as the grid's segments, or those of its edges
    unsigned most = 1;  ///< largest number of segments
};

/// Sets all members but the first vertex. `edges` are vertices with the positions `points`. Values up to `zero` count
/// as 0.
void build(Grid& grid, const PatchComplex& patches, const TriangleTets& triangle, const std::array<Row, 3>& edges,
           std::span<const SurfacePoint> points, double zero, const Fineness& fineness);

}  // namespace scanmill::tessellation
