// SPDX-License-Identifier: GPL-3.0-or-later
/// align: hand-computed cases, laws, and the statistics of registration.

#include <gmock/gmock.h>

#include <cmath>

#include "filters/align/cases.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

double off(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) { return (a - b).cwiseAbs().maxCoeff(); }

TEST(Align, AQuarterTurnOfThreePoints_IsFoundByHand) {
    // x goes to y and y to -x, then 10 along x.
    const Aligned result = aligned(cloud({{0, 0, 0}, {2, 0, 0}, {0, 1, 0}}, "scanner"),
                                   cloud({{10, 0, 0}, {10, 2, 0}, {9, 0, 0}}, "machine"));
    Eigen::Matrix3d turn;
    turn << 0, -1, 0, 1, 0, 0, 0, 0, 1;
    EXPECT_LT(off(result.transform.rotation, turn), 1e-15);
    EXPECT_LT((result.transform.translation - Vec3(10, 0, 0)).norm(), 1e-14);
    EXPECT_EQ(result.transform.from, "scanner");
    EXPECT_EQ(result.transform.to, "machine");
    EXPECT_LT(result.rms, 1e-14);
}

TEST(Align, ResidualsOfTwoShortSides_AreComputedByHand) {
    // The target's long sides are 2 longer: every corner is 1 off along x, the motion is the identity.
    std::vector<Vec3> target = plate();
    for (Vec3& p : target) p.x() += p.x() > 0 ? 1 : -1;
    const Aligned result = aligned(cloud(plate()), cloud(target));
    EXPECT_LT(off(result.transform.rotation, Eigen::Matrix3d::Identity()), 1e-15);
    EXPECT_NEAR(result.rms, 1, 1e-13);
    EXPECT_NEAR(result.largest_residual, 1, 1e-13);
    EXPECT_LT((result.residuals[1] - Vec3(1, 0, 0)).norm(), 1e-13);
    // sum(b . a) / sum |a|² = (100 · 101 + 60 · 60) / (100² + 60²)
    EXPECT_NEAR(result.scale, 13700.0 / 13600.0, 1e-12);
    EXPECT_NEAR(result.metrics.find("rms")->value, 1, 1e-13);
    EXPECT_NEAR(result.metrics.find("residual@4")->value, 1, 1e-13);
    EXPECT_NEAR(result.metrics.find("scale")->value, 13700.0 / 13600.0, 1e-12);
}

TEST(Align, RandomMotions_AreFoundToTheLastDigits) {
    Random random(1);
    for (int trial = 0; trial < 1000; ++trial) {
        const RigidTransform motion = random_motion(random, 1);
        std::vector<Vec3> points;
        for (std::size_t i = 0; i < 3 + trial % 8u; ++i)
            points.emplace_back(random.uniform(-1, 1), random.uniform(-1, 1), random.uniform(-1, 1));
        if (trial % 2)
            for (Vec3& p : points) p.z() = 0;  // coplanar: the determinant fixes the third axis
        const Aligned result = aligned(cloud(points), cloud(moved(points, motion)));
        ASSERT_LT(off(result.transform.rotation, motion.rotation), 1e-12) << trial;
        ASSERT_LT((result.transform.translation - motion.translation).norm(), 1e-12) << trial;
        ASSERT_NEAR(result.transform.rotation.determinant(), 1, 1e-14);
        ASSERT_NEAR(result.scale, 1, 1e-12);
    }
}

TEST(Align, NoiseOnFourCorners_LeavesSixDegreesOfFreedom) {
    // E[sum |residual|²] = (12 - 6) sigma²: 1.22 sigma RMS per point.
    Random random(2);
    constexpr double sigma = 0.1;
    constexpr int trials = 20000;
    double sum = 0;
    for (int trial = 0; trial < trials; ++trial) {
        const RigidTransform motion = random_motion(random);
        const Aligned result = aligned(cloud(plate()), cloud(with_noise(moved(plate(), motion), sigma, random)));
        sum += 4 * result.rms * result.rms;
    }
    // The standard deviation of a chi-squared number of 6 degrees is sqrt(12).
    EXPECT_NEAR(sum / trials / (sigma * sigma), 6, 4 * std::sqrt(12.0 / trials));
}

