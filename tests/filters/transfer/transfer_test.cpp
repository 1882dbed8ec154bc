// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include <cmath>
#include <limits>
#include <numbers>

#include "filters/transfer/cases.hpp"
#include "scanmill/base/random.hpp"
#include "scanmill/formats/files.hpp"
#include "support/doubts.hpp"
#include "support/real_data.hpp"
#include "transfer/srgb_curve.hpp"

namespace scanmill::test {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Method = TransferParams::Method;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

/// Two triangles over the unit square; the vertex in row 3 is beyond the diagonal from row 0.
TriangleMesh unit_square(double z = 0) {
    TriangleMesh mesh;
    mesh.positions = {Vec3(0, 0, z), Vec3(1, 0, z), Vec3(0, 1, z), Vec3(1, 1, z)};
    mesh.triangles = {Triangle{0, 1, 2}, Triangle{1, 3, 2}};
    return mesh;
}

TEST(Transfer, ThreePointsByHand_AreBlendedByDistance) {
    // The square of the radius is that of the farthest distance and 1/12 more: 4 × 13/12. The weights of the distances
    // 0, 1 and 2 are 13/13, 10/13 and 1/13.
    const PointCloud from =
        with(cloud_of({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}), column_of<double>("height", 1, {0, 1, 2}));
    const auto result = carried(from, cloud_of({{0, 0, 0}}), columns_within({"height"}, 10));
    EXPECT_NEAR(numbers_in(result.result, "height").at(0), (10 * 1 + 1 * 2) / 24.0, 1e-12);
}

TEST(Transfer, BlackAndWhite_AreMixedInLinearLight) {
    // Half of the light is code 188 of sRGB (0.5 → 187.5), not 128. Noise as large as the contrast makes both similar.
    const PointCloud from =
        with(cloud_of({{-1, 0, 0}, {1, 0, 0}}), column_of<u8>("colour", 4, {0, 0, 0, 100, 255, 255, 255, 200}));
    const auto result = carried(from, cloud_of({{0, 0, 0}}), columns_within({"colour"}, 2));
    EXPECT_THAT(numbers_in(result.result, "colour"), ElementsAre(188, 188, 188, 150));
}

TEST(Transfer, SrgbCurve_HasTheStandardsValues_AndAnExactInverse) {
    for (const u32 levels : {256u, 65536u}) {
        const transferring::SrgbCurve curve(levels);
        for (u32 code = 0; code < levels; ++code) ASSERT_EQ(curve.code(curve.linear(code)), code);
        EXPECT_EQ(curve.linear(0), 0);
        EXPECT_NEAR(curve.linear(levels - 1), 1, 1e-15);
        EXPECT_EQ(curve.code(-0.1), 0u);
        EXPECT_EQ(curve.code(1.1), levels - 1);
    }
    EXPECT_NEAR(transferring::SrgbCurve(256).linear(128), 0.21586, 1e-5);
    EXPECT_NEAR(transferring::SrgbCurve(256).linear(10), 10 / 255.0 / 12.92, 1e-15);
}

TEST(Transfer, OneSpeckAmongManyPoints_IsOutvoted) {
    // 5 × 5 points of one colour, with a red one in the middle; nearest takes it.
    PointCloud from;
    Array<Vec3> positions;
    std::vector<u8> colours;
    for (int x = -2; x <= 2; ++x)
        for (int y = -2; y <= 2; ++y) {
            positions.emplace_back(x, y, 0);
            const bool is_middle = x == 0 && y == 0;
            for (const u8 channel : {is_middle ? 255 : 20, 40, 60}) colours.push_back(channel);
        }
    from.positions = std::move(positions);
    from.columns.add(column_of<u8>("colour", 3, colours));
    const PointCloud to = cloud_of({{0, 0, 0}});
    EXPECT_THAT(numbers_in(carried(from, to, columns_within({"colour"}, 3)).result, "colour"), ElementsAre(20, 40, 60));
    EXPECT_THAT(numbers_in(carried(from, to, columns_within({"colour"}, 3, Method::nearest)).result, "colour"),
                ElementsAre(255, 40, 60));
}

TEST(Transfer, EquallyNearPoints_TheLowestRowCounts) {
    // More equally near points than one search finds, and a lower row at the same position as another one.
    PointCloud from;
    Array<Vec3> positions;
    std::vector<std::int32_t> views;
    for (int i = 0; i < 400; ++i) {
        const double angle = i * std::numbers::pi / 200;
        positions.emplace_back(std::cos(angle) > 0 ? 1 : -1, 0, 0);
        views.push_back(i);
    }
    std::ranges::reverse(positions);
    from.positions = std::move(positions);
    from.columns.add(column_of("view", 1, views));
    for (const Method method : {Method::nearest, Method::blend}) {
        EXPECT_THAT(
            numbers_in(carried(from, cloud_of({{0, 0, 0}}), columns_within({"view"}, 2, method)).result, "view"),
            ElementsAre(0));
    }
    // The 30 grid points at a distance of 3 from the origin: (3, 0, 0) and its like, (2, 2, 1) and its like.
    Array<Vec3> grid;
    std::vector<std::int32_t> numbers;
    for (int x = 3; x >= -3; --x)
        for (int y = 3; y >= -3; --y)
            for (int z = 3; z >= -3; --z)
                if (x * x + y * y + z * z == 9) {
                    numbers.push_back(static_cast<std::int32_t>(grid.size()));
                    grid.emplace_back(x, y, z);
                }
    ASSERT_EQ(grid.size(), 30u);
    PointCloud ball;
    ball.positions = std::move(grid);
    ball.columns.add(column_of("view", 1, numbers));
    EXPECT_THAT(numbers_in(carried(ball, cloud_of({{0, 0, 0}}), columns_within({"view"}, 4)).result, "view"),
                ElementsAre(0))
        << "row 0 has the highest x and comes last in the search";
}

TEST(Transfer, MaxDistance_IsReachedByPointsAtIt_AndBeyondRowsAreMarked) {
    const PointCloud from =
        with(with(with(with(cloud_of({{0, 0, 0}, {0, 1, 0}}), column_of<u8>("colour", 4, {1, 2, 3, 4, 1, 2, 3, 4})),
                       column_of<float>("height", 1, {7, 7})),
                  column_of<std::uint16_t>("colour16", 3, {5, 6, 7, 5, 6, 7})),
             Column("list", Buffer<u64>{0, 1, 3}, Buffer<u8>{9, 8, 7}));
    const PointCloud to = cloud_of({{2, 0, 0}, {std::nextafter(2.0, 3.0), 0, 0}});
    for (const Method method : {Method::nearest, Method::blend}) {
        const auto result = carried(from, to, columns_within({"colour", "height", "colour16", "list"}, 2, method));
        EXPECT_THAT(numbers_in(result.result, "transferred"), ElementsAre(1, 0));
        EXPECT_THAT(numbers_in(result.result, "colour"), ElementsAre(1, 2, 3, 4, 128, 128, 128, 255));
        EXPECT_THAT(numbers_in(result.result, "colour16"), ElementsAre(5, 6, 7, 32896, 32896, 32896))
            << "128 × 257, the same grey";
        EXPECT_THAT(numbers_in(result.result, "height"), ElementsAre(7, 0));
        const Column& list = *result.result.columns.find("list");
        EXPECT_THAT(list.offsets().span(), ElementsAre(0u, 1u, 1u));
        EXPECT_THAT(list.values<u8>(), ElementsAre(9));
        EXPECT_EQ(result.transferred, 1u);
        EXPECT_EQ(result.unknown, 1u);
    }
}

TEST(Transfer, MaxDistanceAuto_IsThreeSpacingsOfFrom) {
    const PointCloud from =
        with(cloud_of({{0, 0, 0}, {0.5, 0, 0}, {1, 0, 0}}), column_of<u8>("colour", 3, std::vector<u8>(9, 50)));
    const auto result = carried(from, cloud_of({{-1.49, 0, 0}, {-1.51, 0, 0}}), {});
    EXPECT_EQ(result.max_distance, 1.5);
    EXPECT_THAT(numbers_in(result.result, "transferred"), ElementsAre(1, 0));
}

TEST(Transfer, MaxDistanceAuto_SpansTheGapsOfRandomSamples) {
    Random random(4);
    Array<Vec3> points, everywhere;
    for (int i = 0; i < 4000; ++i) points.emplace_back(random.uniform(), random.uniform(), 0);
    for (int x = 5; x <= 95; ++x)
        for (int y = 5; y <= 95; ++y) everywhere.emplace_back(0.01 * x, 0.01 * y, 0);
    PointCloud from, to;
    from.positions = std::move(points);
    to.positions = std::move(everywhere);
    from = with(from, column_of<u8>("colour", 3, std::vector<u8>(12000, 50)));
    EXPECT_EQ(carried(from, to, {}).unknown, 0u);
}

TEST(Transfer, ChannelsThatAreNoColour_AreWarnedOf) {
    PointCloud from = cloud_of({{0, 0, 0}, {1, 0, 0}});
    for (const char* name : {"red", "green", "blue"}) from = with(from, column_of<float>(name, 1, {0.5f, 1}));
    Context context;
    EXPECT_EQ(transfer(from, cloud_of({{0, 0, 0}}), {}, context).transferred, 0u);
    ASSERT_EQ(context.warnings().size(), 1u);
    EXPECT_THAT(context.warnings()[0], HasSubstr("'red', 'green' and 'blue'"));
}

TEST(Transfer, WhereAllIsMarkedAsFilled_TheResultIsDoubtful) {
    const PointCloud from = with(cloud_of({{0, 0, 0}, {1, 0, 0}}), column_of<u8>("colour", 3, std::vector<u8>(6, 50)));
    Context context;
    transfer(from, with(cloud_of({{0, 0, 0}}), column_of<u8>("filled", 1, {1})), {}, context);
    ASSERT_EQ(context.doubts().size(), 1u);
    Context other;
    const auto marked_otherwise =
        transfer(from, with(cloud_of({{0, 0, 0}}), column_of<u8>("filled", 1, {2})), {}, other);
    EXPECT_EQ(marked_otherwise.transferred, 1u) << "only 1 is the mark";
}

TEST(Transfer, FilledRows_GetNoColour_UnlessAskedFor) {
    const PointCloud from = with(cloud_of({{0, 0, 0}, {1, 1, 0}}), column_of<u8>("colour", 3, {9, 9, 9, 9, 9, 9}));
    TriangleMesh to = with(unit_square(), column_of<u8>("filled", 1, {0, 1, 0, 0}));
    to = with(to, column_of<u8>("colour", 3, std::vector<u8>(12, 77)));
    TransferParams params;
    auto result = carried(from, to, params);
    EXPECT_THAT(numbers_in(result.result, "transferred"), ElementsAre(1, 0, 1, 1));
    EXPECT_THAT(numbers_in(result.result, "colour"), ElementsAre(9, 9, 9, 128, 128, 128, 9, 9, 9, 9, 9, 9));
    EXPECT_EQ(result.filled, 1u);
    EXPECT_EQ(result.unknown, 0u);
    params.filled = true;
    result = carried(from, to, params);
    EXPECT_THAT(numbers_in(result.result, "transferred"), Each(1));
    EXPECT_EQ(result.filled, 0u);
    EXPECT_TRUE(result.result.vertex_columns.find("filled")) << "columns of `to` stay";
}

TEST(Transfer, ThinWall_TheBackDoesNotComeThrough) {
    // The front is red and sparse, the back blue, dense and as near.
    const auto wall = [](const char* name) {
        Array<Vec3> positions;
        std::vector<u8> colours;
        std::vector<float> directions;
        for (int i = 0; i <= 20; ++i)
            for (int j = 0; j <= 20; ++j) {
                const bool has_front = i % 5 == 0 && j % 5 == 0;
                for (int side = has_front ? 1 : -1; side >= -1; side -= 2) {
                    positions.emplace_back(i / 20.0, j / 20.0, side * 0.01);
                    for (const int channel : {side > 0 ? 200 : 0, 0, side > 0 ? 0 : 200})
                        colours.push_back(static_cast<u8>(channel));
                    for (const float number : {0.f, 0.f, static_cast<float>(5 * side)}) directions.push_back(number);
                }
            }
        PointCloud cloud;
        cloud.positions = std::move(positions);
        cloud.columns.add(column_of<u8>("colour", 3, colours));
        cloud.columns.add(column_of<float>(name, 3, directions));
        return cloud;
    };
    const std::vector<double> red{200, 0, 0, 200, 0, 0, 200, 0, 0, 200, 0, 0};
    for (const char* name : {"normal", "approach"})
        for (const Method method : {Method::blend, Method::nearest})
            EXPECT_EQ(
                numbers_in(carried(wall(name), unit_square(0.001), columns_within({"colour"}, 0.5, method)).result,
                           "colour"),
                red)
                << name;
    const auto blind = carried(wall("other"), unit_square(0.001), columns_within({"colour"}, 0.5));
    EXPECT_NE(numbers_in(blind.result, "colour"), red) << "without directions, the back is nearer";
}

TEST(Transfer, MeshThatFacesAway_LendsNoColour_AndTheNearSideOfAThinBoxDoes) {
    TriangleMesh front = with(unit_square(0.02), column_of<u8>("colour", 3, std::vector<u8>(12, 200)));
    TriangleMesh both = front;  // the back, nearer to the points
    both.positions = {front.positions[0], front.positions[1], front.positions[2], front.positions[3],
                      Vec3(0, 0, 0),      Vec3(1, 0, 0),      Vec3(0, 1, 0),      Vec3(1, 1, 0)};
    both.triangles = {Triangle{4, 6, 5}, Triangle{5, 6, 7}, Triangle{0, 1, 2}, Triangle{1, 3, 2}};
    std::vector<u8> colours(12, 200);
    colours.resize(24, 50);
    both.vertex_columns = {};
    both.vertex_columns.add(column_of("colour", 3, colours));
    const PointCloud to =
        with(cloud_of({{0.3, 0.3, 0.001}, {0.6, 0.6, 0.001}}), column_of<double>("normal", 3, {0, 0, 2, 0, 0.1, 1}));
    EXPECT_THAT(numbers_in(carried(both, to, columns_within({"colour"}, 0.5)).result, "colour"), Each(200));

    TriangleMesh back = front;
    back.triangles = {Triangle{0, 2, 1}, Triangle{1, 2, 3}};
    Context context;
    const auto none = transfer(back, to, columns_within({"colour"}, 0.5), context);
    EXPECT_EQ(none.unknown, 2u);
    EXPECT_EQ(none.facing_away, 2u);
    EXPECT_THAT(doubts_of(context), ElementsAre(HasSubstr("2 of the 2 rows of `to` that are near `from` face away")));
}

TEST(Transfer, FromMesh_InterpolatesVertices_AndCopiesFacesAndNearestCorners) {
    TriangleMesh from = with(unit_square(), column_of<double>("height", 1, {0, 10, 20, 30}));
    from = with(from, column_of<std::int32_t>("view", 1, {4, 5, 6, 7}));
    from = with(from, column_of<u8>("colour", 3, {0, 0, 0, 255, 255, 255, 0, 0, 0, 9, 9, 9}));
    from.face_columns.add(column_of<u8>("part", 1, {8, 9}));
    from.face_columns.add(column_of<u8>("height", 1, {1, 1}));
    const PointCloud to = cloud_of({{0.5, 0, 1}, {0.25, 0.25, -1}, {0.9, 0.9, 0}, {0.5, 0.5, 0}});
    const auto result = carried(from, to, columns_within({"height", "view", "part", "colour"}, 2));
    EXPECT_THAT(numbers_in(result.result, "height"),
                ElementsAre(5, testing::DoubleNear(7.5, 1e-12), testing::DoubleNear(27, 1e-12), 15));
    EXPECT_THAT(numbers_in(result.result, "view"), ElementsAre(4, 4, 7, 4))
        << "the last is as near to row 0 as to 1 and 2";
    EXPECT_THAT(numbers_in(result.result, "part"), ElementsAre(8, 8, 9, 8));
    EXPECT_EQ(numbers_in(result.result, "colour").at(0), 188) << "half of the light";
    const auto nearest = carried(from, to, columns_within({"height"}, 2, Method::nearest));
    EXPECT_THAT(numbers_in(nearest.result, "height"), ElementsAre(0, 0, 30, 0));
}

TEST(Transfer, Directions_AreNormalised_AndNumbersKeepTypeAndLengthExponent) {
    PointCloud from = with(cloud_of({{-1, 0, 0}, {1, 0, 0}}), column_of<float>("normal", 3, {0, 0, 3, 0, 2, 0}));
    from = with(from, column_of<float>("bin-size", 1, {2, 4}).with_length_exponent(1));
    from = with(from, column_of<double>("gap", 1, {nan, 6}));
    from = with(from, column_of<double>("gaps", 1, {nan, nan}));
    const auto result = carried(from, cloud_of({{0, 0, 0}}), columns_within({"normal", "bin-size", "gap", "gaps"}, 2));
    const auto normal = numbers_in(result.result, "normal");
    EXPECT_NEAR(Vec3(normal[0], normal[1], normal[2]).norm(), 1, 1e-6);
    EXPECT_NEAR(normal[1] / normal[2], 2.0 / 3, 1e-6);
    const Column& size = *result.result.columns.find("bin-size");
    EXPECT_EQ(size.length_exponent(), 1);
    EXPECT_EQ(size.type(), ScalarType::float32);
    EXPECT_EQ(size.number(0), 3);
    EXPECT_THAT(numbers_in(result.result, "gap"), ElementsAre(6)) << "NaN is left out";
    EXPECT_TRUE(std::isnan(numbers_in(result.result, "gaps").at(0)));
}

TEST(Transfer, ScansWithoutColours_PassUnchanged_IfNoColumnIsNamed) {
    const TriangleMesh to = with(unit_square(), column_of<u8>("colour", 3, std::vector<u8>(12, 77)));
    Context context;
    const auto result = transfer(cloud_of({{0, 0, 0}}), to, {}, context);
    EXPECT_EQ(result.result.positions.data(), to.positions.data());
    EXPECT_EQ(result.result.vertex_columns, to.vertex_columns);
    EXPECT_EQ(result.transferred, 0u);
    EXPECT_EQ(context.metrics().find("transferred")->value, 0);
    EXPECT_THAT(sentences_of(context), IsEmpty());
}

TEST(Transfer, OriginsMayDiffer) {
    PointCloud from = with(cloud_of({{0, 0, 0}, {1, 0, 0}}), column_of<std::int32_t>("view", 1, {1, 2}));
    from.frame.origin = Vec3(1e6, 0, 0);
    PointCloud to = cloud_of({{0.25, 0, 0}, {1.25, 0, 0}});
    to.frame.origin = Vec3(1e6 - 0.125, 0, 0);
    EXPECT_THAT(numbers_in(carried(from, to, columns_within({"view"}, 1)).result, "view"), ElementsAre(1, 2));
    EXPECT_EQ(carried(from, to, columns_within({"view"}, 1)).result.frame, to.frame);
}

/// A sphere with a column of every type, in random order.
template <class Geometry>
Geometry many_columns(Geometry geometry, std::size_t rows) {
    Random random(3);
    std::vector<u8> colours;
    std::vector<std::uint16_t> words;
    std::vector<float> singles;
    std::vector<double> doubles;
    std::vector<std::int64_t> integers;
    for (std::size_t i = 0; i < rows; ++i) {
        for (int channel = 0; channel < 4; ++channel) {
            colours.push_back(static_cast<u8>(random.uniform(0, 256)));
            words.push_back(static_cast<std::uint16_t>(random.uniform(0, 65536)));
        }
        singles.push_back(static_cast<float>(random.uniform(-1, 1)));
        doubles.push_back(random.uniform(-1, 1));
        integers.push_back(static_cast<std::int64_t>(random.uniform(-1e15, 1e15)));
    }
    geometry = with(geometry, column_of("colour", 4, colours));
    geometry = with(geometry, column_of("colour16", 4, words));
    geometry = with(geometry, column_of("single", 1, singles));
    geometry = with(geometry, column_of("double", 1, doubles));
    return with(geometry, column_of("integer", 1, integers));
}
const std::vector<std::string> all_columns{"colour", "colour16", "single", "double", "integer"};

void expect_same_columns(const ColumnTable& result, const ColumnTable& from) {
    for (const Column& column : from) {
        ASSERT_TRUE(result.find(column.name()));
        EXPECT_EQ(*result.find(column.name()), column) << column.name();
    }
}

TEST(Transfer, ToItself_ChangesNothing) {
    const TriangleMesh sphere = geodesic_sphere(1.1, 12);
    const TriangleMesh mesh = many_columns(sphere, sphere.positions.size());
    for (const Method method : {Method::nearest, Method::blend}) {
        const auto result = carried(mesh, mesh, columns_within(all_columns, 0.1, method));
        EXPECT_EQ(result.transferred, mesh.positions.size());
        expect_same_columns(result.result.vertex_columns, mesh.vertex_columns);
    }
    const PointCloud points = many_columns(random_sphere(3000, 5), 3000);
    expect_same_columns(carried(points, points, columns_within(all_columns, 0.1, Method::nearest)).result.columns,
                        points.columns);
}

TEST(Transfer, OneColourEverywhere_StaysThatColour) {
    // Blended means of equal values are these values, for every type and byte.
    const PointCloud positions = random_sphere(500, 5), to = random_sphere(100, 6);
    for (const int code : {0, 1, 10, 11, 127, 128, 254, 255}) {
        PointCloud from = with(positions, column_of<u8>("colour", 3, std::vector<u8>(1500, static_cast<u8>(code))));
        from = with(from, column_of<double>("height", 1, std::vector<double>(500, 0.1 * code)));
        const auto result = carried(from, to, columns_within({"colour", "height"}, 1));
        EXPECT_THAT(numbers_in(result.result, "colour"), Each(code));
        EXPECT_THAT(numbers_in(result.result, "height"), Each(0.1 * code));
    }
}

TEST(Transfer, AnyNumberOfThreads_GivesTheSameBytes) {
    const PointCloud points = many_columns(random_sphere(4000, 5), 4000);
    const TriangleMesh sphere = geodesic_sphere(1.02, 15), mesh = many_columns(sphere, sphere.positions.size());
    const auto run = [&](unsigned threads, const auto& from, const auto& to) {
        Context context({{.threads = threads, .on_progress = {}, .is_cancelled = {}}, 0, {}, {}});
        return transfer(from, to, columns_within(all_columns, 0.1), context).result;
    };
    for (const unsigned threads : {2u, 7u}) {
        EXPECT_EQ(run(1, points, sphere).vertex_columns, run(threads, points, sphere).vertex_columns);
        EXPECT_EQ(run(1, mesh, points).columns, run(threads, mesh, points).columns);
    }
}

TEST(Transfer, ScaledAndMoved_GivesTheSameColours) {
    const PointCloud points = many_columns(random_sphere(2000, 5), 2000);
    const PointCloud to = random_sphere(500, 8);
    const auto moved = [](PointCloud cloud) {
        Array<Vec3> positions(cloud.size());
        for (std::size_t i = 0; i < cloud.size(); ++i) positions[i] = 3.7 * cloud.positions[i] + Vec3(9, -4, 2);
        cloud.positions = std::move(positions);
        return cloud;
    };
    const auto here = carried(points, to, columns_within({"colour", "integer"}, 0.2));
    const auto there = carried(moved(points), moved(to), columns_within({"colour", "integer"}, 0.2 * 3.7));
    EXPECT_EQ(here.transferred, there.transferred);
    EXPECT_EQ(*here.result.columns.find("colour"), *there.result.columns.find("colour"));
    EXPECT_EQ(*here.result.columns.find("integer"), *there.result.columns.find("integer"));
}

TEST(Transfer, Cancelled_Throws) {
    Context context({{.threads = 1, .on_progress = {}, .is_cancelled = [] { return true; }}, 0, {}, {}});
    const PointCloud points = many_columns(random_sphere(4000, 5), 4000);
    EXPECT_THROW(transfer(points, points, {}, context), Cancelled);
}

}  // namespace
}  // namespace scanmill::test
