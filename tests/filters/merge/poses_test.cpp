// SPDX-License-Identifier: GPL-3.0-or-later
/// Assigning the poses in a file to scans.
#include <gmock/gmock.h>

#include "filters/merge/cases.hpp"
#include "merge/scan_poses.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

std::vector<Frame> frames(std::initializer_list<std::string> names) {
    std::vector<Frame> result;
    for (const std::string& name : names) result.push_back({LengthUnit::unknown, Vec3::Zero(), name});
    return result;
}

/// Poses that differ in their translation along x: 0, 1, 2 …
std::vector<ScanPose> poses(std::initializer_list<std::string> scans) {
    std::vector<ScanPose> result;
    for (const std::string& scan : scans) {
        ScanPose pose{scan, {}};
        pose.transform.translation.x() = static_cast<double>(result.size());
        result.push_back(pose);
    }
    return result;
}

std::vector<double> assigned(const std::vector<Frame>& of, const std::vector<ScanPose>& from, Context& context) {
    std::vector<double> result;
    for (const RigidTransform& pose : merging::poses_of(of, from, context)) result.push_back(pose.translation.x());
    return result;
}

TEST(PosesOf, FramesWithoutNames_UseThemInOrder) {
    Context context;
    EXPECT_THAT(assigned(frames({"", ""}), poses({"b.ply", "a.ply"}), context), ElementsAre(0, 1));
    EXPECT_EQ(sentence_of([&] {
                  assigned(frames({"", ""}), poses({"a", "b", "c"}), context);
              }),
              "there are 3 poses for 2 inputs; inputs whose frames have no name use the poses in order");
}

TEST(PosesOf, FramesWithNames_UseTheirOwnInAnyOrder) {
    Context context;
    EXPECT_THAT(assigned(frames({"a", "b", "c.d"}), poses({"raw/b.ply", "c.d", "a"}), context), ElementsAre(2, 0, 1));
    EXPECT_THAT(assigned(frames({"b.ply"}), poses({"raw/b.ply"}), context), ElementsAre(0));
    EXPECT_THAT(context.warnings(), IsEmpty());
}

TEST(PosesOf, InputsInOneFrame_UseOnePose_WithAWarning) {
    Context context;
    EXPECT_THAT(assigned(frames({"a", "b", "a"}), poses({"b", "a.ply"}), context), ElementsAre(1, 0, 1));
    EXPECT_THAT(context.warnings(),
                ElementsAre("inputs 0 and 2 are both in the frame 'a' and use the same pose, that of 'a.ply'"));
}

TEST(PosesOf, NamedFramesAndPosesWithoutScans_AreRefusedWithAHint) {
    Context context;
    const Error error = error_of([&] { assigned(frames({"a"}), poses({"", ""}), context); });
    EXPECT_EQ(error.sentence(),
              "the frames of the inputs have names, such as 'a', but none of the 2 poses names its scan");
    EXPECT_THAT(error.hint(), HasSubstr("\"scan\""));
}

TEST(PosesOf, UnusedPoses_AreReported) {
    Context context;
    EXPECT_THAT(assigned(frames({"b"}), poses({"a.ply", "b.ply", "c.ply"}), context), ElementsAre(1));
    EXPECT_THAT(context.warnings(), ElementsAre("2 of 3 poses match no input: a.ply and c.ply"));
}

TEST(PosesOf, FrameWithoutOrWithSeveralPoses_IsRefused) {
    Context context;
    EXPECT_THAT(
        sentence_of([&] {
            assigned(frames({"a", "view1"}), poses({"a.ply", "view2"}), context);
        }),
        AllOf(HasSubstr("no pose for input 1, whose frame is called 'view1'"), HasSubstr("did you mean 'view2'?")));
    EXPECT_THAT(sentence_of([&] {
                    assigned(frames({"a"}), poses({"a.ply", "b/a.xyz"}), context);
                }),
                HasSubstr("there are 2 poses for input 0"));
    EXPECT_THAT(sentence_of([&] {
                    assigned(frames({"a", ""}), poses({"a.ply", "b.ply"}), context);
                }),
                HasSubstr("the frame of input 0 is called 'a', that of input 1 has no name"));
}

}  // namespace
}  // namespace scanmill::test
