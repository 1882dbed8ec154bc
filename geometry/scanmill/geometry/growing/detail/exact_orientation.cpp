// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/growing/detail/exact_orientation.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

namespace scanmill::exact {

int orientation(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    const auto point = [](const Vec3& p) { return Kernel::Point_3(p.x(), p.y(), p.z()); };
    return static_cast<int>(CGAL::orientation(point(a), point(b), point(c), point(d)));
}

}  // namespace scanmill::exact
