// SPDX-License-Identifier: GPL-3.0-or-later
/// All refusals of measure, and unusual input that it accepts.
#include <gmock/gmock.h>

#include <limits>

#include "filters/measure/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

template <class Truth>
std::string refusal(const TriangleMesh& mesh, const Truth& truth, const MeasureParams& params = few_samples()) {
    const Error error = error_of([&] { measured(mesh, truth, params); });
    EXPECT_NE(error.hint(), "") << error.sentence();
    return error.sentence();
}

std::vector<std::string> warnings_of(const TriangleMesh& mesh, const TriangleMesh& truth) {
    Context context;
    measure(mesh, truth, few_samples(), context);
    return context.warnings();
}

TriangleMesh in_unit(TriangleMesh mesh, LengthUnit unit) {
    mesh.frame.unit = unit;
    return mesh;
}

/// Edges of 2, 3 and 5: turned, it does not look like a scaled one.
TriangleMesh brick(double scale = 1) {
    return with_positions(cube(), [&](const Vec3& p) -> Vec3 { return scale * p.cwiseProduct(Vec3(2, 3, 5)); });
}

TEST(MeasureRefusals, NoTriangles_AreRefused) {
    const TriangleMesh none = soup({{0, 0, 0}, {1, 0, 0}}, {});
    EXPECT_EQ(refusal(none, cube()), "the mesh has no triangles (2 vertices); there is no surface to measure");
    EXPECT_EQ(refusal(cube(), none), "the truth has no triangles (2 vertices); there is no surface to measure");
    EXPECT_EQ(refusal(none, cloud_of({{0, 0, 0}})),
              "the mesh has no triangles (2 vertices); there is no surface to measure");
    EXPECT_EQ(refusal(cube(), PointCloud{}), "the truth has no points; there is nothing to measure the mesh against");
}

TEST(MeasureRefusals, NotFinite_IsRefusedNamingTheSurface) {
    const double nan = std::numeric_limits<double>::quiet_NaN();
    const TriangleMesh broken =
        with_positions(cube(), [&](const Vec3& p) -> Vec3 { return p == Vec3(1, 1, 1) ? Vec3(1, nan, 1) : p; });
    EXPECT_THAT(refusal(broken, cube()), HasSubstr("vertices of the mesh"));
    EXPECT_THAT(refusal(cube(), broken), HasSubstr("vertices of the truth"));
    EXPECT_THAT(refusal(cube(), cloud_of({{0, 0, 0}, {1, nan, 0}})), HasSubstr("points of the truth"));
}

TEST(MeasureRefusals, NoArea_IsRefused) {
    const TriangleMesh line = soup({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}});
    EXPECT_EQ(refusal(line, line), "the only triangle of the mesh has no area; there is no surface to measure");
    EXPECT_THAT(refusal(soup({{1, 1, 1}}, {{0, 0, 0}}), cube()),
                HasSubstr("the only triangle of the mesh has no area"));
}

TEST(MeasureRefusals, IndexOutOfRange_IsRefused) {
    const TriangleMesh broken = soup({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}});
    EXPECT_EQ(sentence_of([&] { measured(broken, cube()); }), "triangle 0 names vertex 3; there are 3");
}

TEST(MeasureRefusals, FewSamples_AreRefused) {
    MeasureParams params;
    params.samples = 31;
    EXPECT_EQ(refusal(cube(), cube(), params), "samples is 31; the standard error of the mean needs at least 32");
}

