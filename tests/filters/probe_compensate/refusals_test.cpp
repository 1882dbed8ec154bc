// SPDX-License-Identifier: GPL-3.0-or-later
/// Input that probe-compensate refuses.

#include <gmock/gmock.h>

#include <limits>

#include "filters/probe_compensate/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
constexpr double nan = std::numeric_limits<double>::quiet_NaN();

std::string refusal(const PointCloud& cloud, const ProbeCompensateParams& params = with_radius(2)) {
    const Error error = error_of([&] { compensated(cloud, params); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error.sentence();
}
std::string refusal(const std::vector<Touch>& touches, const ProbeCompensateParams& params = with_radius(2)) {
    return refusal(cloud_of(touches), params);
}

/// A pair that is accepted.
std::vector<Touch> pair() { return {touch_of({0, 0, 0}, 0.3, 0, 2, 6, 1), touch_of({0, 0, 0}, -0.3, 0, 2, 6, 1)}; }

TEST(ProbeCompensateRefusals, Lengths) {
    EXPECT_THAT(refusal(pair(), with_radius(0)), HasSubstr("radius is 0 u; it must be above 0"));
    EXPECT_THAT(refusal(pair(), with_radius(-2)), HasSubstr("radius is -2 u"));
    EXPECT_THAT(refusal(pair(), with_radius(nan)), HasSubstr("radius is nan u"));
    EXPECT_THAT(refusal(pair(), with_radius(2, -1)), HasSubstr("scanner-error is -1 u; it must be 0 or more"));
    ProbeCompensateParams params = with_radius(2);
    params.spacing = 0;
    EXPECT_THAT(refusal(pair(), params), HasSubstr("spacing is 0 u; it must be above 0"));
}

TEST(ProbeCompensateRefusals, NoPoints_AndPointsThatAreNotFinite) {
    EXPECT_THAT(refusal(std::vector<Touch>{}), HasSubstr("0 points"));
    std::vector<Touch> touches = pair();
    touches[1].position.y() = nan;
    EXPECT_THAT(refusal(touches), HasSubstr("1 of 2"));
}

TEST(ProbeCompensateRefusals, NoUnitVectorsInApproach) {
    PointCloud bare;
    bare.positions = {{0, 0, 0}};
    EXPECT_THAT(refusal(bare), HasSubstr("no column 'approach'"));
    bare.columns.add(Column("approach", 1, Buffer<double>{1}));
    EXPECT_THAT(refusal(bare), HasSubstr("three numbers per point"));
    std::vector<Touch> touches = pair();
    touches[1].approach *= 1.5;
    EXPECT_THAT(refusal(touches), AllOf(HasSubstr("row 1"), HasSubstr("the length 1.5")));
    touches[1].approach = {0, nan, 1};
    EXPECT_THAT(refusal(touches), AllOf(HasSubstr("row 1"), HasSubstr("nan")));
}

TEST(ProbeCompensateRefusals, NumbersThatAreNone) {
    for (double Touch::*field : {&Touch::touch, &Touch::feature, &Touch::uncertainty}) {
        std::vector<Touch> touches = pair();
        touches[1].*field = nan;
        EXPECT_THAT(refusal(touches), HasSubstr("has nan in row 1"));
    }
    std::vector<Touch> touches = pair();
    touches[0].uncertainty = -0.1;
    EXPECT_THAT(refusal(touches), AllOf(HasSubstr("row 0"), HasSubstr("-0.1")));
    PointCloud wide = cloud_of(pair(), Columns::approach_only);
    wide.columns.add(Column("touch", 2, Buffer<u32>{1, 2, 3, 4}));
    EXPECT_THAT(refusal(wide), HasSubstr("the column 'touch' has 2 numbers per point"));
}

TEST(ProbeCompensateRefusals, OneTouchOfTwoFeatures) {
    std::vector<Touch> touches = pair();
    touches[1].feature = 4;
    EXPECT_THAT(refusal(touches), AllOf(HasSubstr("touch 6 is of feature 1 in row 0 and of feature 4 in row 1")));
}

TEST(ProbeCompensateRefusals, BallsThatDoNotMeet) {
    // Centres 5 apart; the diameter is 4.
    std::vector<Touch> touches = pair();
    ProbeCompensateParams params = with_radius(2);
    params.reported = ProbeCompensateParams::Reported::centre;
    touches[0].position = {3, 0, 0};
    touches[1].position = {0, 0, 4};
    EXPECT_THAT(refusal(touches, params),
                AllOf(HasSubstr("rows 0 and 1"), HasSubstr("5 u apart, 1 u more than the diameter of 4 u")));
    touches[0].position = {0, 4.5, 0};
    touches[1].position = {0, 0, 0.1};
    EXPECT_THAT(refusal(touches, params), HasSubstr("do not meet")) << "apart along the edge";
}

TEST(ProbeCompensateRefusals, CirclesThatFixNoPoint) {
    ProbeCompensateParams params = with_radius(2);
    params.reported = ProbeCompensateParams::Reported::centre;
    std::vector<Touch> touches = pair();
    touches[0].position = touches[1].position = {1, 2, 3};
    EXPECT_THAT(refusal(touches, params), AllOf(HasSubstr("rows 0 and 1"), HasSubstr("fix no point")));
    touches[0].position = {1, 2, 4};  // along the mean of the approaches: both intersections are equally far from them
    EXPECT_THAT(refusal(touches, params), HasSubstr("fix no point"));
}

TEST(ProbeCompensateRefusals, OppositeApproaches) {
    std::vector<Touch> touches = pair();
    touches[1].approach = -touches[0].approach;
    EXPECT_THAT(refusal(touches), AllOf(HasSubstr("rows 0 and 1"), HasSubstr("180 deg apart")));
}

}  // namespace
}  // namespace scanmill::test
