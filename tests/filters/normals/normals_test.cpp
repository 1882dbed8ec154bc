// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <functional>

#include "normals/normals.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/point_sets.hpp"
#include "support/real_data.hpp"
#include "support/same_points.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Method = NormalsParams::Method;
using Orient = NormalsParams::Orient;

struct Estimated : NormalsResult {
    std::vector<std::string> doubts, warnings;
    Metrics metrics;
    Vec3 normal(std::size_t row) const {
        const Column& column = *points.columns.find("normal");
        return {column.number(row, 0), column.number(row, 1), column.number(row, 2)};
    }
};
Estimated estimated(const PointCloud& cloud, const NormalsParams& params = {}, unsigned threads = 1) {
    ContextOptions options;
    options.threads = threads;
    Context context(options);
    return {normals(cloud, params, context), doubts_of(context), context.warnings(), context.metrics()};
}
NormalsParams with(Orient orient, Method method = Method::pca, u32 neighbours = 16) {
    NormalsParams params;
    params.orient = orient;
    params.method = method;
    params.neighbours = neighbours;
    return params;
}
/// A square grid in the plane z = height, with a column of directions.
PointCloud sheet(u32 size, double height) {
    Array<Vec3> positions;
    for (u32 y = 0; y < size; ++y)
        for (u32 x = 0; x < size; ++x) positions.emplace_back(x, y, height);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    return cloud;
}
PointCloud with_approach(PointCloud cloud, const std::function<Vec3(std::size_t)>& direction) {
    Array<float> values;
    for (std::size_t row = 0; row < cloud.size(); ++row)
        for (const double number : direction(row)) values.push_back(static_cast<float>(number));
    cloud.columns.add(Column("approach", 3, Buffer<float>(std::move(values))));
    return cloud;
}

TEST(Normals, OfFourPoints_AreThoseOfTheirPlanes) {
    // The nearest two of the first point are in the plane x = 0, those of the last one in the plane z = 0.
    const PointCloud cloud = cloud_of({{0, 0, 5}, {0, 1, 5}, {0, 0, 6}, {0, 0, 0}, {1, 0, 0}, {0, 1.5, 0}});
    const Estimated result = estimated(cloud, with(Orient::none, Method::pca, 2));
    for (const std::size_t row : {0, 1, 2}) EXPECT_EQ(result.normal(row), Vec3(1, 0, 0)) << row;
    for (const std::size_t row : {3, 4, 5}) EXPECT_EQ(result.normal(row), Vec3(0, 0, 1)) << row;
    EXPECT_EQ(result.oriented, 0u);
    EXPECT_EQ(result.components, 2u);
}

TEST(Normals, EquallyNearPoints_TheLowerIsTaken) {
    // Four neighbours at distance 1; (-1, 0, 0) and (0, -1, 0) are the lowest, then (0, 0, -1).
    const PointCloud cloud = cloud_of({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {0, -1, 0}, {0, 0, -1}, {0, 0, 1}});
    EXPECT_EQ(estimated(cloud, with(Orient::none, Method::pca, 2)).normal(0), Vec3(0, 0, 1));
}

TEST(Normals, Duplicates_DoNotCount) {
    // A point and its repeats have the two others as neighbours.
    const PointCloud cloud = cloud_of({{0, 0, 0}, {0, 0, 0}, {0, 0, 0}, {1, 0, 0}, {0, 1, 0}});
    const Estimated result = estimated(cloud, with(Orient::none, Method::pca, 2));
    for (std::size_t row = 0; row < 5; ++row) EXPECT_EQ(result.normal(row), Vec3(0, 0, 1));
}

