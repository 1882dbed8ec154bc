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

/// The translations along x; -1 for refused scans.
std::vector<double> assigned(const std::vector<Frame>& of, const std::vector<ScanPose>& from, Context& context) {
    std::vector<double> result;
    for (const auto& pose : merging::poses_of(of, from, context)) result.push_back(pose ? pose->translation.x() : -1);
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

TEST(PosesOf, RefusedScans_HaveNone_WithAWarning) {
    std::vector<ScanPose> from = poses({"a.ply", "b.ply", "c.ply", "d.ply"});
    from[1].refused = "no-overlap";
    from[3].refused = "slides";
    Context context;
    EXPECT_THAT(assigned(frames({"b", "c", "a"}), from, context), ElementsAre(-1, 2, 0));
    EXPECT_THAT(context.warnings(),
                ElementsAre(AllOf(HasSubstr("1 of 3 inputs is left out"), HasSubstr("input 0 'b' (no-overlap)")),
                            "1 of 4 poses match no input: d.ply"));
}

TEST(PosesOf, RefusedScansAlone_AreRefusedWithTheirReasons) {
    std::vector<ScanPose> from = poses({"a", "b"});
    from[0].refused = "no-overlap";
    from[1].refused = "slides";
    Context context;
    const Error error = error_of([&] { assigned(frames({"a", "b"}), from, context); });
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("all 2 inputs"), HasSubstr("'a' (no-overlap) and input 1 'b'")));
    EXPECT_FALSE(error.hint().empty());
}

TEST(PosesOf, RefusedScansAndFramesWithoutNames_AreRefused) {
    std::vector<ScanPose> from = poses({"a", "b"});
    from[1].refused = "no-overlap";
    Context context;
    const Error error = error_of([&] { assigned(frames({"", ""}), from, context); });
    EXPECT_THAT(error.sentence(), AllOf(HasSubstr("'b'"), HasSubstr("no names")));
    EXPECT_THAT(error.hint(), HasSubstr("{stem}"));
}

/// Three clouds of one point at the origin, in the frames a, b and c.
std::vector<std::shared_ptr<const PointCloud>> three_clouds() {
    std::vector<std::shared_ptr<const PointCloud>> result;
    for (const Frame& frame : frames({"a", "b", "c"}))
        result.push_back(std::make_shared<const PointCloud>(PointCloud{frame, Buffer<Vec3>{Vec3::Zero()}, {}}));
    return result;
}

TEST(Place, ATransform_LeavesRefusedInputsOut_AndTheOthersKeepTheirNumbers) {
    Transforms transforms;
    for (const char* from : {"c", "a"}) {
        RigidTransform motion;
        motion.from = from;
        motion.to = "part";
        motion.translation.x() = from[0] == 'c' ? 3 : 1;
        transforms.motions.push_back(motion);
    }
    transforms.refused = {{"b", "no-overlap"}};
    auto clouds = three_clouds();
    MergeParams params;
    Context context;
    merging::place(clouds, params, merging::scan_poses_of(transforms), context);
    ASSERT_EQ(clouds.size(), 2u);
    EXPECT_THAT(params.numbers, ElementsAre(0, 2));
    const PointCloud points = merge(clouds, params, context).points;
    EXPECT_EQ(points.frame.name, "part");
    EXPECT_EQ(points.frame.origin + points.positions[0], Vec3(1, 0, 0));
    EXPECT_EQ(points.frame.origin + points.positions[1], Vec3(3, 0, 0));
    EXPECT_EQ(points.columns.find("source")->number(0), 0);
    EXPECT_EQ(points.columns.find("source")->number(1), 2);
    EXPECT_THAT(context.warnings(), ElementsAre(HasSubstr("input 1 'b' (no-overlap)")));
}

TEST(Place, NumbersOfInputs_AreThoseInMessages) {
    auto clouds = three_clouds();
    clouds.erase(clouds.begin());
    clouds[1] = std::make_shared<const PointCloud>();
    MergeParams params;
    params.numbers = {1, 2};
    Context context;
    EXPECT_EQ(sentence_of([&] { merge(clouds, params, context); }), "input 2 of 3 has no points");
    params.numbers = {2, 2};
    EXPECT_THAT(sentence_of([&] { merge(clouds, params, context); }), HasSubstr("ascend"));
}

TEST(Place, ATransformWithoutAMotionOfAnInput_IsRefused) {
    auto clouds = three_clouds();
    MergeParams params;
    Context context;
    RigidTransform motion;
    motion.from = "a";
    EXPECT_THAT(sentence_of([&] { merging::place(clouds, params, merging::scan_poses_of(motion), context); }),
                HasSubstr("no pose for input 1, whose frame is called 'b'"));
}

}  // namespace
}  // namespace scanmill::test