TEST(Align, ErrorAtPart_IsTheErrorOfManyTrials) {
    // sigma is estimated from the residuals: the mean of its square is that of the noise.
    const struct {
        Vec3 position;
        double in_sigma;
    } cases[] = {{{0, 0, 0}, 0.866}, {{0, 0, 80}, 1.164}, {{100, 60, 0}, 1.225}, {{200, 0, 50}, 1.650}};
    constexpr double sigma = 0.05;
    constexpr int trials = 20000;
    for (const auto& [position, in_sigma] : cases) {
        Random random(3);
        double errors = 0, estimates = 0;
        for (int trial = 0; trial < trials; ++trial) {
            const RigidTransform motion = random_motion(random);
            const AlignPart part{{position, position}, ""};
            const Aligned result =
                aligned(cloud(plate()), cloud(with_noise(moved(plate(), motion), sigma, random)), {}, part);
            errors += (result.transform.apply(position) - motion.apply(position)).squaredNorm();
            estimates += *result.error_at_part * *result.error_at_part;
        }
        EXPECT_NEAR(std::sqrt(estimates / trials) / sigma, in_sigma, 0.01 * in_sigma) << position.transpose();
        EXPECT_NEAR(std::sqrt(errors / trials) / sigma, in_sigma, 0.01 * in_sigma) << position.transpose();
    }
}

TEST(Align, ErrorAtPart_IsTheLargestOfTheBoxsCorners) {
    Random random(4);
    const std::vector<Vec3> target = with_noise(plate(), 0.1, random);
    const auto error = [&](const BoundingBox& box) {
        return *aligned(cloud(plate()), cloud(target), {}, AlignPart{box, ""}).error_at_part;
    };
    const BoundingBox box{{-150, -30, 0}, {20, 10, 80}};
    double largest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 at((corner & 1 ? box.high : box.low).x(), (corner & 2 ? box.high : box.low).y(),
                      (corner & 4 ? box.high : box.low).z());
        largest = std::max(largest, error({at, at}));
    }
    EXPECT_EQ(error(box), largest);
}

TEST(Align, FarFromZero_KeepsMicrometres) {
    Random random(5);
    const RigidTransform motion = random_motion(random, 1e6);
    PointCloud source = cloud(plate()), target = cloud(moved(plate(), motion));
    source.frame.origin = Vec3(3e6, -2e6, 1e6);
    const Aligned result = aligned(source, target);
    for (std::size_t row = 0; row < 4; ++row)
        EXPECT_LT((result.transform.apply(source.frame.origin + source.positions[row]) - target.positions[row]).norm(),
                  1e-8);
}

TEST(Align, ATransformAndItsInverse_ComeBack) {
    Random random(6);
    const std::vector<Vec3> target = with_noise(moved(plate(), random_motion(random)), 0.5, random);
    const Aligned there = aligned(cloud(plate()), cloud(target)), back = aligned(cloud(target), cloud(plate()));
    EXPECT_LT(off(there.transform.rotation * back.transform.rotation, Eigen::Matrix3d::Identity()), 1e-12);
    EXPECT_NEAR(there.rms, back.rms, 1e-12);
}

TEST(Align, OneUnitIsTheOther_ScaleReportsIt) {
    std::vector<Vec3> inches = plate();
    for (Vec3& p : inches) p /= 25.4;
    const Error error = error_of([&] { aligned(cloud(plate()), cloud(inches)); });
    EXPECT_THAT(error.sentence(), HasSubstr("the target is 0.0393701 times as large as the source"));
}