TEST(Normals, OfASphere_PointOutwards) {
    const PointCloud cloud = fibonacci_sphere(4000);
    for (const Method method : {Method::pca, Method::jet}) {
        const Estimated result = estimated(cloud, with(Orient::automatic, method));
        double least = 1;
        for (std::size_t row = 0; row < cloud.size(); ++row)
            least = std::min(least, result.normal(row).dot(cloud.positions[row].normalized()));
        EXPECT_GT(least, 0.999);
        EXPECT_EQ(result.oriented, cloud.size());
        EXPECT_EQ(result.by_sensor, 0u);
        EXPECT_EQ(result.doubtful, 0u);
        EXPECT_EQ(result.components, 1u);
        EXPECT_THAT(result.doubts, IsEmpty());
        EXPECT_THAT(result.warnings, IsEmpty());
    }
}

TEST(Normals, Jets_AreExactOnAParaboloid_PlanesAreNot) {
    Random random(5);
    Array<Vec3> positions;
    for (int i = 0; i < 2000; ++i) {
        const double x = random.uniform(), y = random.uniform();
        positions.emplace_back(x, y, 0.3 * x * x + 0.2 * y * y);
    }
    PointCloud cloud;
    cloud.positions = std::move(positions);
    const auto mean_error = [&](Method method) {
        const Estimated result = estimated(cloud, with(Orient::tree, method));
        double sum = 0;
        for (std::size_t row = 0; row < cloud.size(); ++row) {
            const Vec3& p = cloud.positions[row];
            sum += (result.normal(row) - Vec3(-0.6 * p.x(), -0.4 * p.y(), 1).normalized()).norm();
        }
        return sum / static_cast<double>(cloud.size());
    };
    EXPECT_LT(mean_error(Method::jet), 1e-3);
    EXPECT_GT(mean_error(Method::pca), 2 * mean_error(Method::jet));
}

TEST(Normals, Sensor_TurnsEveryPointToItsScanner) {
    // Both sheets of a plate, each seen from its own side: neighbours on the other sheet do not matter.
    PointCloud plate = joined(sheet(10, 0), sheet(10, 0.3));
    plate = with_approach(plate, [](std::size_t row) { return Vec3(0.2, 0, row < 100 ? -1 : 1); });
    const Estimated result = estimated(plate, with(Orient::automatic, Method::pca, 6));
    for (std::size_t row = 0; row < 200; ++row) EXPECT_EQ(result.normal(row).z() < 0, row < 100) << row;
    EXPECT_EQ(result.by_sensor, 200u);
    EXPECT_EQ(result.metrics.find("by-sensor")->value, 200);
}

TEST(Normals, KnownOrientation_NeedsAScanner) {
    const PointCloud cloud = sheet(6, 0);
    const Estimated without = estimated(cloud, with(Orient::known));
    EXPECT_EQ(without.points.columns.find("normal"), nullptr);
    EXPECT_EQ(without.metrics.find("oriented")->value, 0);
    NormalsParams params = with(Orient::known);
    params.scanner = std::vector<Length>{Length(0.0), Length(0.0), Length(-9)};
    const Estimated seen = estimated(cloud, params);
    for (std::size_t row = 0; row < 36; ++row) EXPECT_EQ(seen.normal(row), Vec3(0, 0, -1));
}

TEST(Normals, ScannersPosition_IsInWorldCoordinates) {
    PointCloud cloud = sheet(6, 0);
    cloud.frame.origin = Vec3(1000, 0, 100);
    NormalsParams params;
    params.scanner = std::vector<Length>{Length(1000), Length(0.0), Length(99)};  // below the sheet
    const Estimated result = estimated(cloud, params);
    for (std::size_t row = 0; row < 36; ++row) EXPECT_EQ(result.normal(row), Vec3(0, 0, -1));
    EXPECT_EQ(estimated(cloud, with(Orient::tree)).normal(0), Vec3(0, 0, 1))
        << "the tree turns the highest point upwards";
}

