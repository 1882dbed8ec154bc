// SPDX-License-Identifier: GPL-3.0-or-later
/// What align refuses, with numbers and a way out.

#include <gmock/gmock.h>

#include <limits>

#include "filters/align/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

Error refusal(const PointCloud& source, const PointCloud& target, const AlignParams& params = {},
              const std::optional<AlignPart>& part = {}) {
    const Error error = error_of([&] { aligned(source, target, params, part); });
    EXPECT_FALSE(error.hint().empty()) << error.sentence();
    return error;
}

TEST(AlignRefusals, DifferentCounts_AreNamed) {
    EXPECT_EQ(refusal(cloud(plate()), cloud({{0, 0, 0}})).sentence(),
              "the source has 4 points and the target 1 point; each point needs a partner");
}

TEST(AlignRefusals, TooFewPairs_AreCounted) {
    EXPECT_EQ(refusal(cloud({{0, 0, 0}, {1, 0, 0}}), cloud({{0, 0, 0}, {1, 0, 0}})).sentence(),
              "there are 2 pairs of points; a motion needs at least 3 that are not on a line");
    EXPECT_THAT(refusal({}, {}).sentence(), HasSubstr("there are 0 pairs"));
}

TEST(AlignRefusals, ThreePairsOnALine_AreRefused) {
    const std::vector<Vec3> line{{0, 0, 0}, {1, 2, 3}, {3, 6, 9}};
    EXPECT_THAT(refusal(cloud(line), cloud(line)).sentence(),
                HasSubstr("the 3 pairs determine the rotation only to more than 57 deg; 1 deg is needed"));
    std::vector<Vec3> bent = line;
    bent[1].x() += 0.001;
    EXPECT_THAT(refusal(cloud(line), cloud(bent)).sentence(), HasSubstr("u RMS from one line, and the residuals are"));
    EXPECT_THAT(refusal(cloud({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}), cloud({{1, 1, 1}, {1, 1, 1}, {1, 1, 1}})).sentence(),
                HasSubstr("more than 57 deg"));
    // Also of rounded coordinates, and of the target alone.
    Random random(1);
    for (int trial = 0; trial < 100; ++trial) {
        const std::vector<Vec3> turned = moved(line, random_motion(random));
        EXPECT_THAT(refusal(cloud(line), cloud(turned)).sentence(), HasSubstr("determine the rotation only"));
    }
}

TEST(AlignRefusals, PairsOnALineWithNoise_AreRefused) {
    Random random(2);
    for (const std::size_t count : {3u, 4u}) {
        int refused = 0;
        constexpr int trials = 2000;
        for (int trial = 0; trial < trials; ++trial) {
            std::vector<Vec3> line;
            for (std::size_t i = 0; i < count; ++i) line.emplace_back(200.0 * double(i) / double(count - 1), 0, 0);
            const double sigma = std::pow(10.0, random.uniform(-3, 0));
            try {
                aligned(cloud(with_noise(line, sigma, random)),
                        cloud(with_noise(moved(line, random_motion(random)), sigma, random)));
            } catch (const Error&) {
                ++refused;
            }
        }
        EXPECT_GE(refused, 0.999 * trials) << count;
    }
}

TEST(AlignRefusals, AWrongUnit_IsNamedBeforeTheRotation) {
    Random random(4);
    for (const auto& [scale, text] :
         {std::pair(0.001, "the target is 0.001 times as large as the source: the residuals are 116.5 u RMS, and "),
          std::pair(1000.0,
                    "the target is 1000 times as large as the source: the residuals are 1.165e+05 u RMS, and ")}) {
        std::vector<Vec3> scaled = plate();
        for (Vec3& p : scaled) p *= scale;
        EXPECT_THAT(refusal(cloud(plate()), cloud(moved(scaled, random_motion(random, 1)))).sentence(),
                    testing::StartsWith(text));
    }
    // A line stays a line in another unit.
    const std::vector<Vec3> line{{0, 0, 0}, {1, 2, 3}, {3, 6, 9}}, metres{{0, 0, 0}, {1e3, 2e3, 3e3}, {3e3, 6e3, 9e3}};
    EXPECT_THAT(refusal(cloud(line), cloud(metres)).sentence(), HasSubstr("determine the rotation only"));
}

