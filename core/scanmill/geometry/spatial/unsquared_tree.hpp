// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Distances and nearest neighbours for coordinates whose squares are no numbers: nothing here is too far or too near.
///
/// Other trees compare squared distances, which is faster and holds from about 1e-154 to 1e154.

#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/frame.hpp"

namespace scanmill {

/// |to - from|, as sqrt((dx² + dy²) + dz²) rounds it where squares are numbers, else as its sum scaled by a power of
/// two does; infinity where it is larger than any double. Pre: finite.
double length_between(const Vec3& from, const Vec3& to);

class UnsquaredTree {
public:
    /// Pre: finite. Cost: O(n log n) time.
    explicit UnsquaredTree(std::vector<Vec3> points);

    /// length_between `from` and the nearest point at another place; infinity when there is none. Cost: O(log n) where
    /// points are spread as samples of surfaces are.
    double to_nearest_other(const Vec3& from) const;

private:
    void build(std::size_t begin, std::size_t end);
    void search(std::size_t begin, std::size_t end, const Vec3& from, double& nearest) const;

    /// The middle one of a range cuts it in two; ranges of a few are leaves.
    std::vector<Vec3> points_;
    /// Along which axis a point cuts its range.
    std::vector<u8> axes_;
};

}  // namespace scanmill
