// SPDX-License-Identifier: GPL-3.0-or-later
/// The column `bin-size`: the search radius that follows from it, and sizes that contradict the density.
#include <gmock/gmock.h>

#include "filters/region_grow/cases.hpp"
#include "merge/merge.hpp"
#include "region_grow/search_radii.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "support/temporary_folder.hpp"
#include "voxel_thin/voxel_thin.hpp"

namespace scanmill {
namespace {

using namespace test;
using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

PointCloud with_bin_sizes(PointCloud cloud, const std::function<double(std::size_t row)>& size) {
    Array<double> sizes(cloud.size());
    for (std::size_t row = 0; row < sizes.size(); ++row) sizes[row] = size(row);
    cloud.columns = {};
    cloud.columns.add(Column("bin-size", 1, Buffer<double>(std::move(sizes))));
    return cloud;
}

PointCloud without_columns(PointCloud cloud) {
    cloud.columns = {};
    return cloud;
}

struct Outcome {
    RegionGrowResult result;
    std::vector<std::string> warnings;
    double known = 0;
};

Outcome run(const PointCloud& cloud, const RegionGrowParams& params = {}) {
    Context context;
    Outcome done;
    done.result = region_grow(cloud, params, context);
    done.warnings = context.warnings();
    if (const auto metric = context.metrics().find("known-bins")) done.known = metric->value;
    return done;
}

void expect_the_same(const RegionGrowResult& one, const RegionGrowResult& two) {
    EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles));
    EXPECT_TRUE(std::ranges::equal(one.rows, two.rows));
}

/// The voxel size that the search radius in the middle of a 41 x 41 grid of step 1 corresponds to. `given`: `bin-size`
/// in the middle, `elsewhere`: at all other points.
double size_in_the_middle(double given, double elsewhere, const Vec3& normal, float variation_of_all = 0.01f) {
    const PointCloud cloud = grid(41, 41);
    const growing::DistinctPoints points = growing::distinct_points_of(cloud.positions.span());
    const growing::Neighbourhoods neighbourhoods(points, 1);
    const Array<Vec3> normals(points.size(), normal);
    Array<double> sizes(points.size(), elsewhere);
    const auto middle =
        static_cast<std::size_t>(std::ranges::find(points.positions, Vec3(20, 20, 0)) - points.positions.begin());
    sizes[middle] = given;
    const Array<float> variation(points.size(), variation_of_all);
    const growing::SearchRadii found = growing::automatic_radii(points, neighbourhoods, normals, variation, sizes, 1);
    return found.radii[middle] / (2 * std::numbers::sqrt3);
}

double size_in_the_middle(double given, const Vec3& normal) { return size_in_the_middle(given, given, normal); }

TEST(RegionGrow_SearchRadius, ByHand_FollowsFromTheColumnWhereTheDensityAgrees) {
    // The 12th neighbour is 2 away. 12 voxels in a circle of radius 2 have size 1.0233 if the surface is aligned with
    // them, and √1.5 times that on average over all directions, which is used where the column is not.
    const double seen = 2 * std::sqrt(std::numbers::pi / 12);
    EXPECT_NEAR(size_in_the_middle(0, Vec3::UnitZ()), std::sqrt(1.5) * seen, 1e-12) << "unknown";
    EXPECT_NEAR(size_in_the_middle(1.1, Vec3::UnitZ()), 1.1, 1e-12);
    EXPECT_NEAR(size_in_the_middle(0.9, Vec3::UnitZ()), 0.9, 1e-12) << "points are a little farther apart";
    EXPECT_NEAR(size_in_the_middle(0.88, Vec3::UnitZ()), std::sqrt(1.5) * seen, 1e-12) << "points are too sparse";
    EXPECT_NEAR(size_in_the_middle(1.8, Vec3::UnitZ()), 1.8, 1e-12) << "layers";
    EXPECT_NEAR(size_in_the_middle(1.9, Vec3::UnitZ()), std::sqrt(1.5) * seen, 1e-12) << "points are too dense";
    // A surface with normal 1 1 1 meets √3 times as many voxels.
    const Vec3 oblique = Vec3(1, 1, -1).normalized();
    EXPECT_NEAR(size_in_the_middle(1.1, oblique), std::sqrt(1.5) * seen, 1e-12);
    EXPECT_NEAR(size_in_the_middle(1.2, oblique), 1.2, 1e-12);
}

