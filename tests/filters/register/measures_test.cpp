// SPDX-License-Identifier: GPL-3.0-or-later
/// The measures of a pair by hand: copies of a square.
#include "filters/register/cases.hpp"
#include "register/scale.hpp"

namespace scanmill::test {
namespace {

using registration::measured;
using registration::PairMeasures;
using registration::reduced_view;
using registration::Verdict;
using registration::verdict_of;

/// 41 × 41 points, one unit apart.
std::vector<Vec3> square(const std::function<double(double, double)>& height = [](double, double) { return 0.0; }) {
    return height_view("square", 0, 41, 0, 41, height).points;
}

PairMeasures measures_of(const std::vector<Vec3>& first, const std::vector<Vec3>& second, double resolution = 2) {
    return measured(reduced_view(first, Vec3::UnitZ(), resolution), reduced_view(second, Vec3::UnitZ(), resolution),
                    {});
}

std::vector<Vec3> shifted(std::vector<Vec3> points, const Vec3& by) {
    for (Vec3& p : points) p += by;
    return points;
}

TEST(RegisterMeasures, OfACopy_OverlapFullyAndSlide) {
    const PairMeasures m = measures_of(square(), square());
    EXPECT_EQ(m.overlap, 1);
    EXPECT_EQ(m.front, 0);
    EXPECT_EQ(m.missing, 0);
    EXPECT_LT(m.slide, 1e-12);
    EXPECT_EQ(m.free_directions, 3u);
    EXPECT_EQ(verdict_of(m, 0.3), Verdict::slides);
}

TEST(RegisterMeasures, AHalfRaisedToTheScanner_IsAThirdInFront) {
    // Front n/2 of one view, partners n/2 + n/2; up to one row of reduced points at the step.
    const PairMeasures m = measures_of(square(), square([](double x, double) { return x > 20 ? 4.5 : 0.0; }));
    EXPECT_NEAR(m.front, 1.0 / 3, 0.05);
    EXPECT_EQ(m.missing, 0);
    EXPECT_NEAR(m.overlap, 0.5, 0.05);
}

TEST(RegisterMeasures, ACopyRaisedToTheScanner_IsAllInFront) {
    const PairMeasures m = measures_of(square(), shifted(square(), Vec3(0, 0, 4.5)));
    EXPECT_EQ(m.overlap, 0);
    EXPECT_EQ(m.front, 1);
}

TEST(RegisterMeasures, ACopyMovedAside_IsAllMissing) {
    const PairMeasures m = measures_of(square(), shifted(square(), Vec3(60, 0, 0)));
    EXPECT_EQ(m.overlap, 0);
    EXPECT_EQ(m.front, 0);
    EXPECT_EQ(m.missing, 1);
}

TEST(RegisterMeasures, OfViewsThatTheFieldCutsOff_OnlyPlacesWithinTheOutlineAreMissing) {
    const auto missing = [](const std::vector<Vec3>& first, const std::vector<Vec3>& second) {
        return measured(reduced_view(first, Vec3::UnitZ(), 2, false), reduced_view(second, Vec3::UnitZ(), 2, false), {})
            .missing;
    };
    // Points of the first view outside the second one: the second scanner did not look there.
    EXPECT_EQ(missing(shifted(square(), Vec3(20, 0, 0)), square()), 0.0);
    // A gap of 21 × 21 points: the scanner looked through it, and the first view has points in it.
    std::vector<Vec3> with_gap = square();
    std::erase_if(with_gap, [](const Vec3& p) { return std::abs(p.x() - 20) <= 10 && std::abs(p.y() - 20) <= 10; });
    EXPECT_GT(missing(square(), with_gap), 0.05);
}

TEST(RegisterScale, UnitsAreNamedWithinATwentyPercent) {
    EXPECT_EQ(registration::unit_ratio(25.4, 1)->units, "millimetres and inches");
    EXPECT_EQ(registration::unit_ratio(1, 1100)->units, "millimetres and metres");
    EXPECT_EQ(registration::unit_ratio(9, 1)->units, "millimetres and centimetres");
    EXPECT_FALSE(registration::unit_ratio(1, 2));
    EXPECT_FALSE(registration::unit_ratio(1, 15));
    EXPECT_FALSE(registration::unit_ratio(0, 1));
}

}  // namespace
}  // namespace scanmill::test