TEST(AlignRefusals, AMirrorImage_IsRefused) {
    std::vector<Vec3> solid = plate(), mirrored;
    solid.emplace_back(0, 0, 50);
    for (const Vec3& p : solid) mirrored.emplace_back(-p.x(), p.y(), p.z());
    EXPECT_THAT(refusal(cloud(solid), cloud(mirrored)).sentence(),
                HasSubstr("the target is a mirror image of the source: residuals are"));
    Random random(3);
    EXPECT_THAT(refusal(cloud(solid), cloud(with_noise(mirrored, 0.1, random))).sentence(), HasSubstr("mirror image"));
}

TEST(AlignRefusals, APlateUpsideDown_IsRefusedWhereNormalsShowIt) {
    PointCloud source = cloud(plate());
    source.columns.add(Column("normal", 3, Buffer<double>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}));
    PointCloud target = cloud({plate()[1], plate()[0], plate()[3], plate()[2]});
    target.columns = source.columns;
    EXPECT_THAT(refusal(source, target).sentence(), HasSubstr("normals of all 4 pairs point to opposite sides"));
}

TEST(AlignRefusals, RowsWithoutNormals_DoNotHideAPlateUpsideDown) {
    PointCloud source = cloud(plate());
    source.columns.add(Column("normal", 3, Buffer<double>{0, 0, 1, 0, 0, 0, nan, 0, 1, 0, 0, 1}));
    PointCloud target = cloud({plate()[1], plate()[0], plate()[3], plate()[2]});
    target.columns.add(Column("normal", 3, Buffer<double>{0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0, 1}));
    EXPECT_THAT(refusal(source, target).sentence(),
                HasSubstr("normals of all 2 pairs that have them point to opposite sides"));
    PointCloud bare = cloud(plate());
    bare.columns.add(Column("normal", 3, Buffer<double>{0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}));
    EXPECT_EQ(aligned(bare, target).partner.size(), 4u) << "no normals, no contradiction";
}

TEST(AlignRefusals, CoordinatesThatAreNotNumbers_AreRefused) {
    std::vector<Vec3> bad = plate();
    bad[2].y() = nan;
    EXPECT_THAT(refusal(cloud(bad), cloud(plate())).sentence(), HasSubstr("1 of "));
    EXPECT_THAT(refusal(cloud(plate()), cloud(bad)).frames(), testing::ElementsAre("at 'target'"));
}

TEST(AlignRefusals, DifferentUnits_AreRefused) {
    PointCloud source = cloud(plate());
    source.frame.unit = LengthUnit::millimetre;
    EXPECT_EQ(refusal(source, cloud(plate())).sentence(), "the source is in mm, the target in u; both need one unit");
}

TEST(AlignRefusals, APartInAnotherFrameOrWithoutPoints) {
    const AlignPart elsewhere{{Vec3::Zero(), Vec3::Ones()}, "machine"};
    EXPECT_EQ(refusal(cloud(plate(), "scanner"), cloud(plate(), "machine"), {}, elsewhere).sentence(),
              "the part is in the frame 'machine', the source in 'scanner'; both need one frame");
    EXPECT_EQ(refusal(cloud(plate()), cloud(plate()), {}, AlignPart{}).sentence(),
              "the part has no points; its box is empty");
}

// Rectangles.

TEST(AlignRefusals, ARectangleWithoutFirstCorner_IsAmbiguous) {
    AlignParams params = in_rectangle(plate()[0]);
    params.first_corner.reset();
    EXPECT_EQ(refusal(cloud(plate()), cloud(plate()), params).sentence(),
              "`first-corner` is not given; a rectangle fits its corners in 2 ways, half a turn apart");
}

TEST(AlignRefusals, FirstCornerWithRows_IsRefused) {
    AlignParams params = in_rectangle(plate()[0]);
    params.correspondence = AlignParams::Correspondence::rows;
    EXPECT_EQ(refusal(cloud(plate()), cloud(plate()), params).sentence(),
              "`first-corner` is given, but `correspondence` is rows");
}

