// SPDX-License-Identifier: GPL-3.0-or-later
// Bins that a thinning told: how far the search reaches with them, and what happens when they are not to be believed.
#include <gmock/gmock.h>

#include "filters/region_grow_cases.hpp"
#include "merge/merge.hpp"
#include "region_grow/normals.hpp"
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

PointCloud thinned(const PointCloud& cloud, double bin) {
    VoxelThinParams params;
    params.bin_size = Length(bin);
    Context context;
    return voxel_thin(cloud, params, context).points;
}

PointCloud with_bins(PointCloud cloud, const std::function<double(std::size_t row)>& size) {
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

/// What one run says, beside its mesh.
struct Said {
    RegionGrowResult result;
    std::vector<std::string> warnings;
    double known = 0;
};

Said grown_and_said(const PointCloud& cloud, const RegionGrowParams& params = {}) {
    Context context;
    Said said;
    said.result = region_grow(cloud, params, context);
    said.warnings = context.warnings();
    if (const auto metric = context.metrics().find("known-bins")) said.known = metric->value;
    return said;
}

void expect_the_same(const RegionGrowResult& one, const RegionGrowResult& two) {
    EXPECT_TRUE(std::ranges::equal(one.mesh.triangles, two.mesh.triangles));
    EXPECT_TRUE(std::ranges::equal(one.rows, two.rows));
}

/// Of a 41 x 41 grid of step 1 at its middle: the bin that the search radius there is 2 √3 of. Bins as told there and
/// everywhere else.
double bin_in_the_middle(double thinned_with, double elsewhere, const Vec3& normal, float roughness_of_all = 0.01f) {
    const PointCloud cloud = grid(41, 41);
    const growing::Samples samples = growing::distinct_samples(cloud.positions.span());
    const growing::Neighbourhoods neighbourhoods(samples, 1);
    const Array<Vec3> normals(samples.size(), normal);
    Array<double> thinned(samples.size(), elsewhere);
    const auto middle =
        static_cast<std::size_t>(std::ranges::find(samples.positions, Vec3(20, 20, 0)) - samples.positions.begin());
    thinned[middle] = thinned_with;
    const Array<float> roughness(samples.size(), roughness_of_all);
    const growing::SearchRadii found =
        growing::automatic_radii(samples, neighbourhoods, normals, roughness, thinned, 1);
    return found.radii[middle] / (2 * std::numbers::sqrt3);
}

double bin_in_the_middle(double thinned_with, const Vec3& normal) {
    return bin_in_the_middle(thinned_with, thinned_with, normal);
}

TEST(RegionGrow_SearchRadius, ByHand_IsOfTheBinsWhereTheDensityAgrees) {
    // The 12th neighbour is 2 away: 12 bins in a circle of radius 2 are of size 1.0233, were each met by a face along
    // the bins; of any direction √1.5 times that, which is what counts where bins are unknown or doubtful.
    const double seen = 2 * std::sqrt(std::numbers::pi / 12);
    EXPECT_NEAR(bin_in_the_middle(0, Vec3::UnitZ()), std::sqrt(1.5) * seen, 1e-12) << "nobody knows";
    EXPECT_NEAR(bin_in_the_middle(1.1, Vec3::UnitZ()), 1.1, 1e-12);
    EXPECT_NEAR(bin_in_the_middle(0.9, Vec3::UnitZ()), 0.9, 1e-12) << "points are a little farther apart";
    EXPECT_NEAR(bin_in_the_middle(0.88, Vec3::UnitZ()), std::sqrt(1.5) * seen, 1e-12) << "points are too sparse";
    EXPECT_NEAR(bin_in_the_middle(1.8, Vec3::UnitZ()), 1.8, 1e-12) << "layers";
    EXPECT_NEAR(bin_in_the_middle(1.9, Vec3::UnitZ()), std::sqrt(1.5) * seen, 1e-12) << "points are too dense";
    // A face across all bins meets √3 times as many.
    const Vec3 oblique = Vec3(1, 1, -1).normalized();
    EXPECT_NEAR(bin_in_the_middle(1.1, oblique), std::sqrt(1.5) * seen, 1e-12);
    EXPECT_NEAR(bin_in_the_middle(1.2, oblique), 1.2, 1e-12);
}

TEST(RegionGrow_SearchRadius, ByHand_IsOfAtMost115PercentOfTheNeighboursBins) {
    EXPECT_NEAR(bin_in_the_middle(1.6, 1.1, Vec3::UnitZ()), 1.15 * 1.1, 1e-12);
    EXPECT_NEAR(bin_in_the_middle(1.1, 1.6, Vec3::UnitZ()), 1.1, 1e-12);
    EXPECT_NEAR(bin_in_the_middle(1.6, 0, Vec3::UnitZ()), 1.6, 1e-12) << "nobody knows those";
    EXPECT_NEAR(bin_in_the_middle(2.5, 1.1, Vec3::UnitZ()), 1.15 * 1.1, 1e-12) << "points agree with that";
}

TEST(RegionGrow_SearchRadius, ByHand_IsNoLessThanTheDensityTellsAtTipsAndEdges) {
    const double seen = std::sqrt(1.5) * 2 * std::sqrt(std::numbers::pi / 12);
    EXPECT_NEAR(bin_in_the_middle(1.1, 1.1, Vec3::UnitZ(), 0.05f), seen, 1e-12);
    EXPECT_NEAR(bin_in_the_middle(1.1, 1.1, Vec3::UnitZ(), 0.03f), 1.1, 1e-12) << "what noise makes";
    EXPECT_NEAR(bin_in_the_middle(1.6, 1.6, Vec3::UnitZ(), 0.05f), 1.6, 1e-12);
}

/// The surface of a cube of so many cells along every edge, where thinning with bins of the cell's size left a point at
/// every corner of a cell.
PointCloud cube_of_cells(int cells, double size) {
    std::vector<Vec3> points;
    const auto is_outside = [&](int i) { return i == 0 || i == cells; };
    for (int x = 0; x <= cells; ++x)
        for (int y = 0; y <= cells; ++y)
            for (int z = 0; z <= cells; ++z)
                if (is_outside(x) || is_outside(y) || is_outside(z)) points.push_back(Vec3(x, y, z) * size);
    PointCloud cloud = cloud_from(std::move(points));
    return with_bins(std::move(cloud), [&](std::size_t) { return size; });
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

TEST(RegionGrow_LatticeOnACubeThinned, UsesAsManyPointsAsWithoutTheBins) {
    const PointCloud cloud = thinned(without_columns(cube_of_cells(32, 0.25)), 0.5);
    EXPECT_LE(grown(cloud).unused_points, grown(without_columns(cloud)).unused_points);
}

/// A plate of 60 x 60 with five round holes, anywhere in the grid of bins of 2.
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

TEST(RegionGrow_HolesOf170PercentOfABin, StayOpenWhereverTheGridLies) {
    for (std::uint64_t seed = 1; seed <= 10; ++seed) {
        const PointCloud cloud = thinned(plate_with_holes(1.7 * 2, seed), 2);
        const Said said = grown_and_said(cloud);
        expect_consistent(said.result);
        EXPECT_EQ(said.result.holes, 5u) << seed;
        EXPECT_EQ(said.result.loops, 6u) << seed;
        EXPECT_EQ(said.result.unused_points, 0u);
        EXPECT_GE(said.known, 0.95 * static_cast<double>(cloud.size()));
        EXPECT_THAT(said.warnings, IsEmpty());
    }
}

TEST(RegionGrow_Bins, OfAnySizeAreBelievedWithoutAWord) {
    // A product and a quotient by 2 √3 give back less than one in twenty of all numbers; 0.65, 0.82 and 1.3 are such.
    for (const double bin : {0.65, 0.82, 0.9, 1.3, 1.7}) {
        const PointCloud cloud = thinned(plate_with_holes(3.4, 4), bin);
        const Said said = grown_and_said(cloud);
        EXPECT_GE(said.known, 0.9 * static_cast<double>(cloud.size())) << bin;
        EXPECT_THAT(said.warnings, IsEmpty()) << bin;
    }
}

TEST(RegionGrow_BinsThatContradictThePoints, CountForNothing) {
    const PointCloud cloud = thinned(fibonacci_sphere(20000, 0.01), 0.1);
    const Said plain = grown_and_said(without_columns(cloud));
    EXPECT_EQ(plain.known, 0);
    const auto expect_plain = [&](double size) {
        Said said = grown_and_said(with_bins(cloud, [&](std::size_t) { return size; }));
        EXPECT_EQ(said.known, 0) << size;
        expect_the_same(said.result, plain.result);
        return said.warnings;
    };
    // As from a scan in another unit.
    EXPECT_THAT(expect_plain(1),
                ElementsAre(AllOf(HasSubstr("too dense for what their column `bin-size` says"),
                                  ContainsRegex("bins of 0.1[0-9]* u, not 1;"), HasSubstr("drop the column"))));
    // The scan was sparser than its bins, or thinned otherwise afterwards: nothing to tell.
    EXPECT_THAT(expect_plain(0.01), IsEmpty());
    const double inf = std::numeric_limits<double>::infinity();
    for (const double nothing : {0.0, -0.1, inf, std::numeric_limits<double>::quiet_NaN()})
        EXPECT_THAT(expect_plain(nothing), IsEmpty()) << nothing;
}

TEST(RegionGrow_Bins, AreToldPerPoint) {
    const PointCloud cloud = thinned(fibonacci_sphere(20000, 0.01), 0.1);
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const Said said = grown_and_said(with_bins(cloud, [&](std::size_t row) { return row % 3 ? 0.1 : nan; }));
    expect_consistent(said.result);
    EXPECT_NEAR(said.known, 2.0 / 3 * static_cast<double>(cloud.size()), 0.02 * static_cast<double>(cloud.size()));
    EXPECT_EQ(said.result.unused_points, 0u);
    EXPECT_THAT(said.warnings, IsEmpty());
}

TEST(RegionGrow_BinsOfTwoNumbers, AreNotReadAndThatIsTold) {
    PointCloud cloud = without_columns(thinned(fibonacci_sphere(5000), 0.1));
    const Said plain = grown_and_said(cloud);
    cloud.columns.add(Column("bin-size", 2, Buffer<double>(Array<double>(2 * cloud.size(), 0.1))));
    const Said said = grown_and_said(cloud);
    expect_the_same(said.result, plain.result);
    EXPECT_THAT(said.warnings, ElementsAre(HasSubstr("not one number per point")));
}

TEST(RegionGrow_Bins, GiveWayToAGivenRadius) {
    const PointCloud cloud = thinned(fibonacci_sphere(5000), 0.1);
    RegionGrowParams params;
    params.search_radius = Length(0.4);
    expect_the_same(grown_and_said(cloud, params).result, grown_and_said(without_columns(cloud), params).result);
}

TEST(RegionGrow_Bins, AreInTheScansUnit) {
    const PointCloud cloud = thinned(plate_with_holes(3.4, 2), 2);
    const Said plain = grown_and_said(cloud);
    for (const double factor : {0x1p-20, 0x1p20}) {
        const Said said = grown_and_said(with_bins(moved(cloud, factor), [&](std::size_t) { return 2 * factor; }));
        EXPECT_EQ(said.known, plain.known) << factor;
        expect_the_same(said.result, plain.result);
    }
}

TEST(RegionGrow_BinsReadBackFromAFile, AreTheSame) {
    const TemporaryFolder folder;
    const PointCloud cloud = thinned(plate_with_holes(3.4, 3), 2);
    write_file(folder / "thinned.ply", std::make_shared<const PointCloud>(cloud));
    const Said before = grown_and_said(cloud), after = grown_and_said(*read_points(folder / "thinned.ply"));
    EXPECT_GT(after.known, 0);
    EXPECT_EQ(after.known, before.known);
    expect_the_same(after.result, before.result);
}

TEST(RegionGrow_ScansThinnedApartAndMerged, ReachAsFarAsEachOnesBins) {
    // Left of 30 with bins of 1, right of it with bins of 2.
    std::vector<Vec3> left, right;
    for (const Vec3& p : plate_with_holes(3.4, 1).positions) (p.x() < 30 ? left : right).push_back(p);
    const std::vector<std::shared_ptr<const PointCloud>> parts{
        std::make_shared<const PointCloud>(thinned(cloud_from(left), 1)),
        std::make_shared<const PointCloud>(thinned(cloud_from(right), 2))};
    Context context;
    const PointCloud merged = merge(parts, {}, context).points;
    const Said said = grown_and_said(merged);
    expect_consistent(said.result);
    EXPECT_EQ(said.result.holes, 5u);
    EXPECT_EQ(said.result.loops, 6u);
    EXPECT_GE(said.known, 0.9 * static_cast<double>(merged.size()));
}

TEST(RegionGrow_ScansThinnedDifferentlyOverEachOther, KeepTheHolesOfTheFiner) {
    // Holes of 2.6 are open for bins of 1, and would not be for the coarser ones.
    const PointCloud plate = plate_with_holes(2.6, 1);
    const auto fine = std::make_shared<const PointCloud>(thinned(plate, 1));
    for (const double bin : {1.25, 1.5, 1.75, 2.0, 2.5, 3.0}) {
        const auto coarse = std::make_shared<const PointCloud>(thinned(plate, bin));
        for (const auto& parts : {std::vector{fine, coarse}, std::vector{coarse, fine}})
            for (const double within : {0.0, 0.3}) {
                SCOPED_TRACE(testing::Message() << bin << " within " << within);
                MergeParams params;
                params.within = Length(within);
                Context context;
                const Said said = grown_and_said(merge(parts, params, context).points);
                expect_consistent(said.result);
                EXPECT_EQ(said.result.holes, 5u);
                EXPECT_EQ(said.result.loops, 6u);
            }
    }
}

TEST(RegionGrow_ScansThinnedByAnOctree, KnowMostOfTheirLeaves) {
    Array<Vec3> points;
    for (const Vec3& p : random_sphere(100'000, 1).positions) points.push_back({4 * p.x(), p.y(), p.z()});
    VoxelThinParams params;
    params.tolerance = 0.03;
    params.rule = VoxelThinParams::Rule::adaptive;
    Context context;
    const PointCloud cloud = voxel_thin({{}, std::move(points), {}}, params, context).points;
    const Said said = grown_and_said(cloud);
    expect_consistent(said.result);
    EXPECT_EQ(said.result.loops, 0u);
    EXPECT_EQ(said.result.components, 1u);
    EXPECT_LE(1000 * said.result.unused_points, cloud.size());
    EXPECT_GE(2 * said.known, static_cast<double>(cloud.size()));
}

}  // namespace
}  // namespace scanmill
