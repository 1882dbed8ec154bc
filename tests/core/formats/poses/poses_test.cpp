// SPDX-License-Identifier: GPL-3.0-or-later
/// Files of poses: both formats, and errors in them.
#include "scanmill/formats/poses/poses.hpp"

#include <gmock/gmock.h>

#include <Eigen/LU>

#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using ::testing::AllOf;
using ::testing::ContainsRegex;
using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class PoseFiles : public testing::Test {
protected:
    std::vector<ScanPose> read(const std::string& content, const std::string& name = "p.conf") {
        return read_poses(folder_.write(name, content), warn_);
    }
    Error refusal(const std::string& content) {
        return error_of([&] { read(content); });
    }
    std::string sentence(const std::string& content) {
        const std::string whole = refusal(content).sentence();
        const std::string path = "'" + (folder_ / "p.conf").string() + "': ";
        EXPECT_TRUE(whole.starts_with(path)) << whole;
        return whole.substr(std::min(path.size(), whole.size()));
    }
    static std::string json(const std::string& pose) { return "{\"scanmill\": 1, \"poses\": [" + pose + "]}"; }

    TemporaryFolder folder_;
    std::vector<std::string> warnings_;
    OnPoseWarning warn_ = [this](std::string sentence) { warnings_.push_back(std::move(sentence)); };
};

bool near(const Vec3& a, const Vec3& b) { return (a - b).norm() < 1e-15; }

// 0.6 and 0.8: a turn about z by an angle with the cosine 2 * 0.64 - 1 = 0.28 and the sine 2 * 0.6 * 0.8 = 0.96.
TEST_F(PoseFiles, Conf_TurnsAgainstItsQuaternion) {
    const auto poses =
        read("camera 1 2 3 0 0 0 1\n\nbmesh a.ply 1 2 3 0 0 0.6 0.8 # a comment\nmesh b.ply 0 0 0 0 0 0 1\n");
    ASSERT_EQ(poses.size(), 2u);
    EXPECT_EQ(poses[0].scan, "a.ply");
    EXPECT_EQ(poses[1].scan, "b.ply");
    EXPECT_TRUE(near(poses[0].transform.apply(Vec3(1, 0, 0)), Vec3(1 + 0.28, 2 - 0.96, 3)));
    EXPECT_EQ(poses[1].transform.apply(Vec3(5, 6, 7)), Vec3(5, 6, 7));
    EXPECT_EQ(poses[0].transform.unit, LengthUnit::unknown);
    EXPECT_THAT(warnings_, IsEmpty());
}

TEST_F(PoseFiles, ByteOrderMark_IsNoPartOfThem) {
    EXPECT_EQ(read("\xEF\xBB\xBFmesh b.ply 0 0 0 0 0 0 1\n").size(), 1u);
    EXPECT_EQ(read("\xEF\xBB\xBF" + json("{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0]}")).size(), 1u);
}

TEST_F(PoseFiles, JsonOfAnyDepth_IsRefusedWhereItIsTooDeep) {
    for (const std::size_t depth : {20u, 1'000'000u})
        EXPECT_THAT(sentence("{\"poses\": " + std::string(depth, '[') + std::string(depth, ']') + "}"),
                    HasSubstr("16 levels"));
}

TEST_F(PoseFiles, Json_TurnsWithItsQuaternion) {
    const auto poses = read(
        "\n {\"scanmill\": 1, \"unit\": \"mm\", \"frame\": \"part\", \"poses\": [{\"scan\": \"a\", \"rotation\": "
        "[0, 0, 0.6, 0.8], \"translation\": [1, 2, 3]}, {\"rotation\": [0, 0, 0, -1], \"translation\": [0, 0, 4e1]}]}");
    ASSERT_EQ(poses.size(), 2u);
    EXPECT_TRUE(near(poses[0].transform.apply(Vec3(1, 0, 0)), Vec3(1 + 0.28, 2 + 0.96, 3)));
    EXPECT_EQ(poses[1].transform.apply(Vec3(1, 2, 3)), Vec3(1, 2, 43)) << "a quaternion and its negative are one turn";
    EXPECT_EQ(poses[0].transform.unit, LengthUnit::millimetre);
    EXPECT_EQ(poses[0].transform.to, "part");
    EXPECT_THAT(poses[1].scan, IsEmpty());
}

TEST_F(PoseFiles, Rotations_AreOrthonormalAlthoughDigitsAreFew) {
    const Eigen::Matrix3d r = read("bmesh a 0 0 0 0.00548449 -0.294635 -0.0038555 0.955586\n")[0].transform.rotation;
    EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
    EXPECT_NEAR(r.determinant(), 1, 1e-15);
    EXPECT_THAT(warnings_, IsEmpty()) << "such files have six digits";
}