// Rectangles.

TEST(Align, AScaleThatExplainsTheResiduals_IsDoubtful) {
    std::vector<Vec3> larger = plate();
    for (Vec3& p : larger) p *= 1.01;
    Random random(5);
    const Aligned result = aligned(cloud(plate()), cloud(moved(larger, random_motion(random))));
    ASSERT_EQ(result.doubts.size(), 1u);
    EXPECT_THAT(
        result.doubts[0].text,
        testing::StartsWith("the target is 1.01 times as large as the source: the residuals are 1.166 u RMS, "));
    EXPECT_THAT(result.doubts[0].text,
                testing::EndsWith("with this scale; a unit is wrong, or the scanner is out of calibration"));
    // Noise of 0.2 leaves some 0.24 RMS of 1.17.
    EXPECT_EQ(aligned(cloud(with_noise(plate(), 0.1, random)), cloud(larger)).doubts.size(), 1u);
    EXPECT_EQ(aligned(cloud(with_noise(plate(), 1, random)), cloud(larger)).doubts.size(), 0u) << "lost in the noise";
    AlignParams unchecked;
    unchecked.scale = AlignParams::Scale::none;
    EXPECT_TRUE(aligned(cloud(plate()), cloud(larger), unchecked).doubts.empty());
    EXPECT_TRUE(aligned(cloud(plate()), cloud(moved(plate(), random_motion(random)))).doubts.empty()) << "rounding";
}

TEST(Align, NoiseAlone_RarelyLooksLikeAScale) {
    Random random(6);
    std::vector<Vec3> many;
    for (int i = 0; i < 10; ++i) many.emplace_back(random.uniform(0, 200), random.uniform(0, 120), 0);
    const std::vector<Vec3> three{plate()[0], plate()[1], plate()[2]};
    constexpr int trials = 20000;
    for (const auto& [points, most] : {std::pair(plate(), 0.003), std::pair(three, 0.008), std::pair(many, 0.0005)}) {
        int doubtful = 0;
        for (int trial = 0; trial < trials; ++trial)
            doubtful += !aligned(cloud(points), cloud(with_noise(points, 0.1, random))).doubts.empty();
        EXPECT_LT(doubtful, most * trials) << points.size();
    }
}

TEST(AlignRectangle, EveryOrderOfTheCorners_GivesTheSameMotion) {
    Random random(7);
    const RigidTransform motion = [&] {
        RigidTransform result = random_motion(random);
        result.rotation = Eigen::AngleAxisd(2.5, Vec3::UnitZ()).toRotationMatrix();  // the upper side stays up
        return result;
    }();
    const std::vector<Vec3> from = plate(), to = moved(plate(), motion);
    std::array<std::size_t, 4> order{0, 1, 2, 3};
    do {
        std::vector<Vec3> target;
        for (const std::size_t i : order) target.push_back(to[i]);
        const Aligned result = aligned(cloud(from), cloud(target), in_rectangle(from[order[0]] + Vec3(5, -8, 3)));
        EXPECT_LT(off(result.transform.rotation, motion.rotation), 1e-12);
        for (std::size_t row = 0; row < 4; ++row) EXPECT_EQ(result.partner[row], order[row]);
    } while (std::ranges::next_permutation(order).found);
}

