// SPDX-License-Identifier: GPL-3.0-or-later
/// normals and smooth have the results of CGAL's functions, apart from ties.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/jet_estimate_normals.h>
#include <CGAL/jet_smooth_point_set.h>
#include <CGAL/pca_estimate_normals.h>
#include <CGAL/property_map.h>
#include <gtest/gtest.h>

#include <utility>
#include <vector>

#include "normals/normals.hpp"
#include "smooth/smooth.hpp"
#include "support/point_sets.hpp"

namespace scanmill::test {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;

TEST(Normals, AreThoseOfCgal) {
    const PointCloud cloud = fibonacci_sphere(500, 0.02);
    using Pair = std::pair<Kernel::Point_3, Kernel::Vector_3>;
    for (const NormalsParams::Method method : {NormalsParams::Method::pca, NormalsParams::Method::jet}) {
        std::vector<Pair> pairs;
        for (const Vec3& p : cloud.positions)
            pairs.emplace_back(Kernel::Point_3(p.x(), p.y(), p.z()), Kernel::Vector_3());
        const auto maps = CGAL::parameters::point_map(CGAL::First_of_pair_property_map<Pair>())
                              .normal_map(CGAL::Second_of_pair_property_map<Pair>());
        if (method == NormalsParams::Method::pca)
            CGAL::pca_estimate_normals<CGAL::Sequential_tag>(pairs, 18, maps);
        else
            CGAL::jet_estimate_normals<CGAL::Sequential_tag>(pairs, 18, maps);
        NormalsParams params;
        params.method = method;
        params.neighbours = 18;
        params.orient = NormalsParams::Orient::none;
        Context context;
        const Column normal = *normals(cloud, params, context).points.columns.find("normal");
        for (std::size_t row = 0; row < cloud.size(); ++row) {
            const auto& n = pairs[row].second;
            EXPECT_NEAR(std::abs(Vec3(normal.number(row, 0), normal.number(row, 1), normal.number(row, 2))
                                     .dot(Vec3(n.x(), n.y(), n.z()).normalized())),
                        1, 1e-6)
                << row;
        }
    }
}

TEST(Smooth, IsThatOfCgal) {
    const PointCloud cloud = fibonacci_sphere(600, 0.01, 4);
    std::vector<Kernel::Point_3> points;
    for (const Vec3& p : cloud.positions) points.emplace_back(p.x(), p.y(), p.z());
    CGAL::jet_smooth_point_set<CGAL::Sequential_tag>(points, 24);
    Context context;
    const SmoothResult result = smooth(cloud, {}, context);
    for (std::size_t row = 0; row < cloud.size(); ++row)
        EXPECT_LT((result.points.positions[row] - Vec3(points[row].x(), points[row].y(), points[row].z())).norm(),
                  1e-9);
}

}  // namespace
}  // namespace scanmill::test