TEST(AlignRefusals, FirstCornerFarFromAllCorners_OrBetweenTwo) {
    EXPECT_EQ(
        refusal(cloud(plate()), cloud(plate()), in_rectangle({-100, 0, 0})).sentence(),
        "`first-corner` is 60 u from the nearest corner of the source; less than 60 u, half of the shortest side, "
        "is needed");
    EXPECT_THAT(refusal(cloud(plate()), cloud(plate()), in_rectangle({nan, 0, 0})).sentence(),
                HasSubstr("a length of `first-corner` is nan u"));
    AlignParams two = in_rectangle({0, 0, 0});
    two.first_corner->pop_back();
    EXPECT_EQ(refusal(cloud(plate()), cloud(plate()), two).sentence(), "`first-corner` has 2 lengths; it needs 3");
}

TEST(AlignRefusals, LongSidesThatMeetShortOnes_AreRefused) {
    EXPECT_THAT(refusal(cloud(plate()), cloud(plate()), in_rectangle(plate()[1])).sentence(),
                HasSubstr("with the corner at `first-corner` long sides meet short ones: residuals are 56.57 u RMS"));
}

TEST(AlignRefusals, OtherThanFourCorners_OrCornersInOnePlace) {
    EXPECT_EQ(refusal(cloud({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}), cloud({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}),
                      in_rectangle({0, 0, 0}))
                  .sentence(),
              "the source and the target have 3 points each; a rectangle has 4 corners");
    const std::vector<Vec3> twice{plate()[0], plate()[1], plate()[2], plate()[2]};
    EXPECT_EQ(refusal(cloud(plate()), cloud(twice), in_rectangle(plate()[0])).sentence(),
              "the four corners at 'target' do not go once around their centre");
    EXPECT_EQ(refusal(cloud(twice), cloud(plate()), in_rectangle(plate()[0])).sentence(),
              "the four corners at 'source' do not go once around their centre");
}

TEST(AlignRefusals, CornersOnOneLine_AreNotARectangle) {
    for (const std::vector<Vec3>& line : {std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}, {3, 0, 0}},
                                          std::vector<Vec3>{{5, 5, 5}, {5, 5, 5}, {5, 5, 5}, {5, 5, 5}}}) {
        EXPECT_EQ(refusal(cloud(plate()), cloud(line), in_rectangle(plate()[0])).sentence(),
                  "the four corners at 'target' lie on one line");
        EXPECT_EQ(refusal(cloud(line), cloud(plate()), in_rectangle(plate()[0])).sentence(),
                  "the four corners at 'source' lie on one line");
    }
}

TEST(AlignRefusals, AnUprightPlate_NeedsUp) {
    const std::vector<Vec3> upright{{-100, 0, -60}, {100, 0, -60}, {100, 0, 60}, {-100, 0, 60}};
    EXPECT_EQ(refusal(cloud(plate()), cloud(upright), in_rectangle(plate()[0])).sentence(),
              "`up` is 90 deg off the normal of the plate at 'target'; at most 60 deg determine the upper side");
    PointCloud slanted = cloud(plate());
    slanted.columns.add(Column("normal", 3, Buffer<double>{1, 0, 0, 1, 0, 0, 1, 0, 0, 1, 0, 0}));
    EXPECT_EQ(refusal(slanted, cloud(plate()), in_rectangle(plate()[0])).sentence(),
              "the mean normal of the corners is 90 deg off the normal of the plate at 'source'; at most 60 deg "
              "determine the upper side");
    AlignParams given = in_rectangle(plate()[0]);
    given.up = {0, 0, 1};
    EXPECT_EQ(aligned(slanted, cloud(plate()), given).partner[0], 0u) << "as the hint says";
    AlignParams nowhere = in_rectangle(plate()[0]);
    nowhere.up = {0, 0, 0};
    EXPECT_EQ(refusal(cloud(plate()), cloud(plate()), nowhere).sentence(),
              "`up` is (0, 0, 0); it must be finite and not zero");
    nowhere.up = {1, 2};
    EXPECT_EQ(refusal(cloud(plate()), cloud(plate()), nowhere).sentence(), "`up` has 2 numbers; it needs 3");
}

}  // namespace
}  // namespace scanmill::test
