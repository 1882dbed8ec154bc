// SPDX-License-Identifier: GPL-3.0-or-later
/// Laws of any alpha-solid: it does not depend on order, threads, scale or position; and what is refused.

#include <gmock/gmock.h>

#include <Eigen/Geometry>
#include <cmath>
#include <cstring>
#include <set>

#include "filters/alpha_solid/cases.hpp"
#include "support/point_sets.hpp"
#include "support/shapes.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::HasSubstr;

TEST(AlphaSolid, PointsInAnyOrder_GiveTheSameSolid) {
    const std::vector<PointCloud> clouds{random_cube(300, 3),        lattice_cube(5),
                                         l_block_surface(5, 1, 5),   cubes_sharing_a_corner(),
                                         lattice_cube(7, 0.1, true), two_spheres()};
    for (const PointCloud& cloud : clouds) {
        const AlphaSolidResult expected = solid_of(cloud);
        for (std::uint64_t seed : {1, 2, 3}) {
            const AlphaSolidResult result = solid_of(shuffled(cloud, seed));
            EXPECT_EQ(result.alpha, expected.alpha);
            EXPECT_EQ(result.alpha_cover, expected.alpha_cover);
            EXPECT_EQ(result.choice, expected.choice);
            EXPECT_EQ(places(result.mesh), places(expected.mesh));
        }
    }
}

TEST(AlphaSolid, AnyNumberOfThreads_GivesTheSameBytes) {
    for (const PointCloud& cloud : {random_cube(20000, 5), fibonacci_sphere(30000, 1e-4), lattice_cube(20)})
        for (AlphaComponents components : {AlphaComponents::single, AlphaComponents::many})
            for (double share : {100.0, 99.0}) {
                const TetMesh tets = tets_of(cloud);
                const AlphaSolidResult one = solid_of(tets, covering(share, components), 1);
                const AlphaSolidResult two = solid_of(tets, covering(share, components), 2);
                EXPECT_EQ(one.alpha, two.alpha);
                EXPECT_TRUE(std::ranges::equal(one.tets.inside, two.tets.inside));
                EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles));
                EXPECT_TRUE(std::ranges::equal(one.mesh.positions, two.mesh.positions));
                EXPECT_TRUE(std::ranges::equal(one.interior_points, two.interior_points));
                EXPECT_TRUE(std::ranges::equal(one.uncovered_points, two.uncovered_points));
            }
}

TEST(AlphaSolid, ScaledPoints_ScaleAlpha) {
    const PointCloud cloud = poisson_torus(0.15, 0.4, 5000);
    const AlphaSolidResult base = solid_of(cloud);
    for (double factor : {0x1p-30, 0.3, 1000.0}) {
        const AlphaSolidResult scaled = solid_of(moved(cloud, factor));
        EXPECT_NEAR(scaled.alpha / factor / base.alpha, 1, 1e-9);
        EXPECT_EQ(scaled.mesh.triangles.size(), base.mesh.triangles.size());
    }
}

TEST(AlphaSolid, MovedAndTurnedPoints_GiveTheSameAlpha) {
    const PointCloud cloud = poisson_torus(0.15, 0.4, 5000);
    const AlphaSolidResult base = solid_of(cloud);
    for (const PointCloud& other : {rotated(cloud, 0.6), moved(cloud, 1, Vec3(1e6, -3e5, 20))}) {
        const AlphaSolidResult result = solid_of(other);
        EXPECT_NEAR(result.alpha / base.alpha, 1, 1e-6);
        EXPECT_EQ(result.mesh.triangles.size(), base.mesh.triangles.size());
    }
}

TEST(AlphaSolid, ColumnsAndFrame_TravelWithTheVertices) {
    PointCloud cloud = lattice_cube(4);
    Array<u32> rows(cloud.size());
    for (u32 i = 0; i < rows.size(); ++i) rows[i] = i;
    cloud.columns.add(Column("row", 1, Buffer<u32>(std::move(rows))));
    cloud.frame = {LengthUnit::millimetre, Vec3(1000, 0, 0), "part"};
    const AlphaSolidResult result = solid_of(cloud);
    EXPECT_EQ(result.mesh.frame, cloud.frame);
    const Column* column = result.mesh.vertex_columns.find("row");
    ASSERT_NE(column, nullptr);
    for (std::size_t i = 0; i < result.mesh.positions.size(); ++i)
        EXPECT_EQ(result.mesh.positions[i], cloud.positions[column->values<u32>()[i]]);
    EXPECT_TRUE(std::ranges::is_sorted(column->values<u32>()));
}

TEST(AlphaSolid, Metrics_AreTheResultsNumbers) {
    const TetMesh tets = tets_of(lattice_cube(6));
    Context context;
    const AlphaSolidResult result = alpha_solid(tets, {}, context);
    const auto value = [&](std::string_view name) { return context.metrics().find(name)->value; };
    EXPECT_EQ(value("alpha"), result.alpha);
    EXPECT_EQ(context.metrics().find("alpha")->unit, Unit::length);
    EXPECT_EQ(value("alpha-cover"), result.alpha_cover);
    EXPECT_EQ(value("cells"), static_cast<double>(tets.cells.size()));
    EXPECT_EQ(value("interior-points"), 125);
    EXPECT_EQ(value("uncovered-points"), 0);
    EXPECT_EQ(value("triangles"), static_cast<double>(2 * 218 - 4));
    EXPECT_EQ(value("spectrum"), 1);
}

TEST(AlphaSolid, ParametersOutOfRange_AreRefused) {
    const TetMesh tets = tets_of(lattice_cube(1));
    EXPECT_THAT(refusal(tets, at_alpha(0)), HasSubstr("alpha must be a length above 0; it is 0 u"));
    EXPECT_THAT(refusal(tets, at_alpha(-1)), HasSubstr("above 0; it is -1 u"));
    EXPECT_THAT(refusal(tets, at_alpha(std::nan(""))), HasSubstr("alpha must be a length above 0"));
    EXPECT_THAT(refusal(tets, at_alpha(HUGE_VAL)), HasSubstr("alpha must be a length above 0"));
    EXPECT_THAT(refusal(tets, covering(0)), HasSubstr("coverage must be above 0 % and at most 100 %; it is 0 %"));
    EXPECT_THAT(refusal(tets, covering(101)), HasSubstr("it is 101 %"));
}

TEST(AlphaSolid, TetrahedralisationWithoutCells_IsRefused) {
    EXPECT_THAT(refusal(TetMesh{}, {}), HasSubstr("needs a tetrahedralisation with cells; this one has none"));
    TetMesh tets = tets_of(lattice_cube(1));
    tets.neighbours = Buffer<std::array<u32, 4>>();
    EXPECT_THAT(refusal(tets, {}), HasSubstr("there are 0"));
}

TEST(AlphaSolid, WhenCancelled_StopsWithCancelled) {
    const TetMesh tets = tets_of(random_cube(20000, 1));
    int asked = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++asked > 12; };
    Context context(options);
    EXPECT_THROW(alpha_solid(tets, {}, context), Cancelled);
}

}  // namespace
}  // namespace scanmill
