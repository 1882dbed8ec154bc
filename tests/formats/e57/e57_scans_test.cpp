// SPDX-License-Identifier: GPL-3.0-or-later
// Scans of E57 files: coordinates, poses, columns and views.
#include <cmath>
#include <numbers>

#include "core/formats/support.hpp"
#include "formats/e57/e57_files.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<Vec3> worlds(const PointCloud& cloud) {
    std::vector<Vec3> points;
    for (std::size_t row = 0; row < cloud.size(); ++row) points.push_back(world_of(cloud, row));
    return points;
}

std::shared_ptr<const PointCloud> view_of(const std::string& file, u32 view, Warnings* warnings = nullptr) {
    ReadOptions options = warnings ? warnings->reading() : ReadOptions{};
    options.view = view;
    return read_bytes(file, "a.e57", options).value.get<PointCloud>();
}

/// Half a turn about z, then a shift: (x, y, z) goes to (10 - x, 20 - y, z + 30).
const E57Pose half_turn{{0, 0, 0, 1}, {10, 20, 30}};

TEST(E57Reader, OneScan_HasItsPointsInMetres_WithoutWarnings) {
    Warnings warnings;
    const auto cloud = points_in(e57_file({{cartesian({{1, 2, 3}, {4, 5, 6}})}}), "a.dat", &warnings);
    EXPECT_THAT(worlds(*cloud), ElementsAre(Vec3(1, 2, 3), Vec3(4, 5, 6)));
    EXPECT_EQ(cloud->frame.unit, LengthUnit::metre);
    EXPECT_TRUE(cloud->columns.empty());
    EXPECT_THAT(warnings.sentences, IsEmpty());
}

TEST(E57Reader, Pose_TurnsAndThenMoves) {
    E57Scan scan{cartesian({{1, 2, 3}}), half_turn};
    EXPECT_THAT(worlds(*points_in(e57_file({scan}), "a.e57")), ElementsAre(Vec3(9, 18, 33)));
    // A quarter turn about z maps x to y.
    const double half = std::sqrt(0.5);
    scan.pose = E57Pose{{half, 0, 0, half}, {0, 0, 0}};
    const auto turned = worlds(*points_in(e57_file({scan}), "a.e57"));
    EXPECT_LT((turned.at(0) - Vec3(-2, 1, 3)).norm(), 1e-15);
}

TEST(E57Reader, Translation_FarAway_KeepsMicrometres) {
    const E57Scan scan{cartesian({{0.000001, 0, 0}, {0.000003, 0, 0}}), E57Pose{{1, 0, 0, 0}, {5e5, 4e6, 0}}};
    const auto cloud = points_in(e57_file({scan}), "a.e57");
    EXPECT_NEAR(world_of(*cloud, 0).x(), 5e5 + 0.000001, 1e-10);
    EXPECT_GT(cloud->frame.origin.norm(), 1e6);
}

TEST(E57Reader, SeveralScans_BecomeOneCloud_WithTheirNumbers) {
    Warnings warnings;
    const std::string file = e57_file({{cartesian({{1, 2, 3}})}, {cartesian({{1, 2, 3}, {0, 0, 0}}), half_turn}});
    const auto cloud = points_in(file, "a.e57", &warnings);
    EXPECT_THAT(worlds(*cloud), ElementsAre(Vec3(1, 2, 3), Vec3(9, 18, 33), Vec3(10, 20, 30)));
    EXPECT_THAT(numbers_of<u32>(cloud->columns.find("scan")), ElementsAre(0, 1, 1));
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("2 scans were read as one cloud")));
}

TEST(E57Reader, View_IsOneScanAlone) {
    Warnings warnings;
    const std::string file = e57_file({{cartesian({{1, 2, 3}})}, {cartesian({{1, 2, 3}}), half_turn}});
    EXPECT_THAT(worlds(*view_of(file, 1, &warnings)), ElementsAre(Vec3(1, 2, 3)));
    EXPECT_THAT(worlds(*view_of(file, 2, &warnings)), ElementsAre(Vec3(9, 18, 33)));
    EXPECT_EQ(view_of(file, 2)->columns.find("scan"), nullptr);
    EXPECT_THAT(warnings.sentences, IsEmpty());
    try {
        view_of(file, 3);
        ADD_FAILURE() << "a scan that the file does not have";
    } catch (const Error& error) {
        EXPECT_THAT(error.sentence(), HasSubstr("has no scan 3; it has 2 scans"));
    }
}

