// SPDX-License-Identifier: GPL-3.0-or-later
/// What cocone refuses, input that needs a warning, and cancellation.

#include <fmt/format.h>
#include <gmock/gmock.h>

#include "filters/cocone/cases.hpp"
#include "support/numbers.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::Contains;
using testing::HasSubstr;

Error refusal_of(const TetMesh& tets, const CoconeParams& params = {}) {
    return error_of([&] {
        Context context;
        cocone(tets, params, context);
    });
}

PointCloud octahedron() { return cloud_of({{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}}); }

TEST(CoconeRefuses, Weights) {
    TetMesh tets = tets_of(octahedron());
    tets.weights = Array<double>(6, 0.0);
    const Error error = refusal_of(tets);
    EXPECT_THAT(error.sentence(), HasSubstr("6 points have weights"));
    EXPECT_THAT(error.hint(), HasSubstr("'delaunay' without `weights`"));
}

TEST(CoconeRefuses, TetsWithoutCells) {
    TetMesh tets;
    tets.positions = octahedron().positions;
    EXPECT_THAT(refusal_of(tets).sentence(), HasSubstr("has none"));
}

TEST(CoconeRefuses, TetsWithoutNeighbours) {
    TetMesh tets = tets_of(octahedron());
    tets.neighbours = Array<std::array<u32, 4>>();
    const Error error = refusal_of(tets);
    EXPECT_THAT(error.sentence(), HasSubstr(fmt::format("neighbours of all {} cells; there are 0", tets.cells.size())));
    EXPECT_THAT(error.hint(), HasSubstr("'delaunay'"));
}

TEST(CoconeRefuses, ParametersOutOfRange) {
    const TetMesh tets = tets_of(octahedron());
    const auto expect_refused = [&](auto CoconeParams::*member, auto value, std::string_view name) {
        CoconeParams params;
        params.*member = value;
        EXPECT_THAT(refusal_of(tets, params).sentence(), HasSubstr(std::string(name) + " must be"));
    };
    const auto expect_accepted = [&](auto CoconeParams::*member, auto value) {
        CoconeParams params;
        params.*member = value;
        Context context;
        EXPECT_NO_THROW(cocone(tets, params, context));
    };
    struct Range {
        Angle CoconeParams::*angle;
        const char* name;
        double least, most;
    };
    for (const Range& its : {Range{&CoconeParams::cone_angle, "cone-angle", 5, 40},
                             {&CoconeParams::prune_angle, "prune-angle", 90, 170},
                             {&CoconeParams::normal_angle, "normal-angle", 10, 90},
                             {&CoconeParams::gap_angle, "gap-angle", 60, 180}}) {
        for (const double value : {its.least - 0.1, its.most + 0.1, -its.least, nan, infinity})
            expect_refused(its.angle, Angle::degrees(value), its.name);
        expect_accepted(its.angle, Angle::degrees(its.least));
        expect_accepted(its.angle, Angle::degrees(its.most));
    }
    for (const double value : {0.99, 0.0, -1.0, nan}) expect_refused(&CoconeParams::ratio, value, "ratio");
    expect_accepted(&CoconeParams::ratio, 1.0);
    for (const double value : {0.0, -1.0, nan}) expect_refused(&CoconeParams::lid_factor, value, "lid-factor");
}

TEST(CoconeRefuses, PointsWithoutASurface) {
    // All triangles of the octahedron are longer than 0.92 of the local spacing, (4 √2 + 2) / 5.
    CoconeParams params;
    params.lid_factor = 0.92;
    const Error error = refusal_of(tets_of(octahedron()), params);
    EXPECT_THAT(error.sentence(), HasSubstr("no surface"));
    EXPECT_THAT(error.sentence(), HasSubstr("of 6 points, 0 are flat"));
    EXPECT_THAT(error.sentence(), HasSubstr("0 triangles are candidates"));
    for (const char* way_out : {"voxel-thin", "noise: big-balls", "alpha-solid"})
        EXPECT_THAT(error.hint(), HasSubstr(way_out));
    params.lid_factor = 0.93;
    Context context;
    EXPECT_EQ(cocone(tets_of(octahedron()), params, context).mesh.triangles.size(), 8u);
}

