// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/beside_lines.hpp"

#include <algorithm>

#include "scanmill/data/point_tree.hpp"

namespace scanmill::growing {

BesideLines::BesideLines(const DistinctPoints& all, const FixedEdges& edges, unsigned threads) : nearest_(all.size()) {
    std::ranges::fill(nearest_, invalid_index);
    for (u32 point = 0; point < all.size(); ++point) {
        if (edges.at(point)) continue;
        nearest_[point] = static_cast<u32>(points_.size());
        number_.push_back(point);
        points_.positions.push_back(all.positions[point]);
        points_.rows.push_back(all.rows[point]);
    }
    for (const auto& [point, row] : all.repeats)
        if (nearest_[point] != invalid_index) points_.repeats.push_back({nearest_[point], row});
    growing::require_area(points_, points_.size());
    near_.emplace(points_, threads);

    const PointTree tree(points_.positions, threads);
    Array<u32> point_of_index(points_.size());
    const auto indices = tree.index_of_row();
    for (u32 point = 0; point < indices.size(); ++point) point_of_index[indices[point]] = point;
    NeighbourBuffer buffer;
    for (u32 point = 0; point < all.size(); ++point)
        if (nearest_[point] == invalid_index)
            nearest_[point] = point_of_index[tree.nearest_to(all.positions[point], 1, buffer).front().index];
}

PointNormals BesideLines::normals_of(const PointNormals& all) const {
    PointNormals own;
    for (u32 point : number_) {
        own.directions.push_back(all.directions[point]);
        own.variation.push_back(all.variation[point]);
    }
    return own;
}

SearchRadii BesideLines::radii_of_all(const SearchRadii& radii) const {
    SearchRadii all;
    all.known = radii.known;
    for (u32 point : nearest_) {
        all.radii.push_back(radii.radii[point]);
        all.by_density.push_back(radii.by_density[point]);
    }
    return all;
}

}  // namespace scanmill::growing
