// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster_mesh/clusters.hpp"

#include <algorithm>

namespace scanmill::clustering {

int Clusters::meet(u32 point, std::span<const u32> near) {
    met_.clear();
    joined_.clear();
    for (u32 other : near) {
        first_.unite(point, other);
        met_.push_back(second_.find(other));
    }
    if (met_.empty()) return 2;
    std::ranges::sort(met_);
    int found = 3;
    for (std::size_t i = 0, end = 0; i < met_.size(); i = end) {
        while (end < met_.size() && met_[end] == met_[i]) ++end;
        const std::size_t near_points = end - i;
        if (near_points == 1 && size_[met_[i]] > 1) continue;
        joined_.push_back(met_[i]);
        found = near_points >= 2 ? 4 : found == 4 ? 4 : 1;
    }
    return found;
}

void Clusters::join(u32 point) {
    for (u32 cluster : joined_) unite(point, cluster);
}

void Clusters::unite(u32 a, u32 b) {
    a = second_.find(a);
    b = second_.find(b);
    if (!second_.unite(a, b)) return;
    const u32 all = second_.find(a);
    size_[all] = size_[a] + size_[b];
}

Clusters::Numbers Clusters::numbers(DisjointSets& sets) {
    Numbers numbers;
    numbers.of_point.resize(size_.size());
    for (u32 point = 0; point < size_.size(); ++point) {
        const u32 root = sets.find(point);  // the lowest of its set
        numbers.of_point[point] = root == point ? numbers.count++ : numbers.of_point[root];
    }
    return numbers;
}

}  // namespace scanmill::clustering
