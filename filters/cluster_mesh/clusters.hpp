// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Two levels of clusters of points, which grow with every point that is inserted.
///
/// Level 1 is the partition into connected components of the graph of points at a distance below `max-edge`. Level 2
/// divides these components into sets whose points are triangulated together. A new point meets the clusters of level 2
/// that have points near it. Let g be the number of points of such a cluster near the new point:
///   case 1  g = 1, and the cluster has no other point: the new point joins the cluster;
///   case 2  no cluster has points near the new point: it becomes a new cluster on both levels;
///   case 3  g = 1, and the cluster has other points: the new point becomes a cluster of its own on level 2 only;
///   case 4  g >= 2: the new point joins the cluster, and is triangulated with it.
/// If the point meets several clusters, their clusters of level 1 become one. On level 2, those of cases 1 and 4 become
/// one.
///
/// Source: Sangveraphunsiri, Srirakulchai 2006, sections 2.2 to 2.4.

#include <array>
#include <span>
#include <vector>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/data/array.hpp"

namespace scanmill::clustering {

class Clusters {
public:
    explicit Clusters(std::size_t points) : first_(points), second_(points), size_(points, 1) {}

    /// Inserts a point; `near` are the inserted points near it. Joins clusters of level 1 at once. join() joins those
    /// of level 2, so that the point may stay a cluster of its own. Returns the case, 1 to 4. If there are several,
    /// case 4 takes precedence over 1, and 1 over 3.
    int meet(u32 point, std::span<const u32> near);
    /// Joins the point and the clusters of level 2 that it met in case 1 or 4 in the last call of meet().
    void join(u32 point);
    /// Joins the clusters of level 2 of two points.
    void unite(u32 a, u32 b);

    std::size_t size(u32 point) { return size_[second_.find(point)]; }

    /// Per point: the number of its cluster. Clusters are numbered in the order of their lowest points.
    struct Numbers {
        Array<u32> of_point;
        u32 count = 0;
    };
    Numbers first_level() { return numbers(first_); }
    Numbers second_level() { return numbers(second_); }

private:
    Numbers numbers(DisjointSets& sets);

    DisjointSets first_, second_;
    std::vector<u32> size_;
    std::vector<u32> met_, joined_;
};

}  // namespace scanmill::clustering
