// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Search radii of the scan beside lines, where the points of lines must not count.

#include <optional>

#include "region_grow/search_radii.hpp"
#include "scanmill/geometry/growing/fixed_edges.hpp"

namespace scanmill::growing {

/// The points of a cloud that are not ends of fixed edges. Points of lines have any density, so they do not count for
/// the density of the scan.
class BesideLines {
public:
    /// Throws Error if fewer than three points are left, or if they are on one line. Cost: O(n log n).
    BesideLines(const DistinctPoints& all, const FixedEdges& edges, unsigned threads);

    const DistinctPoints& points() const { return points_; }
    const Neighbourhoods& neighbourhoods() const { return *near_; }

    /// The normals of points(), from those of all points.
    PointNormals normals_of(const PointNormals& all) const;
    /// The radii of all points, from those of points(): ends of fixed edges have that of the nearest point.
    SearchRadii radii_of_all(const SearchRadii& radii) const;

private:
    DistinctPoints points_;
    /// Per point of points(), its number among all points.
    Array<u32> number_;
    /// Per point of all points, the nearest of points(); for one of them, itself.
    Array<u32> nearest_;
    std::optional<Neighbourhoods> near_;
};

}  // namespace scanmill::growing
