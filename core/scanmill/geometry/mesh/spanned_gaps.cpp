// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/spanned_gaps.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>

#include "scanmill/geometry/spatial/spacing.hpp"

namespace scanmill {

namespace {

constexpr double long_edge = 7;  // median edges
constexpr double doubtful_share = 0.1;

}  // namespace

double spanned_share(const TriangleMesh& mesh) {
    const double limit = long_edge * edge_spacing(mesh);
    double spanned = 0, whole = 0;
    for (const Triangle& triangle : mesh.triangles) {
        const Vec3& a = mesh.positions[triangle[0]];
        const Vec3 ab = mesh.positions[triangle[1]] - a, ac = mesh.positions[triangle[2]] - a;
        const double area = ab.cross(ac).norm();
        whole += area;
        if (std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()}) > limit * limit) spanned += area;
    }
    return whole > 0 ? spanned / whole : 0;
}

std::string doubt_about_gaps(const TriangleMesh& mesh) {
    const double share = spanned_share(mesh);
    if (share <= doubtful_share) return {};
    return fmt::format(
        "{:.0f} % of the surface's area is in triangles with an edge longer than {} median edges, where it spans gaps "
        "between the points: scan the missing part, or run outlier-removal first",
        100 * share, long_edge);
}

}  // namespace scanmill