TEST(RegionGrow_SearchRadius, ByHand_IsLimitedTo115PercentOfTheNeighbours) {
    EXPECT_NEAR(size_in_the_middle(1.6, 1.1, Vec3::UnitZ()), 1.15 * 1.1, 1e-12);
    EXPECT_NEAR(size_in_the_middle(1.1, 1.6, Vec3::UnitZ()), 1.1, 1e-12);
    EXPECT_NEAR(size_in_the_middle(1.6, 0, Vec3::UnitZ()), 1.6, 1e-12) << "those are unknown";
    EXPECT_NEAR(size_in_the_middle(2.5, 1.1, Vec3::UnitZ()), 1.15 * 1.1, 1e-12) << "the density agrees with that";
}

TEST(RegionGrow_SearchRadius, ByHand_IsNotBelowTheDensityAtTipsAndEdges) {
    const double seen = std::sqrt(1.5) * 2 * std::sqrt(std::numbers::pi / 12);
    EXPECT_NEAR(size_in_the_middle(1.1, 1.1, Vec3::UnitZ(), 0.05f), seen, 1e-12);
    EXPECT_NEAR(size_in_the_middle(1.1, 1.1, Vec3::UnitZ(), 0.03f), 1.1, 1e-12) << "variation as of noise";
    EXPECT_NEAR(size_in_the_middle(1.6, 1.6, Vec3::UnitZ(), 0.05f), 1.6, 1e-12);
}

/// The surface of a cube of cells, thinned with voxels of the cells' size, with a point at every corner of a cell.
PointCloud cube_of_cells(int cells, double size) {
    std::vector<Vec3> points;
    const auto is_outside = [&](int i) { return i == 0 || i == cells; };
    for (int x = 0; x <= cells; ++x)
        for (int y = 0; y <= cells; ++y)
            for (int z = 0; z <= cells; ++z)
                if (is_outside(x) || is_outside(y) || is_outside(z)) points.push_back(Vec3(x, y, z) * size);
    PointCloud cloud = cloud_from(std::move(points));
    return with_bin_sizes(std::move(cloud), [&](std::size_t) { return size; });
}

TEST(RegionGrow_CubeOfCells, KeepsItsCornersAndEdgesWhateverTheUnit) {
    for (const int cells : {4, 8, 12})
        for (const double size : {0.1, 0.3, 1 / 3., 0.7, 0.9, 1., 1.3, 25.4}) {
            SCOPED_TRACE(testing::Message() << cells << " cells of " << size);
            const RegionGrowResult result = grown(cube_of_cells(cells, size));
            EXPECT_EQ(result.unused_points, 0u);
            EXPECT_EQ(result.mesh.triangles.size(), 12u * static_cast<unsigned>(cells * cells));
            EXPECT_EQ(result.corners, 8u);
            EXPECT_EQ(result.creases, 12u);
        }
}

TEST(RegionGrow_LatticeOnACubeThinned, UsesAsManyPointsAsWithoutTheColumn) {
    const PointCloud cloud = thinned(without_columns(cube_of_cells(32, 0.25)), 0.5);
    EXPECT_LE(grown(cloud).unused_points, grown(without_columns(cloud)).unused_points);
}

/// A plate of 60 x 60 with five round holes, at random positions in a grid of voxels of 2.
PointCloud plate_with_holes(double radius, std::uint64_t seed) {
    Random random(seed);
    std::vector<Vec3> points;
    std::vector<Vec3> holes{{15, 15, 0}, {45, 15, 0}, {15, 45, 0}, {45, 45, 0}, {30, 30, 0}};
    for (Vec3& hole : holes) hole += Vec3(random.uniform(0, 2), random.uniform(0, 2), 0);
    for (int i = 0; i < 80'000; ++i) {
        const Vec3 p(random.uniform(0, 60), random.uniform(0, 60), 0);
        if (std::ranges::none_of(holes, [&](const Vec3& hole) { return (p - hole).norm() <= radius; }))
            points.push_back(p);
    }
    return cloud_from(std::move(points));
}