TEST(CoconeRefuses, CoplanarPointsAtTheirTetrahedralisation) {
    Array<Vec3> grid;
    for (int i = 0; i < 36; ++i) grid.emplace_back(i % 6, i / 6, 0);
    PointCloud cloud;
    cloud.positions = std::move(grid);
    const Error error = error_of([&] { surface_through(cloud); });
    EXPECT_THAT(error.sentence(), HasSubstr("36"));
    EXPECT_FALSE(error.hint().empty());
}

TEST(Cocone, ColumnsOfItsOwnNames_AreRenamedWithAWarning) {
    PointCloud cloud = fibonacci_sphere(100, 1e-6);
    Array<u32> rows(100);
    for (u32 row = 0; row < 100; ++row) rows[row] = row;
    const Buffer<u32> numbers(std::move(rows));
    for (const char* name : {"flat", "boundary", "pole-normal", "pole-normal-of-points", "row"})
        cloud.columns.add(Column(name, 1, numbers));
    Context context;
    const CoconeResult result = cocone(tets_of(cloud), {}, context);
    const ColumnTable& columns = result.mesh.vertex_columns;
    EXPECT_EQ(columns.size(), 8u);
    for (const char* name :
         {"flat-of-points", "boundary-of-points", "pole-normal-of-points", "pole-normal-of-points-of-points", "row"}) {
        const Column* column = columns.find(name);
        ASSERT_TRUE(column) << name;
        EXPECT_TRUE(std::ranges::equal(column->values<u32>(), numbers)) << name;
    }
    EXPECT_EQ(columns.find("flat")->values<u8>().size(), 100u);
    EXPECT_EQ(columns.find("boundary")->values<u8>().size(), 100u);
    EXPECT_EQ(columns.find("pole-normal")->values<double>().size(), 300u);
    EXPECT_EQ(context.warnings().size(), 3u);
    for (const char* name : {"'flat'", "'boundary'", "'pole-normal'"})
        EXPECT_THAT(context.warnings(), Contains(HasSubstr(name)));
}

TEST(Cocone, Duplicates_AreMergedBefore) {
    const PointCloud once = fibonacci_sphere(300, 1e-6);
    const CoconeResult result = surface_through(joined(once, once)), expected = surface_through(once);
    EXPECT_TRUE(std::ranges::equal(result.mesh.triangles, expected.mesh.triangles));
    EXPECT_EQ(result.unused, 0u);
}

TEST(Cocone, EndsWhenCancelled_InEveryStage) {
    const TetMesh tets = tets_of(fibonacci_sphere(3000, 1e-6));
    std::size_t checks = 0;
    ContextOptions options;
    options.is_cancelled = [&] { return ++checks, false; };
    Context context(options);
    cocone(tets, {}, context);
    const std::size_t all = checks;
    ASSERT_GE(all, 10u);
    for (std::size_t last = 1; last <= all; ++last) {
        checks = 0;
        options.is_cancelled = [&] { return ++checks >= last; };
        Context cancelled(options);
        EXPECT_THROW(cocone(tets, {}, cancelled), Cancelled) << last << " of " << all;
    }
}

TEST(Cocone, Progress_RisesToOne) {
    std::vector<double> fractions;
    ContextOptions options;
    options.on_progress = [&](double fraction) { fractions.push_back(fraction); };
    Context context(options);
    cocone(tets_of(fibonacci_sphere(500, 1e-6)), {}, context);
    ASSERT_GE(fractions.size(), 5u);
    EXPECT_TRUE(std::ranges::is_sorted(fractions));
    EXPECT_EQ(fractions.back(), 1);
}

}  // namespace
}  // namespace scanmill