TEST(Normals, WithoutADirectionOrSeenEdgeOn_TheNeighboursDecide) {
    const PointCloud cloud = with_approach(sheet(8, 0), [](std::size_t row) {
        if (row == 0) return Vec3(0, 0, -1);
        if (row % 2 == 0) return Vec3(std::numeric_limits<double>::quiet_NaN(), 0, 1);
        return row % 3 == 0 ? Vec3(Vec3::Zero()) : Vec3(1, 0, 0.08);  // 85.4 degrees
    });
    const Estimated result = estimated(cloud);
    EXPECT_EQ(result.by_sensor, 1u);
    EXPECT_EQ(result.oriented, 64u);
    for (std::size_t row = 0; row < 64; ++row) EXPECT_EQ(result.normal(row), Vec3(0, 0, -1));
}

TEST(Normals, Tree_JoinsTheMostParallelNeighboursFirst) {
    // Seven columns of points around a cylinder. The next column but one is a neighbour as well, and its outward normal
    // is more than 90 degrees away; by way of the column between, every normal is outside.
    Array<Vec3> positions;
    for (int row = 0; row < 20; ++row)
        for (int column = 0; column < 7; ++column)
            positions.emplace_back(std::cos(column * 0.8975979), std::sin(column * 0.8975979), 0.87 * row);
    PointCloud cylinder;
    cylinder.positions = std::move(positions);
    const auto outward = [&](std::size_t row) {
        return Vec3(cylinder.positions[row].x(), cylinder.positions[row].y(), 0);
    };
    const PointCloud cloud =
        with_approach(cylinder, [&](std::size_t row) { return row == 70 ? outward(row) : Vec3(Vec3::Zero()); });
    const Estimated result = estimated(cloud, with(Orient::automatic, Method::pca, 12));
    EXPECT_EQ(result.by_sensor, 1u);
    for (std::size_t row = 21; row < 119; ++row) EXPECT_GT(result.normal(row).dot(outward(row)), 0.5) << row;
}

TEST(Normals, ComponentsApart_AreDoubtful) {
    const PointCloud cloud = joined(sheet(22, 0), moved(sheet(20, 0), 1, {90, 0, 0}));
    const Estimated result = estimated(cloud);
    EXPECT_EQ(result.components, 2u);
    EXPECT_THAT(result.doubts,
                ElementsAre(HasSubstr("1 connected component beside the largest is turned by its highest "
                                      "point alone: 45 % of the positions may be inside out")));
    EXPECT_EQ(result.doubtful, 0u);
}

TEST(Normals, ComponentsWithoutAScanner_AreCountedInTheDoubt) {
    // The scanner of the second of four sheets is known.
    PointCloud cloud = sheet(22, 0);
    for (int i = 1; i < 4; ++i) cloud = joined(cloud, moved(sheet(20, 0), 1, {90.0 * i, 0, 0}));
    cloud = with_approach(
        cloud, [&](std::size_t row) { return row >= 484 && row < 884 ? Vec3(0, 0, 1) : Vec3(Vec3::Zero()); });
    const Estimated result = estimated(cloud);
    EXPECT_EQ(result.components, 4u);
    EXPECT_EQ(result.by_sensor, 400u);
    EXPECT_THAT(result.doubts, ElementsAre(HasSubstr("2 connected components beside the largest are turned by their "
                                                     "highest points alone: 48 % of the positions")));
}

TEST(Normals, OfALine_AreDoubtful) {
    Array<Vec3> line;
    for (int i = 0; i < 100; ++i) line.emplace_back(10 + 0.1 * i, 0.2 * i, 0);
    PointCloud tail;
    tail.positions = std::move(line);
    const Estimated result = estimated(joined(fibonacci_sphere(500), tail));
    EXPECT_EQ(result.doubtful, 100u);
    EXPECT_THAT(result.doubts, Contains(HasSubstr("100 of 600 points (17 %) have a doubtful normal")));
}

TEST(Normals, OnTheOtherSideOfTheirNeighbours_AreDoubtful) {
    // One point of a sheet was seen from below.
    const PointCloud cloud = with_approach(sheet(9, 0), [](std::size_t row) { return Vec3(0, 0, row == 40 ? -1 : 1); });
    const Estimated result = estimated(cloud);
    EXPECT_EQ(result.normal(40), Vec3(0, 0, -1));
    EXPECT_EQ(result.doubtful, 1u);
    EXPECT_THAT(result.doubts, IsEmpty());
}

