// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Clouds with a column `normal`, and what region-grow says of them.

#include "filters/region_grow_cases.hpp"

namespace scanmill::test {

template <class NormalAt>
PointCloud with_normals(PointCloud cloud, NormalAt&& normal_at) {
    Array<double> numbers;
    for (const Vec3& p : cloud.positions) {
        const Vec3 normal = normal_at(p);
        numbers.insert(numbers.end(), normal.begin(), normal.end());
    }
    cloud.columns.add(Column("normal", 3, Buffer<double>(std::move(numbers))));
    return cloud;
}

inline std::vector<std::string> warnings_of(const PointCloud& cloud) {
    Context context;
    region_grow(cloud, {}, context);
    return context.warnings();
}

}  // namespace scanmill::test