TEST_F(PoseFiles, QuaternionOfFourDigits_IsScaledAndReported) {
    const auto poses = read("\nbmesh a 0 0 0 0 0 0.6004 0.8\n");
    EXPECT_NEAR(poses[0].transform.rotation.determinant(), 1, 1e-15);
    EXPECT_THAT(warnings_, ElementsAre(AllOf(HasSubstr("p.conf': line 2: the quaternion has the length 1.00024"),
                                             EndsWith("was scaled to 1"))));
}

TEST_F(PoseFiles, QuaternionOfAnotherLength_IsRefused) {
    EXPECT_THAT(sentence("camera\nbmesh a 0 0 0 0 0 0 2\n"),
                HasSubstr("line 2: the quaternion 0 0 0 2 has the length 2"));
    EXPECT_THAT(sentence("bmesh a 0 0 0 0 0 0 0\n"), HasSubstr("has the length 0"));
    EXPECT_THAT(refusal("bmesh a 0 0 0 0 0 0 0.9\n").hint(), HasSubstr("qx qy qz qw"));
    EXPECT_THAT(sentence(json("{\"rotation\": [1, 1, 0, 0], \"translation\": [0, 0, 0]}")),
                HasSubstr("pose 1: the quaternion 1 1 0 0 has the length 1.41421"));
}

TEST_F(PoseFiles, BadConf_NamesTheLine) {
    const std::string good = "camera 0 0 0 0 0 0 1\nbmesh a.ply 0 0 0 0 0 0 1\n";
    EXPECT_THAT(sentence(good + "bmseh b.ply 0 0 0 0 0 0 1\n"),
                ContainsRegex("line 3: 'bmseh'.* camera, mesh and bmesh.* mean 'bmesh'"));
    EXPECT_THAT(sentence(good + "\nbmesh\n"), ContainsRegex("line 4: 'bmesh'.* name"));
    EXPECT_THAT(sentence(good + "bmesh b.ply 0 0 0 0 0 1\n"),
                ContainsRegex("line 3: 6 .*'b.ply'.* 7 .*tx ty tz qx qy qz qw"));
    EXPECT_THAT(sentence(good + "bmesh b.ply 0 0 0 0 0 0 1 0\n"), HasSubstr("line 3: 8 words"));
    EXPECT_THAT(sentence(good + "bmesh b.ply 0 1,5 0 0 0 0 1\n"), ContainsRegex("line 3: '1,5' .* ty of 'b.ply'"));
    EXPECT_THAT(sentence(good + "bmesh b.ply 0 0 0 nan 0 0 1\n"), ContainsRegex("line 3: qx of 'b.ply'.* nan"));
    EXPECT_THAT(sentence("camera 0 0 0 0 0 0 1\n"), HasSubstr("holds no pose"));
}

TEST_F(PoseFiles, BadJson_NamesThePlace) {
    EXPECT_EQ(sentence("{\"scanmill\": 1,\n\"poses\": [}\n"), "line 2: invalid JSON");
    EXPECT_THAT(sentence("[]"), HasSubstr("expected an object with \"scanmill\": 1"));
    EXPECT_THAT(sentence("{\"poses\": []}"), HasSubstr("with \"scanmill\": 1"));
    EXPECT_THAT(sentence("{\"scanmill\": 2, \"poses\": []}"), HasSubstr("with \"scanmill\": 1"));
    EXPECT_THAT(sentence("{\"scanmill\": 1, \"poses\": []}"), HasSubstr("contains no pose"));
    EXPECT_THAT(sentence("{\"scanmill\": 1, \"poses\": {}}"), HasSubstr("'poses' is not a list"));
    EXPECT_THAT(sentence("{\"scanmill\": 1, \"unit\": \"mil\", \"poses\": []}"),
                AllOf(HasSubstr("unknown unit 'mil'"), HasSubstr("um, mm, cm")));
    EXPECT_THAT(sentence("{\"scanmill\": 1, \"unit\": 1, \"poses\": []}"), HasSubstr("'unit' is not a text"));
    EXPECT_THAT(sentence("{\"scanmill\": 1, \"pose\": []}"), HasSubstr("did you mean 'poses'?"));
    EXPECT_THAT(sentence(json("7")), HasSubstr("'poses[0]' is not an object"));
    const std::string good = "{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0]}";
    EXPECT_THAT(sentence(json(good + ", {\"rotation\": [0, 0, 1], \"translation\": [0, 0, 0]}")),
                HasSubstr("'poses[1].rotation' is not a list of 4"));
    EXPECT_THAT(sentence(json("{\"rotation\": [0, 0, 0, 1]}")), HasSubstr("pose 1: 'translation' is missing"));
    EXPECT_THAT(sentence(json("{\"rotation\": [0, 0, 0, 1], \"translation\": [0, \"0\", 0]}")),
                HasSubstr("'poses[0].translation[1]' is not a number"));
    EXPECT_THAT(sentence(json("{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 1e999, 0]}")),
                HasSubstr("contains a number that is too large"));
    EXPECT_THAT(sentence(json("{\"scan\": 1, \"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0]}")),
                HasSubstr("'poses[0].scan' is not a text"));
    EXPECT_THAT(sentence(json("{\"rotation\": [0, 0, 0, 1], \"rotation\": [1, 0, 0, 0], \"translation\": [0, 0, 0]}")),
                HasSubstr("the key 'rotation' is twice"));
}

