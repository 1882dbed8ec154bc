// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/doubtful_surface.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <numbers>

#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr double long_edge = 7;  // median edges
constexpr double doubtful_spanned = 0.1;
constexpr double long_edge_of_handle = 4;  // median edges
constexpr double doubtful_spanned_of_handle = 0.001;
constexpr double cosine_of_rough = 0.5;  // 60 degrees
constexpr double doubtful_rough = 0.15;
constexpr std::size_t few_edges = 10'000;
constexpr double doubtful_turn = 5;  // degrees

/// The share of the area in triangles with an edge longer than the limit.
double share_beyond(const TriangleMesh& mesh, double limit) {
    double spanned = 0, whole = 0;
    for (const Triangle& triangle : mesh.triangles) {
        const double area = area_vector(mesh.positions, triangle).norm();
        double longest = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3 edge = mesh.positions[triangle[(i + 1) % 3]] - mesh.positions[triangle[i]];
            longest = std::max(longest, edge.squaredNorm());
        }
        whole += area;
        if (longest > limit * limit) spanned += area;
    }
    return whole > 0 ? spanned / whole : 0;
}

}  // namespace

double spanned_share(const TriangleMesh& mesh, double edges) { return share_beyond(mesh, edges * edge_spacing(mesh)); }

double rough_share(const TriangleMesh& mesh) {
    const Array<u32> opposite = half_edges::opposites(mesh);
    std::size_t rough = 0, edges = 0;
    for (u32 half_edge = 0; half_edge < opposite.size(); ++half_edge) {
        const u32 other = opposite[half_edge];
        if (other >= opposite.size() || other < half_edge) continue;  // visits every inner edge once
        const Vec3 one = area_vector(mesh.positions, mesh.triangles[half_edge / 3]);
        const Vec3 two = area_vector(mesh.positions, mesh.triangles[other / 3]);
        ++edges;
        rough += one.dot(two) < cosine_of_rough * one.norm() * two.norm();
    }
    return edges > 0 ? static_cast<double>(rough) / static_cast<double>(edges) : 0;
}

std::vector<std::string> doubts_about_surface(const TriangleMesh& mesh, double noise) {
    std::vector<std::string> doubts;
    const double edge = edge_spacing(mesh);
    if (noise > 0) {
        // The normal of an equilateral triangle with edge a turns by noise / (a / sqrt(2)) about any axis.
        const double degrees = noise * std::numbers::sqrt2 / edge * 180 / std::numbers::pi;
        if (degrees > doubtful_turn)
            doubts.push_back(fmt::format(
                "the points have noise of {:.3g} u (standard deviation), which turns triangles with edges of {:.3g} u "
                "by {:.0f} degrees: remove the noise with the workflow raw-scans, or with `smooth` before the points "
                "are thinned",
                noise, edge, degrees));
    }
    if (const double share = share_beyond(mesh, long_edge * edge); share > doubtful_spanned)
        doubts.push_back(fmt::format(
            "{:.0f} % of the surface's area is in triangles with an edge longer than {} median edges; these triangles "
            "span gaps between the points: scan the missing part, or remove outliers first",
            100 * share, long_edge));
    else if (const double beside = share_beyond(mesh, long_edge_of_handle * edge); beside > doubtful_spanned_of_handle)
        if (const long genus = topology(mesh).genus.value_or(0); genus > 0)
            doubts.push_back(fmt::format(
                "the surface has genus {} and spans gaps between the points: {:.2g} % of its area is in triangles with "
                "an edge longer than {} median edges; the surface may join parts that are separate in the object, or "
                "fill the object's tunnels: scan the missing part, or compare the surface with the object",
                genus, 100 * beside, long_edge_of_handle));
    if (3 * mesh.triangles.size() / 2 <= few_edges) return doubts;
    if (const double share = rough_share(mesh); share > doubtful_rough)
        doubts.push_back(fmt::format(
            "at {:.0f} % of the surface's edges two triangles meet at more than 60 degrees; outliers, or noise as "
            "large as the spacing, crumple the surface: remove or smooth them first, or thin the scan with larger "
            "voxels",
            100 * share));
    return doubts;
}

}  // namespace scanmill