TEST(E57Reader, SphericalCoordinates_FollowTheStandard) {
    const double pi = std::numbers::pi;
    const E57Scan scan{{reals("sphericalRange", {2, 3, 1}), reals("sphericalAzimuth", {pi / 2, 0, 1.5 * pi}),
                        reals("sphericalElevation", {pi / 6, -pi / 2, 0})},
                       E57Pose{{1, 0, 0, 0}, {100, 0, 0}}};
    const auto cloud = points_in(e57_file({scan}), "a.e57");
    const auto points = worlds(*cloud);
    EXPECT_LT((points.at(0) - Vec3(100, std::sqrt(3.0), 1)).norm(), 1e-13);
    EXPECT_LT((points.at(1) - Vec3(100, 0, -3)).norm(), 1e-13);
    EXPECT_LT((points.at(2) - Vec3(100, -1, 0)).norm(), 1e-13) << "an azimuth beyond a half turn";
    const auto directions = numbers_of<float>(cloud->columns.find("approach"));
    ASSERT_EQ(directions.size(), 9u);
    EXPECT_NEAR(directions[1], -std::sqrt(3.0) / 2, 1e-6);
    EXPECT_NEAR(directions[5], 1, 1e-6) << "the scanner is above the second point";
}

TEST(E57Reader, SphericalCoordinatesOutOfRange_AreRefused) {
    const auto file = [](double range, double elevation) {
        return e57_file({{{reals("sphericalRange", {1, range}), reals("sphericalAzimuth", {0, 0}),
                           reals("sphericalElevation", {0, elevation})}}});
    };
    EXPECT_THAT(refusal_of(file(1, 45), "a.e57"), HasSubstr("elevation 45; elevations are angles in radians"));
    EXPECT_THAT(refusal_of(file(-2, 0), "a.e57"), HasSubstr("the range -2 m"));
}

TEST(E57Reader, Approach_IsTurnedByThePose_AndNeedsAGrid) {
    E57Scan scan{cartesian({{2, 0, 0}}), half_turn};
    EXPECT_EQ(points_in(e57_file({scan}), "a.e57")->columns.find("approach"), nullptr);
    scan.fields.push_back(integers("rowIndex", 0, 300, {7}));
    scan.fields.push_back(integers("columnIndex", 0, 70000, {65536}));
    const auto cloud = points_in(e57_file({scan}), "a.e57");
    EXPECT_THAT(numbers_of<float>(cloud->columns.find("approach")), ElementsAre(1, 0, 0));
    EXPECT_THAT(numbers_of<std::uint16_t>(cloud->columns.find("row_index")), ElementsAre(7));
    EXPECT_THAT(numbers_of<u32>(cloud->columns.find("column_index")), ElementsAre(65536));
}

TEST(E57Reader, InvalidPoints_AreLeftOutAndCounted) {
    Warnings warnings;
    E57Scan scan{cartesian({{1, 0, 0}, {2, 0, 0}, {3, 0, 0}})};
    scan.fields.push_back(integers("cartesianInvalidState", 0, 2, {0, 1, 2}));
    scan.fields.push_back(reals("intensity", {0.5, 0.6, 0.7}));
    const auto cloud = points_in(e57_file({scan}), "a.e57", &warnings);
    EXPECT_THAT(worlds(*cloud), ElementsAre(Vec3(1, 0, 0)));
    EXPECT_THAT(numbers_of<double>(cloud->columns.find("intensity")), ElementsAre(0.5));
    EXPECT_EQ(cloud->columns.size(), 1u);
    EXPECT_THAT(warnings.sentences, ElementsAre(HasSubstr("2 of 3 points were left out")));

    E57Scan spherical{{reals("sphericalRange", {1, 1}), reals("sphericalAzimuth", {0, 0}),
                       reals("sphericalElevation", {0, 0}), integers("sphericalInvalidState", 0, 2, {1, 0})}};
    EXPECT_EQ(points_in(e57_file({spherical}), "a.e57")->size(), 1u);
    spherical.fields[3].values = {1, 2};
    EXPECT_THAT(refusal_of(e57_file({spherical}), "a.e57"), HasSubstr("no valid points: all 2"));
}