TEST(Normals, OfOutliersAlone_AreDoubtful) {
    const PointCloud cloud = random_cube(5000, 3);
    EXPECT_THAT(estimated(cloud).doubts, Contains(HasSubstr("have a doubtful normal")));
}

TEST(Normals, OfNeighboursAllRound_AreDoubtful) {
    NormalsParams params;
    params.neighbours = 400;
    EXPECT_THAT(estimated(fibonacci_sphere(500), params).doubts,
                Contains(HasSubstr("400 neighbours of a point form no")));
    params.neighbours = 100;
    EXPECT_THAT(estimated(fibonacci_sphere(500), params).doubts, IsEmpty());
}

TEST(Normals, OfTwoScales_PointOutwards) {
    // A sphere of 1 and one of 1/100 inside the larger one's box, both of 2,000 points.
    const PointCloud sphere = fibonacci_sphere(2000);
    const Estimated result = estimated(joined(sphere, moved(sphere, 0.01, {0.9, 0.9, 0.9})));
    for (std::size_t row = 0; row < 4000; ++row)
        EXPECT_GT(result.normal(row).dot(sphere.positions[row % 2000]), 0.99) << row;
    EXPECT_EQ(result.doubtful, 0u);
    EXPECT_THAT(result.doubts, IsEmpty()) << "the flux through both shows their insides";
}

TEST(Normals, NoisyClosedScans_FaceOutwards) {
    // The noise is as large as the spacing, so the normal at the highest point may have any direction.
    for (std::uint64_t seed = 1; seed <= 20; ++seed) {
        const PointCloud sphere = fibonacci_sphere(2000, 0.06, seed);
        const Estimated result = estimated(sphere, with(Orient::tree));
        std::size_t outwards = 0;
        for (std::size_t row = 0; row < sphere.size(); ++row)
            outwards += result.normal(row).dot(sphere.positions[row]) > 0;
        EXPECT_GT(outwards, 1900u) << seed;
    }
}

/// The sphere with exact normals, times a factor for each row.
PointCloud with_normals(PointCloud sphere, const std::function<double(std::size_t)>& factor) {
    Array<float> values;
    for (std::size_t row = 0; row < sphere.size(); ++row)
        for (const double number : sphere.positions[row].normalized())
            values.push_back(static_cast<float>(factor(row) * number));
    sphere.columns.add(Column("normal", 3, Buffer<float>(std::move(values))));
    return sphere;
}
std::size_t facing_out(const Estimated& result) {
    std::size_t count = 0;
    for (std::size_t row = 0; row < result.points.size(); ++row)
        count += result.normal(row).dot(result.points.positions[row]) > 0;
    return count;
}

TEST(NormalsColumn, ItsSidesAreKept_AndDirectionsEstimated) {
    // Both faces of a wall that is thinner than the distance of its points: a tree mixes them up.
    PointCloud wall = joined(sheet(12, 0), sheet(12, 0.2));
    Array<float> values;
    for (std::size_t row = 0; row < wall.size(); ++row)
        for (const float number : {0.3f, 0.f, row < 144 ? -1.f : 1.f}) values.push_back(number);
    wall.columns.add(Column("normal", 3, Buffer<float>(std::move(values))));
    const Estimated result = estimated(wall, with(Orient::column, Method::pca, 12));
    for (std::size_t row = 0; row < wall.size(); ++row) {
        EXPECT_EQ(result.normal(row).z() < 0, row < 144) << row;
        EXPECT_GT(std::abs(result.normal(row).z()), 0.99) << row;
    }
    EXPECT_EQ(result.against, 0u);
}

