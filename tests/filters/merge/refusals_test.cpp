// SPDX-License-Identifier: GPL-3.0-or-later
/// Refusals of merge, except those of pose files, which are in merge_poses_test.cpp.
#include <gmock/gmock.h>

#include <limits>

#include "filters/merge/cases.hpp"
#include "support/poses.hpp"
#include "support/shapes.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;

const double infinity = std::numeric_limits<double>::infinity();
const double nan = std::numeric_limits<double>::quiet_NaN();

Error refusal(const Clouds& clouds, const MergeParams& params = {}) {
    return error_of([&] { merged(clouds, params); });
}

PointCloud in_unit(LengthUnit unit) {
    PointCloud cloud = cloud_of({{0, 0, 0}});
    cloud.frame.unit = unit;
    return cloud;
}

const PointCloud point = in_unit(LengthUnit::unknown);

TEST(MergeRefusals, NoInputs_AreRefused) { EXPECT_THAT(refusal({}).sentence(), HasSubstr("at least one")); }

TEST(MergeRefusals, InputWithoutPoints_IsNamed) {
    EXPECT_EQ(refusal({point, PointCloud{}}).sentence(), "input 1 of 2 has no points");
}

TEST(MergeRefusals, NotFinite_IsRefusedWithRowAndInput) {
    const Error error = refusal({point, cloud_of({{0, 0, 0}, {0, nan, 0}})});
    EXPECT_THAT(error.what(), AllOf(HasSubstr("1 of 2 points"), HasSubstr("in input 1 of 2")));
    EXPECT_THAT(refusal({cloud_of({{0, 0, -infinity}})}).what(), HasSubstr("in input 0 of 1"));
}

TEST(MergeRefusals, DifferentUnits_AreBothNamedWithAHint) {
    const Error error =
        refusal({in_unit(LengthUnit::millimetre), in_unit(LengthUnit::millimetre), in_unit(LengthUnit::metre)});
    EXPECT_EQ(error.sentence(), "the inputs have different units: mm in input 0, m in input 2");
    EXPECT_EQ(error.hint(), "convert one of them");
    EXPECT_EQ(error.remedy(), Remedy::convert_unit);
}

TEST(MergeRefusals, KnownAndUnknownUnit_AreDifferent) {
    const Error error = refusal({point, in_unit(LengthUnit::inch)});
    EXPECT_EQ(error.sentence(), "the inputs have different units: an unknown unit in input 0, in in input 1");
    EXPECT_THAT(error.hint(), HasSubstr("`unit: mm`"));
    EXPECT_THAT(refusal({in_unit(LengthUnit::inch), point}).hint(), HasSubstr("`unit: mm`"));
}

TEST(MergeRefusals, DistanceBelowZeroOrInfinite_IsRefused) {
    EXPECT_THAT(refusal({point}, within(-1)).sentence(), HasSubstr("-1 u; it must be 0 or more"));
    EXPECT_THAT(refusal({point}, within(nan)).sentence(), HasSubstr("0 or more"));
    EXPECT_THAT(refusal({point}, within(infinity)).sentence(), HasSubstr("0 or more"));
    MergeParams relative;
    relative.within = Length::spacings(1);
    EXPECT_THAT(refusal({point}, relative).sentence(), HasSubstr("not resolved"));
}

TEST(MergeRefusals, AnotherNumberOfPoses_NamesBoth) {
    EXPECT_EQ(refusal({point, point}, posed({RigidTransform{}})).sentence(),
              "there is 1 pose for 2 inputs; every input needs one pose");
}

TEST(MergeRefusals, PosesInAUnitThatTheScansLack_AreRefusedWithAHint) {
    RigidTransform pose;
    pose.unit = LengthUnit::metre;
    const Error error = refusal({point}, posed({pose}));
    EXPECT_THAT(error.sentence(), HasSubstr("the pose is in m; the unit of the scan is not declared"));
    EXPECT_THAT(error.hint(), HasSubstr("unit: mm"));
    EXPECT_EQ(error.remedy(), Remedy::declare_unit);
}

TEST(MergeRefusals, PosesThatMoveCloudsTooFarApart_AreRefused) {
    RigidTransform pose;
    for (const double far : {2e9, 1.7e308}) {
        pose.translation = Vec3(far, 0, 0);
        const Error error = refusal({point, point}, posed({pose, inverse_of(pose)}));
        EXPECT_THAT(error.sentence(), HasSubstr("at most 1e+09 u is supported")) << far;
        EXPECT_THAT(error.what(), AllOf(HasSubstr("after the clouds were moved"), HasSubstr("hint: check the poses")));
    }
    pose.translation = Vec3(4.9e8, 0, 0);
    EXPECT_EQ(merged({point, point}, posed({pose, inverse_of(pose)})).points.size(), 2u);
}

TEST(MergeRefusals, DefaultUncertaintyBelowZeroOrNotFinite_IsRefused) {
    for (const double value : {-1.0, nan, infinity}) {
        MergeParams params;
        params.default_uncertainty = Length(value);
        EXPECT_THAT(refusal({point}, params).sentence(), HasSubstr("default-uncertainty is")) << value;
    }
}

TEST(MergeRefusals, MissingUncertainty_IsNamed) {
    const MergeParams params = within(1, MergeParams::Prefer::lower_uncertainty);
    const PointCloud with = with_uncertainty(cloud_of({{0, 0, 0}}), {1});
    const Error error = refusal({with, point}, params);
    EXPECT_THAT(error.sentence(), HasSubstr("input 1 of 2 has no column 'uncertainty'"));
    EXPECT_THAT(error.hint(), AllOf(HasSubstr("default-uncertainty"), HasSubstr("prefer: none")));
    PointCloud wide = cloud_of({{0, 0, 0}});
    wide.columns.add(Column("uncertainty", 2, Buffer<float>{1, 2}));
    EXPECT_THAT(refusal({wide}, params).sentence(), HasSubstr("with one number per point"));
    EXPECT_EQ(merged({point, with}, within(1)).dropped, 1u) << "it is not needed here";
}

TEST(MergeRefusals, InvalidUncertainty_IsReportedWithItsPoint) {
    const MergeParams params = within(1, MergeParams::Prefer::lower_uncertainty);
    const PointCloud unknown =
        with_uncertainty(cloud_of({{0, 0, 0}, {1, 0, 0}}), {1, std::numeric_limits<float>::quiet_NaN()});
    EXPECT_EQ(refusal({unknown}, params).sentence(), "an uncertainty must be 0 or more; point 1 of input 0 has nan");
    const PointCloud negative = with_uncertainty(cloud_of({{0, 0, 0}}), {-1});
    EXPECT_THAT(refusal({unknown, negative}, params).sentence(), HasSubstr("input 0 has nan"));
    EXPECT_THAT(refusal({negative}, params).sentence(), HasSubstr("has -1"));
}

}  // namespace
}  // namespace scanmill::test