TEST(E57Reader, FlagsOfOtherValues_AreKept_OnlyIfSet) {
    Warnings warnings;
    E57Scan scan{cartesian({{1, 0, 0}, {2, 0, 0}})};
    scan.fields.push_back(integers("intensity", 0, 255, {9, 8}));
    scan.fields.push_back(integers("isIntensityInvalid", 0, 1, {0, 1}));
    scan.fields.push_back(integers("isColorInvalid", 0, 1, {0, 0}));
    const auto cloud = points_in(e57_file({scan}), "a.e57", &warnings);
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("intensity")), ElementsAre(9, 8));
    EXPECT_THAT(numbers_of<u8>(cloud->columns.find("intensity_invalid")), ElementsAre(0, 1));
    EXPECT_EQ(cloud->columns.find("colour_invalid"), nullptr);
    EXPECT_THAT(warnings.sentences, ElementsAre(AllOf(HasSubstr("1 point is"), HasSubstr("'intensity_invalid'"))));
}

E57Scan coloured(E57Field::Type type, double high, std::vector<double> values) {
    E57Scan scan{cartesian({{1, 0, 0}})};
    for (std::size_t i = 0; i < 3; ++i)
        scan.fields.push_back({i == 0 ? "colorRed" : i == 1 ? "colorGreen" : "colorBlue", type, {values[i]}, 0, high});
    return scan;
}

TEST(E57Reader, Colours_AreBytesWhereTheLimitsAllowIt) {
    using enum E57Field::Type;
    EXPECT_THAT(
        numbers_of<u8>(points_in(e57_file({coloured(integer, 255, {1, 2, 255})}), "a.e57")->columns.find("colour")),
        ElementsAre(1, 2, 255));
    EXPECT_THAT(
        numbers_of<std::uint16_t>(
            points_in(e57_file({coloured(integer, 65535, {1, 256, 65535})}), "a.e57")->columns.find("colour16")),
        ElementsAre(1, 256, 65535));
    EXPECT_THAT(
        numbers_of<u8>(points_in(e57_file({coloured(real32, 0, {0, 0.5, 1})}), "a.e57")->columns.find("colour")),
        ElementsAre(0, 128, 255));
    E57Scan limited = coloured(real64, 0, {-5, 100, 1000});
    for (const char* channel : {"colorRed", "colorGreen", "colorBlue"}) {
        limited.limits.emplace_back("colorLimits", std::string(channel) + "Minimum", 0);
        limited.limits.emplace_back("colorLimits", std::string(channel) + "Maximum", 200);
    }
    EXPECT_THAT(numbers_of<u8>(points_in(e57_file({limited}), "a.e57")->columns.find("colour")),
                ElementsAre(0, 128, 255))
        << "values outside of the limits are clamped";
}

TEST(E57Reader, ColoursOfTenAndTwelveBits_AreScaledTo16) {
    const auto colours_of = [](E57Scan scan, double limit) {
        for (const char* channel : {"colorRed", "colorGreen", "colorBlue"})
            if (limit > 0) scan.limits.emplace_back("colorLimits", std::string(channel) + "Maximum", limit);
        return numbers_of<std::uint16_t>(points_in(e57_file({scan}), "a.e57")->columns.find("colour16"));
    };
    using enum E57Field::Type;
    EXPECT_THAT(colours_of(coloured(integer, 65535, {0, 2048, 4095}), 4095), ElementsAre(0, 32776, 65535))
        << "the limits count, not the range of the field";
    EXPECT_THAT(colours_of(coloured(integer, 1023, {0, 1, 1023}), 0), ElementsAre(0, 64, 65535));
    EXPECT_THAT(colours_of(coloured(integer, 65535, {0, 5000, 3000}), 3000), ElementsAre(0, 65535, 48011))
        << "limits of the scan's values have 12 bits, too";
    EXPECT_THAT(colours_of(coloured(integer, 65535, {0, 300, 60000}), 60000), ElementsAre(0, 300, 60000));
}