TEST(NormalsColumn, ThatIsConsistent_IsTheAutomaticChoice) {
    const PointCloud sphere = fibonacci_sphere(2000);
    const Estimated out = estimated(with_normals(sphere, [](std::size_t) { return 1; }));
    EXPECT_EQ(facing_out(out), 2000u);
    EXPECT_THAT(out.doubts, IsEmpty());
    const Estimated in = estimated(with_normals(sphere, [](std::size_t) { return -1; }));
    EXPECT_EQ(facing_out(in), 0u) << "a room is scanned from inside";
    EXPECT_THAT(in.warnings, Contains(HasSubstr("faces inwards at 2000 of 2000 positions")));
    EXPECT_THAT(in.doubts, IsEmpty());
}

TEST(NormalsColumn, ZeroNormalsShowNothing) {
    const PointCloud sphere = fibonacci_sphere(2000);
    const Estimated result = estimated(with_normals(sphere, [](std::size_t row) { return row % 3 == 0; }));
    EXPECT_EQ(facing_out(result), 2000u);
    EXPECT_EQ(facing_out(estimated(with_normals(sphere, [](std::size_t) { return 0; }))), 2000u);
}

TEST(NormalsColumn, ThatContradictsItself_IsDoubtfulAndLeftToTheTree) {
    const PointCloud mixed =
        with_normals(fibonacci_sphere(2000), [](std::size_t row) { return row * 7919 % 10 < 4 ? -1 : 1; });
    const Estimated result = estimated(mixed);
    EXPECT_EQ(facing_out(result), 2000u);
    EXPECT_THAT(result.doubts, ElementsAre(HasSubstr("the column 'normal' contradicts itself")));
    EXPECT_EQ(result.against, 800u);
    EXPECT_EQ(facing_out(estimated(mixed, with(Orient::column))), 1200u);
}

TEST(NormalsColumn, HalfReversed_IsDoubtfulAndKept) {
    const PointCloud sphere = fibonacci_sphere(2000);
    const PointCloud half =
        with_normals(sphere, [&](std::size_t row) { return sphere.positions[row].x() > 0 ? 1 : -1; });
    const Estimated result = estimated(half);
    EXPECT_NEAR(static_cast<double>(facing_out(result)), 1000, 30);
    EXPECT_THAT(result.doubts, ElementsAre(testing::AllOf(HasSubstr("contradicts itself"), HasSubstr("regions"))));
}

TEST(NormalsColumn, DecidesTheSideOfATree) {
    // Without the column, a flat sheet is turned upwards.
    PointCloud cloud = sheet(10, 0);
    Array<float> values;
    for (std::size_t row = 0; row < cloud.size(); ++row)
        for (const float number : {0.f, 0.f, row % 4 == 0 ? 1.f : -1.f}) values.push_back(number);
    cloud.columns.add(Column("normal", 3, Buffer<float>(std::move(values))));
    const Estimated result = estimated(cloud, with(Orient::tree));
    for (std::size_t row = 0; row < cloud.size(); ++row) EXPECT_EQ(result.normal(row), Vec3(0, 0, -1));
    EXPECT_EQ(result.against, 25u);
}

TEST(NormalsRefuse, AMissingColumn) {
    const Error error = error_of([] { estimated(sheet(5, 0), with(Orient::column)); });
    EXPECT_THAT(error.sentence(), HasSubstr("no column 'normal'"));
    EXPECT_THAT(error.hint(), HasSubstr("orient: tree"));
    PointCloud cloud = sheet(5, 0);
    cloud.columns.add(Column("normal", 1, Buffer<float>(Array<float>(25, 1.f))));
    EXPECT_THAT(sentence_of([&] { estimated(cloud, with(Orient::column)); }), HasSubstr("has 1 number per point"));
}

TEST(Normals, OfAPlane_AreItsNormal) {
    const Estimated result = estimated(sheet(20, 3));
    for (std::size_t row = 0; row < 400; ++row) EXPECT_EQ(result.normal(row), Vec3(0, 0, 1));
    EXPECT_THAT(result.doubts, IsEmpty());
}

