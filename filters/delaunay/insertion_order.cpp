// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/insertion_order.hpp"

#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>

#include "scanmill/base/parallel.hpp"

namespace scanmill {

std::vector<PointRow> insertion_order(std::span<const Vec3> positions, unsigned threads) {
    std::vector<PointRow> points(positions.size());
    for_each_chunk(threads, positions.size(), 1 << 14, [&](std::size_t begin, std::size_t end) {
        for (std::size_t row = begin; row < end; ++row) {
            const Vec3& p = positions[row];
            points[row] = {Kernel::Point_3(p.x(), p.y(), p.z()), static_cast<u32>(row)};
        }
    });
    using Traits = CGAL::Spatial_sort_traits_adapter_3<Kernel, CGAL::First_of_pair_property_map<PointRow>>;
    const auto sort = [&]<class Concurrency>(Concurrency) {
        CGAL::spatial_sort<Concurrency>(points.begin(), points.end(), Traits());
    };
    if (threads > 1)
        within_thread_budget(threads, [&] { sort(CGAL::Parallel_tag()); });
    else
        sort(CGAL::Sequential_tag());
    return points;
}

}  // namespace scanmill