TEST(E57Reader, ScaledNumbers_AreScaled_AndLimitsAreComments) {
    E57Scan scan{{{"cartesianX", E57Field::Type::scaled, {1500}, -100000, 100000, 0.001, 5},
                  reals("cartesianY", {0}),
                  {"cartesianZ", E57Field::Type::real32, {0.25}},
                  {"intensity", E57Field::Type::scaled, {7}, 0, 100, 0.5, 0},
                  reals("timeStamp", {12.5})}};
    scan.name = "station 1";
    scan.limits = {{"intensityLimits", "intensityMinimum", 0}, {"intensityLimits", "intensityMaximum", 50}};
    const LoadedFile loaded = read_bytes(e57_file({scan}), "a.e57");
    const PointCloud& cloud = *loaded.value.get<PointCloud>();
    EXPECT_LT((world_of(cloud, 0) - Vec3(6.5, 0, 0.25)).norm(), 1e-15);
    EXPECT_THAT(numbers_of<double>(cloud.columns.find("intensity")), ElementsAre(3.5));
    EXPECT_THAT(numbers_of<double>(cloud.columns.find("time_stamp")), ElementsAre(12.5));
    EXPECT_THAT(loaded.comments, ElementsAre("scan 1 is station 1", "scan 1 intensity limits 0 50"));
    EXPECT_EQ(loaded.format, "E57");
}

TEST(E57Reader, Normals_AreTurnedByThePose) {
    E57Scan scan{cartesian({{1, 0, 0}}), half_turn};
    scan.fields.push_back(reals("nor:normalX", {1}));
    scan.fields.push_back(reals("nor:normalY", {0}));
    scan.fields.push_back(reals("nor:normalZ", {0}));
    EXPECT_THAT(numbers_of<double>(points_in(e57_file({scan}), "a.e57")->columns.find("normal")),
                ElementsAre(-1, 0, 0));
}

TEST(E57Reader, ColumnsOfSomeScans_AreLeftOut_AndTypesAreWidened) {
    Warnings warnings;
    E57Scan one{cartesian({{1, 0, 0}})}, two{cartesian({{2, 0, 0}})};
    one.fields.push_back(integers("intensity", 0, 255, {200}));
    two.fields.push_back(integers("intensity", -100, 100, {-1}));
    two.fields.push_back(integers("returnCount", 0, 5, {1}));
    two.fields.push_back({"note", E57Field::Type::text, {0}});
    const auto cloud = points_in(e57_file({one, two}), "a.e57", &warnings);
    EXPECT_THAT(numbers_of<std::int16_t>(cloud->columns.find("intensity")), ElementsAre(200, -1));
    EXPECT_EQ(cloud->columns.find("return_count"), nullptr);
    EXPECT_THAT(warnings.sentences, Contains(HasSubstr("'return_count' was left out: 1 of 2 scans")));
    EXPECT_THAT(warnings.sentences, Contains(HasSubstr("the texts of the field 'note' of scan 2")));
}

TEST(E57Reader, BlocksOfPoints_KeepTheirOrder) {
    constexpr int count = 200'001;  // more than three blocks
    E57Scan scan{{reals("cartesianX", {}), reals("cartesianY", {}), reals("cartesianZ", {}),
                  integers("returnIndex", 0, count, {})}};
    for (int i = 0; i < count; ++i) {
        scan.fields[0].values.push_back(i);
        scan.fields[1].values.push_back(0.5 * i);
        scan.fields[2].values.push_back(-i);
        scan.fields[3].values.push_back(i);
    }
    const auto cloud = points_in(e57_file({scan}), "a.e57");
    ASSERT_EQ(cloud->size(), std::size_t(count));
    const auto numbers = numbers_of<u32>(cloud->columns.find("return_index"));
    for (int i = 0; i < count; ++i) {
        ASSERT_EQ(world_of(*cloud, std::size_t(i)), Vec3(i, 0.5 * i, -i));
        ASSERT_EQ(numbers[std::size_t(i)], u32(i));
    }
}

TEST(E57Reader, Images_AreCountedInAWarning_AndEmptyScansToo) {
    Warnings warnings;
    const std::string file = e57_file({{cartesian({{1, 0, 0}})}, {cartesian({})}}, 3);
    EXPECT_EQ(points_in(file, "a.e57", &warnings)->size(), 1u);
    EXPECT_THAT(warnings.sentences, Contains(HasSubstr("3 images were left out")));
    EXPECT_THAT(warnings.sentences, Contains(HasSubstr("scan 2 has no points")));
}

}  // namespace
}  // namespace scanmill::test