TEST(Normals, OfLengthZeroInTheInput_AreReplaced) {
    PointCloud cloud = sheet(6, 0);
    cloud.columns.add(Column("normal", 3, Buffer<float>(Array<float>(108, 0.f))));
    EXPECT_EQ(estimated(cloud).normal(0), Vec3(0, 0, 1));
}

TEST(Normals, BesideALineWhereTheSidesChange_AreNotDoubtful) {
    // Points beside the line have most neighbours on their own side of it.
    const PointCloud cloud =
        with_approach(sheet(21, 0), [](std::size_t row) { return Vec3(0, 0, row % 21 < 10 ? -1 : 1); });
    EXPECT_LT(estimated(cloud).doubtful, 10u);
}

TEST(Normals, AColumnOfTheInput_IsReplaced) {
    PointCloud cloud = fibonacci_sphere(100);
    cloud.columns.add(Column("normal", 1, Buffer<float>(Array<float>(100, 1.f))));
    cloud.columns.add(Column("weight", 1, Buffer<float>(Array<float>(100, 2.f))));
    const Estimated result = estimated(cloud);
    EXPECT_THAT(result.warnings, ElementsAre("the column 'normal' of the input is replaced"));
    EXPECT_EQ(result.points.columns.size(), 2u);
    EXPECT_EQ(result.points.columns.find("normal")->components(), 3u);
    EXPECT_EQ(*result.points.columns.find("weight"), *cloud.columns.find("weight"));
}

TEST(Normals, DoNotDependOnThreadsOrOrder) {
    const PointCloud cloud = fibonacci_sphere(3000, 0.01);
    for (const Method method : {Method::pca, Method::jet}) {
        const Estimated one = estimated(cloud, with(Orient::tree, method));
        EXPECT_TRUE(same_points(one.points, estimated(cloud, with(Orient::tree, method), 4).points));
        const PointCloud other = shuffled(one.points, 9);
        PointCloud bare = other;
        bare.columns = {};
        EXPECT_TRUE(same_points(estimated(bare, with(Orient::tree, method)).points, other));
    }
}

TEST(NormalsRefuse, TooFewPositions) {
    EXPECT_EQ(sentence_of([] { estimated({}); }), "the cloud has 0 points; normals need at least 3");
    const Error error = error_of([] { estimated(cloud_of({{0, 0, 0}, {0, 0, 0}, {1, 0, 0}})); });
    EXPECT_EQ(error.sentence(), "the cloud has 2 distinct positions; normals need at least 3");
    EXPECT_FALSE(error.hint().empty());
}

TEST(NormalsRefuse, ALine) {
    Array<Vec3> positions;
    for (int i = 0; i < 50; ++i) positions.emplace_back(i, 2 * i, 0);
    PointCloud cloud;
    cloud.positions = std::move(positions);
    const Error error = error_of([&] { estimated(cloud); });
    EXPECT_EQ(error.sentence(), "the neighbours of each of the 50 positions lie on one line; a normal needs a plane");
    EXPECT_FALSE(error.hint().empty());
}

TEST(NormalsRefuse, NaN) {
    PointCloud cloud;
    cloud.positions = Array<Vec3>(5, Vec3(0, std::numeric_limits<double>::quiet_NaN(), 0));
    EXPECT_THAT(sentence_of([&] { estimated(cloud); }), HasSubstr("5 of 5 points"));
}

TEST(NormalsRefuse, ParametersOutOfRange) {
    for (const u32 neighbours : {0u, 1u, 1001u})
        EXPECT_THAT(error_of([&] { estimated(sheet(5, 0), with(Orient::none, Method::pca, neighbours)); }).sentence(),
                    HasSubstr("neighbours must be from 2 to 1000"));
    NormalsParams params;
    params.scanner = std::vector<Length>{Length(1)};
    EXPECT_THAT(sentence_of([&] { estimated(sheet(5, 0), params); }), HasSubstr("scanner has 1 length; it needs 3"));
    params.scanner = std::vector<Length>(3, Length(std::numeric_limits<double>::quiet_NaN()));
    EXPECT_THAT(sentence_of([&] { estimated(sheet(5, 0), params); }), HasSubstr("a length of scanner is nan u"));
}