TEST(MeasureRefusals, ThresholdNotAboveZero_IsRefused) {
    for (double threshold :
         {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
        MeasureParams params = few_samples();
        params.thresholds = {0.1, threshold};
        EXPECT_THAT(refusal(cube(), cube(), params), HasSubstr("thresholds must be above 0"));
    }
}

TEST(MeasureRefusals, GapOfZeroOrAll_IsRefused) {
    EXPECT_THAT(refusal(cube(), cube(), certified(0)), HasSubstr("above 0 % and below 100 %"));
    EXPECT_THAT(refusal(cube(), cube(), certified(100)), HasSubstr("above 0 % and below 100 %"));
}

TEST(MeasureRefusals, CertifyAgainstPoints_IsRefused) {
    EXPECT_THAT(refusal(cube(), vertices_of(cube()), certified()), HasSubstr("the truth is 8 points"));
}

TEST(MeasureFrames, DifferentNames_AreRefused) {
    TriangleMesh part = cube(), machine = cube();
    part.frame.name = "part";
    machine.frame.name = "machine";
    EXPECT_EQ(refusal(part, machine), "the mesh is in the frame 'part', the truth in the frame 'machine'");
    EXPECT_EQ(measured(part, part, few_samples()).hausdorff, 0.0);
    EXPECT_EQ(measured(part, cube(), few_samples()).hausdorff, 0.0);  // one without a name is taken as the same
}

TEST(MeasureFrames, DeclaredUnits_AreConverted) {
    // 25.4 mm are 1 inch; all numbers are in the mesh's unit.
    const TriangleMesh inches = in_unit(brick(), LengthUnit::inch);
    const TriangleMesh millimetres = in_unit(shifted(brick(25.4), {2.54, 0, 0}), LengthUnit::millimetre);
    EXPECT_NEAR(*measured(inches, millimetres).hausdorff, 0.1, 1e-12);
    EXPECT_NEAR(*measured(millimetres, inches).hausdorff, 2.54, 1e-12);
    EXPECT_NEAR(measured(inches, millimetres).truth->area, 62, 1e-9);
}

TEST(MeasureFrames, DifferentOrigins_ArePartOfThePositions) {
    TriangleMesh here = shifted(brick(), {-1000, 0, 0}), there = brick();
    here.frame.origin = Vec3(1000, 0, 0);
    EXPECT_EQ(*measured(here, there, few_samples()).hausdorff, 0);
    there.frame.origin = Vec3(0, 0, 0.5);
    EXPECT_NEAR(*measured(here, there, few_samples()).hausdorff, 0.5, 1e-12);
    // In two units: an origin of 1 m is one of 1000 mm.
    TriangleMesh metres = in_unit(brick(1e-3), LengthUnit::metre),
                 millimetres = in_unit(shifted(brick(), {-1000, 0, 0}), LengthUnit::millimetre);
    millimetres.frame.origin = Vec3(2000, 0, 0);
    metres.frame.origin = Vec3(1, 0, 0);
    EXPECT_NEAR(*measured(millimetres, metres, few_samples()).hausdorff, 0, 1e-12);
}

TEST(MeasureFrames, AnotherUnit_IsNoticedBySize) {
    EXPECT_EQ(
        refusal(brick(), brick(25.4)),
        "the mesh is 2 x 3 x 5 u, the truth 50.8 x 76.2 x 127 u: one is 25.4 times as large as the other in every "
        "direction, as if the truth were in mm and the mesh in in");
    EXPECT_THAT(refusal(brick(), brick(0.001)), HasSubstr("as if the mesh were in mm and the truth in m"));
    EXPECT_THAT(refusal(brick(10.2), brick()), HasSubstr("as if the mesh were in mm and the truth in cm"));
    EXPECT_THAT(refusal(brick(2.54), brick()), HasSubstr("as if the mesh were in cm and the truth in in"));
    // Turned, and against points.
    EXPECT_THAT(refusal(turned(brick(1000), std::numbers::pi / 2, Vec3::UnitX()), brick()), HasSubstr("in mm and"));
    EXPECT_THAT(refusal(brick(), vertices_of(brick(100))), HasSubstr("as if the truth were in cm and the mesh in m"));
}

TEST(MeasureFrames, AnotherSize_IsMeasuredWithAWarning) {
    EXPECT_THAT(warnings_of(brick(), brick(1.9)), IsEmpty());
    EXPECT_THAT(warnings_of(brick(), brick(5)), ElementsAre(HasSubstr("the diagonals differ by a factor of 5;")));
    // Ten times as long in one direction alone: a part of an object, not another unit.
    const TriangleMesh bar =
        with_positions(cube(), [](const Vec3& p) -> Vec3 { return p.cwiseProduct(Vec3(1, 1, 10)); });
    EXPECT_THAT(warnings_of(cube(), bar), ElementsAre(HasSubstr("compared as they are")));
    EXPECT_THAT(refusal(brick(), brick(35)), HasSubstr("the truth is more than 30 times as large"));
    EXPECT_THAT(refusal(brick(), vertices_of(brick(35))), HasSubstr("the truth is more than 30 times as large"));
}

TEST(MeasureFrames, KnownToBeTheSame_AreMeasuredWithAWarning) {
    MeasureParams params = few_samples();
    params.same_frame = true;
    Context context;
    const Measurement tenth = measure(brick(), brick(10), params, context);
    EXPECT_GT(*tenth.hausdorff, 1);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("measured anyway because of same-frame: true")));
}

TEST(MeasureFrames, AnotherPosition_IsRefused) {
    const std::string apart = refusal(shifted(cube(), {0, 7, 0}), cube());
    for (const char* part : {"(0, 7, 0) to (1, 8, 1)", "(0, 0, 0) to (1, 1, 1)", "6 u apart", "not in one frame"})
        EXPECT_THAT(apart, testing::HasSubstr(part));
    // A small gap, as between two sheets, is measured.
    EXPECT_NEAR(*measured(rectangle(1, 1), rectangle(1, 1, 0.1), few_samples()).hausdorff, 0.1, 1e-15);
    EXPECT_THAT(refusal(rectangle(1, 1), rectangle(1, 1, 0.2)), HasSubstr("not in one frame"));
}

TEST(MeasureFrames, EveryRefusal_NamesAWayOut) {
    EXPECT_THAT(error_of([] { measured(brick(), brick(10)); }).hint(), HasSubstr("`unit:`"));
    EXPECT_THAT(error_of([] { measured(brick(), brick(77)); }).hint(), HasSubstr("`unit:`"));
    EXPECT_THAT(error_of([] { measured(brick(), shifted(brick(), {9, 9, 9})); }).hint(), HasSubstr("pose"));
}

}  // namespace
}  // namespace scanmill::test
