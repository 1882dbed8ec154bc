// SPDX-License-Identifier: GPL-3.0-or-later
// Scanned and designed objects.

#include <gmock/gmock.h>

#include "filters/edge_flip/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill {
namespace {

using namespace test;

/// The largest angle that a tenth of the triangles do not exceed with their least angle.
double tenth_of_least_angles(const TriangleMesh& mesh) {
    std::vector<double> angles;
    for (const auto& [a, b, c] : mesh.triangles)
        angles.push_back(least_angle_of(mesh.positions[a], mesh.positions[b], mesh.positions[c]));
    std::ranges::sort(angles);
    return angles[angles.size() / 10];
}

class EdgeFlipOfAScan : public testing::TestWithParam<const char*> {};

TEST_P(EdgeFlipOfAScan, MakesRounderTriangles_AndLeavesNoneThatTheRulesAllow) {
    SCANMILL_REAL_SCAN(path, shared_data, GetParam());
    const auto mesh = read_mesh(path);
    for (const Criterion criterion : {Criterion::delaunay, Criterion::shorter}) {
        EdgeFlipParams params;
        params.criterion = criterion;
        const EdgeFlipResult result = flipped(*mesh, params);
        expect_laws(*mesh, result, params);
        EXPECT_GT(result.flips.size(), 100u);
        const Census left = census(result.mesh, params);
        EXPECT_EQ(left.flippable, 0u);
        EXPECT_EQ(left.blocked, result.left);
        if (criterion == Criterion::delaunay) {
            EXPECT_GE(result.min_angle_after, result.min_angle_before);
            EXPECT_GE(tenth_of_least_angles(result.mesh), tenth_of_least_angles(*mesh));
        } else {
            EXPECT_LT(total_length(result.mesh), total_length(*mesh));
        }
    }
}

INSTANTIATE_TEST_SUITE_P(Scans, EdgeFlipOfAScan,
                         testing::Values("1-bunny/bun_zipper.ply", "2-organic/armadillo_cgal.off", "4-open/holes.off",
                                         "7-seed-like/mannequin-devil.off"));

TEST(EdgeFlipWarns, OfVerticesOfTheMergedDragonThatRepeatAPosition) {
    SCANMILL_REAL_SCAN(path, fetched_data, "dragon/dragon_vrip.ply");
    const auto mesh = read_mesh(path);
    Context context;
    EdgeFlipParams params;
    params.noise = Length(0);
    const EdgeFlipResult result = edge_flip(*mesh, params, context);
    EXPECT_THAT(context.warnings(),
                testing::Contains(testing::HasSubstr("2100 vertices have the position of another")));
    expect_laws(*mesh, result, params);
}

}  // namespace
}  // namespace scanmill
