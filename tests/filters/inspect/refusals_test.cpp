// SPDX-License-Identifier: GPL-3.0-or-later
/// All refusals, doubts and warnings of inspect.
#include <gmock/gmock.h>

#include "filters/inspect/cases.hpp"
#include "support/doubts.hpp"
#include "support/numbers.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;

/// Sentence and hint.
template <class Scan>
std::string refusal(const Scan& scan, const TriangleMesh& nominal, const InspectParams& params = params_with()) {
    const Error error = error_of([&] { inspected(scan, nominal, params); });
    EXPECT_NE(error.hint(), "") << error.sentence();
    return error.sentence() + " / " + error.hint();
}

std::vector<std::string> sentences(const PointCloud& scan, const TriangleMesh& nominal,
                                   const InspectParams& params = params_with()) {
    Context context;
    inspect(scan, nominal, nullptr, params, context);
    return sentences_of(context);
}

PointCloud near_cube() { return cloud({{0.5, 0.5, 1.01}, {0.2, 0.5, 0.99}, {0.3, 0.3, 0}}); }

TEST(InspectRefusals, NominalWithoutSurface_IsRefused) {
    EXPECT_THAT(refusal(near_cube(), soup({{0, 0, 0}, {1, 0, 0}}, {})), HasSubstr("no triangles (2 vertices)"));
    EXPECT_THAT(refusal(near_cube(), soup({{0, 0, 0}, {1, 0, 0}, {2, 0, 0}}, {{0, 1, 2}})),
                HasSubstr("the only triangle of the nominal has no area"));
    EXPECT_THAT(refusal(near_cube(), soup({{0, 0, 0}}, {{0, 0, 0}, {0, 0, 0}})), HasSubstr("none of the 2 triangles"));
}

TEST(InspectRefusals, NotFinite_IsRefused) {
    EXPECT_THAT(refusal(cloud({{0, 0, 0}, {1, nan, 0}}), cube()), HasSubstr("1 of 2 points"));
    const TriangleMesh broken =
        with_positions(cube(), [](const Vec3& p) -> Vec3 { return p == Vec3(1, 1, 1) ? Vec3(1, infinity, 1) : p; });
    EXPECT_THAT(refusal(near_cube(), broken), HasSubstr("1 of 8 vertices of the nominal"));
    EXPECT_THAT(refusal(broken, cube()), HasSubstr("1 of 8 vertices"));
}

TEST(InspectRefusals, ScanWithoutPoints_IsRefused) {
    EXPECT_THAT(refusal(PointCloud(), cube()), HasSubstr("0 points"));
    EXPECT_THAT(refusal(soup({{0, 0, 0}}, {}), cube()), HasSubstr("no triangles"));
}

TEST(InspectRefusals, DifferentUnitsOrFrames_AreRefused) {
    PointCloud scan = near_cube();
    scan.frame.unit = LengthUnit::metre;
    TriangleMesh nominal = cube();
    nominal.frame.unit = LengthUnit::millimetre;
    EXPECT_THAT(refusal(scan, nominal), HasSubstr("the scan is in m, the nominal in mm"));
    scan.frame.unit = LengthUnit::millimetre;
    scan.frame.name = "scanner";
    nominal.frame.name = "part";
    EXPECT_THAT(refusal(scan, nominal), AllOf(HasSubstr("'scanner'"), HasSubstr("'part'")));
}

TEST(InspectRefusals, ToleranceUpsideDown_IsRefused) {
    EXPECT_THAT(refusal(near_cube(), cube(), params_with(0.1, -0.05)),
                AllOf(HasSubstr("begins at 0.1 u and ends at -0.05 u"), HasSubstr("tolerance: [-0.05 u, 0.1 u]")));
    EXPECT_EQ(inspected(near_cube(), cube(), params_with(0.1, 0.1)).numbers.below, 1) << "equal ends are a tolerance";
    EXPECT_THAT(refusal(near_cube(), cube(), params_with(-infinity, 1)), HasSubstr("must be finite"));
    EXPECT_THAT(refusal(near_cube(), cube(), params_with(nan, 1)), HasSubstr("must be finite"));
    InspectParams one = params_with();
    one.tolerance = {0.1};
    EXPECT_THAT(refusal(near_cube(), cube(), one), HasSubstr("tolerance has 1 length; it needs two"));
}