TEST(NormalsRefuse, AScannerThatOrientDoesNotUse) {
    for (const Orient orient : {Orient::tree, Orient::none, Orient::column}) {
        NormalsParams params = with(orient);
        params.scanner = std::vector<Length>(3, Length(9));
        const Error error = error_of([&] { estimated(sheet(5, 0), params); });
        EXPECT_THAT(error.sentence(), HasSubstr("scanner is given, but orient is"));
        EXPECT_THAT(error.hint(), HasSubstr("leave scanner out"));
    }
}

TEST(NormalsRefuse, ASensorWithoutDirections) {
    const Error error = error_of([] { estimated(sheet(5, 0), with(Orient::sensor)); });
    EXPECT_THAT(error.sentence(), HasSubstr("no column 'approach'"));
    EXPECT_THAT(error.hint(), HasSubstr("orient: tree"));
    PointCloud cloud = sheet(5, 0);
    cloud.columns.add(Column("approach", 1, Buffer<float>(Array<float>(25, 1.f))));
    EXPECT_THAT(sentence_of([&] { estimated(cloud); }), HasSubstr("the column 'approach' has 1 number per point"));
    EXPECT_EQ(estimated(cloud, with(Orient::tree)).oriented, 25u);
}

TEST(Normals, Cancelled_End) {
    const PointCloud cloud = fibonacci_sphere(40000);
    for (const int after : {0, 1, 3, 60}) {
        ContextOptions options;
        options.is_cancelled = [left = after]() mutable { return left-- <= 0; };
        Context context(options);
        EXPECT_THROW(normals(cloud, {}, context), Cancelled) << after;
    }
}

TEST(NormalsReal, OfARawView_NeighboursAndScannerAgree) {
    // The scanner of a raw view looks along -z.
    SCANMILL_REAL_SCAN(path, shared_data, "1-bunny/raw/bun000.ply");
    const std::shared_ptr<const PointCloud> cloud = read_points(path);
    const Estimated result = estimated(*cloud, with(Orient::tree), 2);
    std::size_t away = 0;
    for (std::size_t row = 0; row < cloud->size(); ++row) away += result.normal(row).z() < 0;
    EXPECT_LT(static_cast<double>(away), 0.001 * static_cast<double>(cloud->size()));
    NormalsParams params;
    params.scanner = std::vector<Length>{Length(0.0), Length(0.1), Length(10)};
    const Estimated sensed = estimated(*cloud, params, 2);
    EXPECT_GT(static_cast<double>(sensed.by_sensor), 0.99 * static_cast<double>(cloud->size()));
    for (std::size_t row = 0; row < cloud->size(); ++row) EXPECT_GT(sensed.normal(row).z(), -0.1);
}

TEST(NormalsReal, OfTheKitten_AreThoseOfTheFile) {
    SCANMILL_REAL_SCAN(path, shared_data, "2-organic/kitten.xyz");
    const std::shared_ptr<const PointCloud> cloud = read_points(path);
    const Column& truth = *cloud->columns.find("normal");
    const Estimated result = estimated(*cloud, with(Orient::tree), 2);
    std::size_t outside = 0;
    for (std::size_t row = 0; row < cloud->size(); ++row)
        outside += result.normal(row).dot(Vec3(truth.number(row, 0), truth.number(row, 1), truth.number(row, 2))) > 0.9;
    EXPECT_GT(static_cast<double>(outside), 0.99 * static_cast<double>(cloud->size()));
    EXPECT_THAT(result.doubts, IsEmpty());
}

}  // namespace
}  // namespace scanmill::test