TEST(AlignRectangle, AnyOrderOfTheSource_WithNoise_GivesTheSameMotion) {
    // Row by row the corners' polygon crosses itself, and noise alone gives its area a sign.
    Random random(17);
    for (const std::vector<Vec3>& corners :
         {plate(), std::vector<Vec3>{{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}}}) {
        std::array<std::size_t, 4> order{0, 1, 2, 3};
        do {
            // Rows that go around clockwise would be a plate seen from below.
            const bool is_clockwise = (order[1] + 1) % 4 == order[0] && (order[2] + 1) % 4 == order[1];
            for (int trial = 0; trial < 5; ++trial) {
                std::vector<Vec3> source;
                for (const std::size_t i : order) source.push_back(corners[i]);
                const PointCloud noisy = cloud(with_noise(source, 0.05, random));
                AlignParams params = in_rectangle(corners[0] + Vec3(5, 8, 3));
                if (is_clockwise) params.up = {0, 0, 1};
                const Aligned result = aligned(noisy, cloud(corners), params);
                EXPECT_LT(off(result.transform.rotation, Eigen::Matrix3d::Identity()), 0.01);
                for (std::size_t row = 0; row < 4; ++row) EXPECT_EQ(order[result.partner[row]], row);
            }
        } while (std::ranges::next_permutation(order).found);
    }
}

TEST(AlignRectangle, AGivenUp_WinsOverTheOrderOfTheRows) {
    // The source's rows go clockwise seen from above: a plate seen from below, unless `up` is given.
    const std::vector<Vec3> clockwise{plate()[0], plate()[3], plate()[2], plate()[1]};
    EXPECT_NEAR(aligned(cloud(clockwise), cloud(plate()), in_rectangle(plate()[1])).transform.rotation(2, 2), -1,
                1e-14);
    AlignParams params = in_rectangle(plate()[0]);
    params.up = {0, 0, 1};
    EXPECT_NEAR(aligned(cloud(clockwise), cloud(plate()), params).transform.rotation(2, 2), 1, 1e-14);
    // It is a direction of the target's frame only: the source's rows decide where it cannot.
    const std::vector<Vec3> upright{{-100, 0, -60}, {100, 0, -60}, {100, 0, 60}, {-100, 0, 60}};
    params.up = {0, -1, 0};
    const Aligned stood = aligned(cloud(plate()), cloud(upright), params);
    EXPECT_LT((stood.transform.rotation * Vec3::UnitZ() + Vec3::UnitY()).norm(), 1e-14);
}

TEST(AlignRectangle, FirstCorner_DecidesBetweenTheTwoHalfTurns) {
    const Aligned stays = aligned(cloud(plate()), cloud(plate()), in_rectangle(plate()[0]));
    const Aligned turns = aligned(cloud(plate()), cloud(plate()), in_rectangle(plate()[2]));
    EXPECT_THAT(stays.partner, ElementsAre(0, 1, 2, 3));
    EXPECT_THAT(turns.partner, ElementsAre(2, 3, 0, 1));
    EXPECT_NEAR(turns.transform.rotation(0, 0), -1, 1e-14);
    EXPECT_NEAR(turns.transform.rotation(2, 2), 1, 1e-14);
}

TEST(AlignRectangle, NormalsDecideWhichSideIsUp) {
    // The scanner looks along z at the plate: its upper side faces to -z.
    PointCloud source = cloud(plate());
    source.columns.add(Column("normal", 3, Buffer<double>{0, 0, -1, 0, 0, -1, 0, 0, -1, 0, 0, -1}));
    const Aligned result = aligned(source, cloud(plate()), in_rectangle(plate()[1]));
    EXPECT_NEAR(result.transform.rotation(2, 2), -1, 1e-14);
    EXPECT_LT(result.rms, 1e-13);
    AlignParams below = in_rectangle(plate()[0]);
    below.up = {0, 0, -1};
    EXPECT_NEAR(aligned(source, cloud(plate()), below).transform.rotation(2, 2), 1, 1e-14);
}

TEST(AlignRectangle, ASquare_IsAlignedByItsFirstCorner) {
    const std::vector<Vec3> square{{0, 0, 0}, {50, 0, 0}, {50, 50, 0}, {0, 50, 0}};
    for (std::size_t corner = 0; corner < 4; ++corner)
        EXPECT_EQ(aligned(cloud(square), cloud(square), in_rectangle(square[corner])).partner[0], corner);
}

}  // namespace
}  // namespace scanmill::test
