// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Triangulates a polygon with the least cost, by dynamic programming over all triangulations (Klincsek 1980).

#include <array>
#include <limits>
#include <vector>

#include "scanmill/data/array.hpp"

namespace scanmill {

/// Corners are numbered along the polygon from 0; triangles are (i, k, j) with i < k < j.
class HoleTriangulation {
public:
    static constexpr double impossible = std::numeric_limits<double>::infinity();

    /// Finds the triangulation with the least sum of costs; false if there is none.
    ///
    /// `edge_cost(i, j)`: cost of an edge across the polygon; called at most once for each edge. `triangle_cost(i, k,
    /// j)`: cost of a triangle without its edges. Both return `impossible` for an edge or triangle that is not allowed.
    /// `accepts(i, k, j)`: last test of a triangle at edge i j, meant for slow tests. It is called only for a triangle
    /// that lowers the cost of the part of the polygon from corner i to corner j. If it returns true, the triangle is
    /// used for that part unless a cheaper one is accepted later.
    ///
    /// Ties: the lowest k. Parts are solved separately. So if `accepts` depends on the triangles of the parts, the sum
    /// need not be the least. Cost: corners³ / 6 triangles.
    template <class EdgeCost, class TriangleCost, class Accepts>
    bool solve(u32 corners, EdgeCost&& edge_cost, TriangleCost&& triangle_cost, Accepts&& accepts) {
        corners_ = corners;
        least_.assign(std::size_t{corners} * corners, impossible);
        apexes_.resize(least_.size());
        for (u32 i = 0; i + 1 < corners; ++i) least_[index(i, i + 1)] = 0;
        for (u32 span = 2; span < corners; ++span)
            for (u32 i = 0; i + span < corners; ++i) {
                const u32 j = i + span;
                double least = impossible, edge = span + 1 == corners ? 0 : unknown;
                for (u32 k = i + 1; k < j; ++k) {
                    const double parts = least_[index(i, k)] + least_[index(k, j)];
                    if (!(parts < least)) continue;
                    const double total = parts + triangle_cost(i, k, j);
                    if (!(total < least)) continue;
                    if (edge == unknown) edge = edge_cost(i, j);
                    if (edge == impossible) break;
                    if (!accepts(i, k, j)) continue;
                    least = total;
                    apexes_[index(i, j)] = k;
                }
                least_[index(i, j)] = least + edge;
            }
        return least_[index(0, corners - 1)] < impossible;
    }

    /// The triangles (i, k, j). Each triangle follows the triangles beyond its edge i k, then those beyond k j. Pre:
    /// the last call of solve() returned true.
    std::vector<std::array<u32, 3>> triangles() const {
        std::vector<std::array<u32, 3>> found;
        collect(0, corners_ - 1, found);
        return found;
    }

private:
    static constexpr double unknown = -1;

    std::size_t index(u32 i, u32 j) const { return std::size_t{i} * corners_ + j; }
    void collect(u32 i, u32 j, std::vector<std::array<u32, 3>>& found) const {
        if (j == i + 1) return;
        const u32 k = apexes_[index(i, j)];
        collect(i, k, found);
        collect(k, j, found);
        found.push_back({i, k, j});
    }

    u32 corners_ = 0;
    std::vector<double> least_;  ///< by edge i j: cost of the part from i to j, including the edge
    std::vector<u32> apexes_;  ///< by edge i j: k of the triangle at the edge
};

}  // namespace scanmill