TEST(InspectRefusals, ParametersOutOfRange_AreRefused) {
    InspectParams params = params_with();
    params.bins = 0;
    EXPECT_THAT(refusal(near_cube(), cube(), params), HasSubstr("bins is 0"));
    params = params_with();
    params.sigma = 0;
    EXPECT_THAT(refusal(near_cube(), cube(), params), HasSubstr("sigma is 0"));
    params = params_with();
    params.label_distance = -1;
    EXPECT_THAT(refusal(near_cube(), cube(), params), HasSubstr("label-distance is -1 u"));
    params = params_with();
    params.chord_error = nan;
    EXPECT_THAT(refusal(near_cube(), cube(), params), HasSubstr("chord-error is nan u"));
    params = params_with();
    params.max_distance = 0;
    EXPECT_THAT(refusal(near_cube(), cube(), params), HasSubstr("max-distance is 0 u"));
}

TEST(InspectRefusals, NoPointLeft_NamesTheCountsAndTheWayOut) {
    InspectParams params = params_with();
    params.max_distance = 1;
    EXPECT_THAT(refusal(cloud({{0, 0, 8}, {1, 2.5, 9}}), cube(), params),
                AllOf(HasSubstr("2 farther than 1 u"), HasSubstr("(0, 0, 8) to (1, 2.5, 9)"),
                      HasSubstr("(0, 0, 0) to (1, 1, 1)"), HasSubstr("apply-transform"), Not(HasSubstr("as if"))));
    EXPECT_THAT(
        refusal(cloud({{0, 0, 8}, {1.5, 0.5, 0.2}}), rectangle(1, 1), params),
        AllOf(HasSubstr("1 farther than 1 u"), HasSubstr("1 beyond its border"), HasSubstr("borders: include")));
    EXPECT_THAT(refusal(cloud({{0.5, 0.5, 0.2}}),
                        soup({{0, 0, 0}, {1, 1, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 2, 1}, {0, 3, 1}}), params),
                AllOf(HasSubstr("1 where its triangles do not decide"), HasSubstr("repair")));
    params.sigma = 0.5;
    EXPECT_THAT(refusal(cloud({{0.5, 0.5, 1.2}, {0.5, 0.5, 0.8}}), cube(), params),
                AllOf(HasSubstr("2 cut by sigma"), HasSubstr("sigma above 0.5")));
}

TEST(InspectRefusals, ScanInAnotherUnit_IsNamed) {
    InspectParams params = params_with();
    params.max_distance = 1;
    const auto scan_of = [](double scale, double shift) {
        return vertices_of(shifted(scaled(cube(), scale), {shift, shift, shift}));
    };
    EXPECT_THAT(refusal(scan_of(0.001, 5), cube(), params),
                AllOf(HasSubstr("the nominal is 1000 times as large"), HasSubstr("in mm and the scan in m"),
                      HasSubstr("`unit:`")));
    EXPECT_THAT(refusal(scan_of(25.4, 50), cube(), params),
                AllOf(HasSubstr("the scan is 25.4 times as large"), HasSubstr("in mm and the nominal in in")));
    EXPECT_THAT(refusal(scan_of(10, 50), cube(), params), HasSubstr("in mm and the nominal in cm"));
}

TEST(InspectDoubts, InsideOutNominal_IsDoubted) {
    EXPECT_THAT(sentences(near_cube(), inside_out(cube())), ElementsAre(HasSubstr("inside out")));
    EXPECT_THAT(sentences(near_cube(), cube()), IsEmpty());
}

TEST(InspectDoubts, InconsistentNominal_IsDoubtedWithTheNumberOfEdges) {
    TriangleMesh mesh = cube();
    Array<Triangle> triangles(mesh.triangles.begin(), mesh.triangles.end());
    std::swap(triangles[0][0], triangles[0][1]);
    mesh.triangles = std::move(triangles);
    EXPECT_THAT(sentences(near_cube(), mesh), ElementsAre(HasSubstr("3 edges")));
}

TEST(InspectDoubts, MostPointsTooFar_AreDoubted) {
    InspectParams params = params_with();
    params.max_distance = 0.5;
    EXPECT_THAT(sentences(cloud({{0.5, 0.5, 1}, {0.5, 0.5, 3}, {0.5, 0.5, 4}}), cube(), params),
                ElementsAre(HasSubstr("2 of 3 points are farther than 0.5 u")));
    EXPECT_THAT(sentences(cloud({{0.5, 0.5, 1}, {0.5, 0.4, 1}, {0.5, 0.5, 4}}), cube(), params), IsEmpty());
}

TEST(InspectDoubts, ChordErrorAboveATenthOfTheTolerance_IsWarnedOf) {
    InspectParams params = params_with(-0.1, 0.1);
    params.chord_error = 0.019;
    EXPECT_THAT(sentences(near_cube(), cube(), params), IsEmpty());
    params.chord_error = 0.05;
    EXPECT_THAT(sentences(near_cube(), cube(), params),
                ElementsAre(AllOf(HasSubstr("0.05 u"), HasSubstr("25 %"), HasSubstr("0.2 u"))));
}

}  // namespace
}  // namespace scanmill::test