TEST(RegionGrow_HolesOf170PercentOfAVoxel, StayOpenWhereverTheGridLies) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const PointCloud cloud = thinned(plate_with_holes(1.7 * 2, seed), 2);
        const Outcome done = run(cloud);
        expect_consistent(done.result);
        EXPECT_EQ(done.result.holes, 5u) << seed;
        EXPECT_EQ(done.result.loops, 6u) << seed;
        EXPECT_EQ(done.result.unused_points, 0u);
        EXPECT_GE(done.known, 0.95 * static_cast<double>(cloud.size()));
        EXPECT_THAT(done.warnings, IsEmpty());
    }
}

TEST(RegionGrow_BinSizes, OfAnyValueAreUsedWithoutAWarning) {
    // Multiplying and dividing by 2 √3 changes most numbers by rounding; 0.65, 0.82 and 1.3 are among these.
    for (const double size : {0.65, 0.82, 0.9, 1.3, 1.7}) {
        const PointCloud cloud = thinned(plate_with_holes(3.4, 4), size);
        const Outcome done = run(cloud);
        EXPECT_GE(done.known, 0.9 * static_cast<double>(cloud.size())) << size;
        EXPECT_THAT(done.warnings, IsEmpty()) << size;
    }
}

TEST(RegionGrow_BinSizesThatContradictTheDensity, AreIgnored) {
    const PointCloud cloud = thinned(fibonacci_sphere(20000, 0.01), 0.1);
    const Outcome plain = run(without_columns(cloud));
    EXPECT_EQ(plain.known, 0);
    const auto expect_plain = [&](double size) {
        Outcome done = run(with_bin_sizes(cloud, [&](std::size_t) { return size; }));
        EXPECT_EQ(done.known, 0) << size;
        expect_the_same(done.result, plain.result);
        return done.warnings;
    };
    // As of a scan in another unit.
    EXPECT_THAT(expect_plain(1),
                ElementsAre(AllOf(HasSubstr("are too dense for their column `bin-size`"),
                                  ContainsRegex("voxels of 0.1[0-9]* u, not 1;"), HasSubstr("drop the column"))));
    // The scan was sparser than its voxels, or thinned differently afterwards: no warning.
    EXPECT_THAT(expect_plain(0.01), IsEmpty());
    const double inf = std::numeric_limits<double>::infinity();
    for (const double invalid : {0.0, -0.1, inf, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THAT(expect_plain(invalid), IsEmpty()) << invalid;
}

TEST(RegionGrow_BinSizes, AreUsedPerPoint) {
    const PointCloud cloud = thinned(fibonacci_sphere(20000, 0.01), 0.1);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Outcome done = run(with_bin_sizes(cloud, [&](std::size_t row) { return row % 3 ? 0.1 : nan; }));
    expect_consistent(done.result);
    EXPECT_NEAR(done.known, 2.0 / 3 * static_cast<double>(cloud.size()), 0.02 * static_cast<double>(cloud.size()));
    EXPECT_EQ(done.result.unused_points, 0u);
    EXPECT_THAT(done.warnings, IsEmpty());
}

TEST(RegionGrow_BinSizesOfTwoNumbers, AreIgnoredWithAWarning) {
    PointCloud cloud = without_columns(thinned(fibonacci_sphere(5000), 0.1));
    const Outcome plain = run(cloud);
    cloud.columns.add(Column("bin-size", 2, Buffer<double>(Array<double>(2 * cloud.size(), 0.1))));
    const Outcome done = run(cloud);
    expect_the_same(done.result, plain.result);
    EXPECT_THAT(done.warnings, ElementsAre(HasSubstr("not one number per point")));
}

TEST(RegionGrow_BinSizes, AreIgnoredWithAGivenRadius) {
    const PointCloud cloud = thinned(fibonacci_sphere(5000), 0.1);
    RegionGrowParams params;
    params.search_radius = Length(0.4);
    expect_the_same(run(cloud, params).result, run(without_columns(cloud), params).result);
}

TEST(RegionGrow_BinSizes, AreInTheScansUnit) {
    const PointCloud cloud = thinned(plate_with_holes(3.4, 2), 2);
    const Outcome plain = run(cloud);
    for (const double factor : {0x1p-20, 0x1p20}) {
        const Outcome done = run(with_bin_sizes(moved(cloud, factor), [&](std::size_t) { return 2 * factor; }));
        EXPECT_EQ(done.known, plain.known) << factor;
        expect_the_same(done.result, plain.result);
    }
}

TEST(RegionGrow_BinSizesReadFromAFile, GiveTheSameResult) {
    const TemporaryFolder folder;
    const PointCloud cloud = thinned(plate_with_holes(3.4, 3), 2);
    write_file(folder / "thinned.ply", std::make_shared<const PointCloud>(cloud));
    const Outcome before = run(cloud), after = run(*read_points(folder / "thinned.ply"));
    EXPECT_GT(after.known, 0);
    EXPECT_EQ(after.known, before.known);
    expect_the_same(after.result, before.result);
}

TEST(RegionGrow_ScansThinnedApartAndMerged, UseTheSizesOfEach) {
    // Left of 30 with voxels of 1, right of it with voxels of 2.
    std::vector<Vec3> left, right;
    for (const Vec3& p : plate_with_holes(3.4, 1).positions) (p.x() < 30 ? left : right).push_back(p);
    const std::vector<std::shared_ptr<const PointCloud>> parts{
        std::make_shared<const PointCloud>(thinned(cloud_from(left), 1)),
        std::make_shared<const PointCloud>(thinned(cloud_from(right), 2))};
    Context context;
    const PointCloud merged = merge(parts, {}, context).points;
    const Outcome done = run(merged);
    expect_consistent(done.result);
    EXPECT_EQ(done.result.holes, 5u);
    EXPECT_EQ(done.result.loops, 6u);
    EXPECT_GE(done.known, 0.9 * static_cast<double>(merged.size()));
}

TEST(RegionGrow_ScansThinnedDifferentlyOverEachOther, KeepTheHolesOfTheFiner) {
    // Holes of 2.6 are open for voxels of 1, and would not be for the coarser ones.
    const PointCloud plate = plate_with_holes(2.6, 1);
    const auto fine = std::make_shared<const PointCloud>(thinned(plate, 1));
    for (const double size : {1.25, 1.5, 1.75, 2.0, 2.5, 3.0}) {
        const auto coarse = std::make_shared<const PointCloud>(thinned(plate, size));
        for (const auto& parts : {std::vector{fine, coarse}, std::vector{coarse, fine}})
            for (const double within : {0.0, 0.3}) {
                SCOPED_TRACE(testing::Message() << size << " within " << within);
                MergeParams params;
                params.within = Length(within);
                Context context;
                const Outcome done = run(merge(parts, params, context).points);
                expect_consistent(done.result);
                EXPECT_EQ(done.result.holes, 5u);
                EXPECT_EQ(done.result.loops, 6u);
            }
    }
}

TEST(RegionGrow_ScansThinnedByAnOctree, UseTheSizesOfMostLeaves) {
    Array<Vec3> points;
    for (const Vec3& p : random_sphere(100'000, 1).positions) points.push_back({4 * p.x(), p.y(), p.z()});
    VoxelThinParams params;
    params.tolerance = 0.03;
    params.rule = VoxelThinParams::Rule::adaptive;
    Context context;
    const PointCloud cloud = voxel_thin({{}, std::move(points), {}}, params, context).points;
    const Outcome done = run(cloud);
    expect_consistent(done.result);
    EXPECT_EQ(done.result.loops, 0u);
    EXPECT_EQ(done.result.components, 1u);
    EXPECT_LE(1000 * done.result.unused_points, cloud.size());
    EXPECT_GE(2 * done.known, static_cast<double>(cloud.size()));
}

}  // namespace
}  // namespace scanmill
