// SPDX-License-Identifier: GPL-3.0-or-later
/// The motion of a frame in a list of motions.
#include "scanmill/data/transform.hpp"

#include <gmock/gmock.h>

#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

/// Motions that differ in their translation along x: 0, 1, 2 …
Transforms motions_from(std::initializer_list<std::string> frames) {
    Transforms transforms;
    for (const std::string& frame : frames) {
        RigidTransform motion;
        motion.from = frame;
        motion.to = "part";
        motion.translation.x() = static_cast<double>(transforms.motions.size());
        transforms.motions.push_back(motion);
    }
    return transforms;
}

std::string refusal(const Transforms& transforms, const std::string& frame) {
    const Error error = error_of([&] { transforms.motion_from(frame); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error.sentence();
}

TEST(Transforms, MotionFrom_FindsItByName) {
    const Transforms transforms = motions_from({"a", "b", ""});
    EXPECT_EQ(transforms.motion_from("a").translation.x(), 0);
    EXPECT_EQ(transforms.motion_from("b").translation.x(), 1);
}

TEST(Transforms, MotionFrom_TakesTheOnlyMotionForAnyFrame) {
    for (const char* frame : {"a", "b", ""}) EXPECT_EQ(motions_from({"a"}).motion_from(frame).from, "a");
    const Transforms converted = RigidTransform{};
    EXPECT_EQ(converted.motion_from("a").from, "");
}

TEST(Transforms, MotionFrom_NamesTheKnownFramesIfThereIsNone) {
    EXPECT_THAT(refusal(motions_from({"view1", "other"}), "view2"),
                AllOf(HasSubstr("'view2'"), HasSubstr("view1 and other"), HasSubstr("did you mean 'view1'?")));
    EXPECT_THAT(refusal(motions_from({"a", "b"}), ""), AllOf(HasSubstr("no name"), HasSubstr("a and b")));
    EXPECT_THAT(refusal(motions_from({"", ""}), "a"), HasSubstr("frames without a name"));
    EXPECT_THAT(refusal(motions_from({}), "a"), HasSubstr("no motion"));
}

TEST(Transforms, MotionFrom_RefusesFramesWithSeveral) {
    EXPECT_THAT(refusal(motions_from({"a", "b", "a"}), "a"), HasSubstr("2 motions start from the frame 'a'"));
}

TEST(Transforms, MotionFrom_HasTheReasonOfARefusedFrame) {
    for (Transforms transforms : {motions_from({"a", "b"}), motions_from({"a"}), motions_from({})}) {
        transforms.refused = {{"c", "slides along a plane"}};
        EXPECT_THAT(refusal(transforms, "c"), AllOf(HasSubstr("'c'"), HasSubstr("refused: slides along a plane")));
    }
}

}  // namespace
}  // namespace scanmill::test