TEST_F(PoseFiles, MissingEmptyOrFolder_IsRefusedWithItsPath) {
    EXPECT_THAT(sentence_of([&] { read_poses(folder_ / "absent.conf", warn_); }),
                HasSubstr("absent.conf': there is no such file"));
    EXPECT_THAT(sentence(""), HasSubstr("empty"));
    EXPECT_THAT(sentence_of([&] { read_poses(folder_.path(), warn_); }), HasSubstr("is a folder"));
}

TEST_F(PoseFiles, JsonMatrix_IsTheSameMotionAsQuaternionAndTranslation) {
    const RigidTransform written =
        read(json("{\"matrix\": [[0.28, -0.96, 0, 1], [0.96, 0.28, 0, 2], [0, 0, 1, 3], [0, 0, 0, 1]]}"))[0].transform;
    const RigidTransform turned =
        read(json("{\"rotation\": [0, 0, 0.6, 0.8], \"translation\": [1, 2, 3]}"))[0].transform;
    EXPECT_LT((written.rotation - turned.rotation).norm(), 1e-15);
    EXPECT_EQ(written.translation, turned.translation);
}

TEST_F(PoseFiles, JsonMatrixOfSevenDigits_IsMadeOrthonormal) {
    const Eigen::Matrix3d r =
        read(json("{\"matrix\": [[0.8660254, -0.5, 0, 0], [0.5, 0.8660254, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]]}"))[0]
            .transform.rotation;
    EXPECT_LT((r * r.transpose() - Eigen::Matrix3d::Identity()).norm(), 1e-15);
    EXPECT_NEAR(r(0, 0), std::sqrt(0.75), 1e-7);
}

TEST_F(PoseFiles, Rms_IsKept) {
    const std::vector<ScanPose> poses =
        read(json("{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0], \"rms\": 0.125}, "
                  "{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0], \"rms\": 0}, "
                  "{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0]}"));
    ASSERT_EQ(poses.size(), 3u);
    EXPECT_EQ(poses[0].transform.rms, 0.125);
    EXPECT_EQ(poses[1].transform.rms, 0.0);
    EXPECT_EQ(poses[2].transform.rms, std::nullopt);
}

TEST_F(PoseFiles, NegativeRms_IsRefusedWithItsPose) {
    EXPECT_EQ(sentence(json("{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0]}, "
                            "{\"rotation\": [0, 0, 0, 1], \"translation\": [0, 0, 0], \"rms\": -0.5}")),
              "pose 2: 'rms' is -0.5; expected a length of at least 0");
}

TEST_F(PoseFiles, JsonMatrixThatIsNoMotion_IsRefusedWithWhatItIs) {
    const auto matrix = [&](const std::string& rows) { return sentence(json("{\"matrix\": [" + rows + "]}")); };
    EXPECT_THAT(matrix("[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0]"), HasSubstr("'poses[0].matrix' is not a list of 4"));
    EXPECT_THAT(matrix("[1, 0, 0, 0], [0, 1, 0], [0, 0, 1, 0], [0, 0, 0, 1]"),
                HasSubstr("'poses[0].matrix[1]' is not a list of 4"));
    EXPECT_EQ(matrix("[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [5, 6, 7, 1]"),
              "pose 1: the last row of the matrix is 5 6 7 1; expected 0 0 0 1");
    EXPECT_THAT(matrix("[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, -1, 0], [0, 0, 0, 1]"), HasSubstr("is a reflection"));
    EXPECT_THAT(matrix("[2, 0, 0, 0], [0, 2, 0, 0], [0, 0, 2, 0], [0, 0, 0, 1]"), HasSubstr("scales by 2"));
    EXPECT_THAT(matrix("[1, 0.1, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]"), HasSubstr("is not a rotation"));
    EXPECT_THAT(matrix("[0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 0], [0, 0, 0, 1]"), HasSubstr("is not a rotation"));
    EXPECT_THAT(
        sentence(
            json("{\"matrix\": [[1, 0, 0, 0], [0, 1, 0, 0], [0, 0, 1, 0], [0, 0, 0, 1]], \"rotation\": [0, 0, 0, 1]}")),
        HasSubstr("has a matrix and 'rotation'"));
}

}  // namespace
}  // namespace scanmill::test
