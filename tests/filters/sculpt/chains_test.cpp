// SPDX-License-Identifier: GPL-3.0-or-later
// Flips that gain only together.

#include <gmock/gmock.h>

#include <numbers>

#include "filters/sculpt/brute_force.hpp"

namespace scanmill {
namespace {

using namespace test;
using std::numbers::pi;

constexpr double degree = pi / 180;

/// Blocks 2 × 2 × 1 without a quarter, starting at `apart` along x, their surfaces sampled every 0.5, with a web of
/// cells over the upper half of the concave edge: a prism whose top is in the plane of the block's top, and whose lower
/// end is free. `mirrored`: a mirror image, whose cospherical lattice points are split into other cells.
TetMesh half_webbed(const std::vector<double>& apart, bool mirrored = false) {
    const PointCloud block = l_block_surface(2, 2, 2);
    PointCloud cloud;
    Array<Vec3> positions;
    for (double start : apart)
        for (const Vec3& p : block.positions)
            positions.push_back(Vec3(start + (mirrored ? 2 - p.x() : p.x()), p.y(), p.z()));
    cloud.positions = std::move(positions);
    TetMesh tets = tets_of(cloud);

    const auto is_in_web = [](const Vec3& p) {
        return p.x() >= 1 && p.y() >= 1 && p.x() + p.y() <= 2.5 && p.z() >= 0.5;
    };
    Array<u8> inside(tets.cells.size());
    std::ranges::fill(inside, u8(0));
    for (double start : apart)
        for (std::size_t cell = 0; cell < inside.size(); ++cell) {
            Vec3 middle = Vec3::Zero();
            bool in_web = true, in_hull = true;
            for (u32 vertex : tets.cells[cell]) {
                const Vec3 p = tets.positions[vertex] - Vec3(start, 0, 0);
                const Vec3 q(mirrored ? 2 - p.x() : p.x(), p.y(), p.z());
                middle += q / 4;
                in_web &= is_in_web(q);
                in_hull &= q.x() >= 0 && q.x() <= 2;
            }
            if (in_hull && (middle.x() < 1 || middle.y() < 1 || in_web)) inside[cell] = 1;
        }
    tets.inside = std::move(inside);
    return tets;
}

TetMesh half_webbed_block(bool mirrored = false) { return half_webbed({0}, mirrored); }

double inside_volume(const TetMesh& tets) {
    double volume = 0;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
        if (tets.inside[cell] != 0) volume += volume_of(tets, cell);
    return volume;
}

TEST(SculptChains, WebThatGainsOnlyWithItsThirdCell_IsRemovedWhole) {
    const TetMesh webbed = half_webbed_block();
    ASSERT_NEAR(inside_volume(webbed), 3 + 1.0 / 16, 1e-12);
    const SculptResult result = sculpted(webbed);
    ASSERT_EQ(result.removals.size(), 3u);
    EXPECT_EQ(result.smoothing, 3u);
    EXPECT_NEAR(inside_volume(result.tets), 3, 1e-12);
    // Removing the cell at the top makes creases in a plane, removing the last one replaces many angles by a right one.
    const double slant = std::acos(1 / std::sqrt(3.0));
    EXPECT_NEAR(result.removals[0].gain, -150 * degree, 1e-12);
    EXPECT_NEAR(result.removals[1].gain, 60 * degree - slant, 1e-12);
    EXPECT_NEAR(result.removals[2].gain, 270 * degree + slant, 1e-12);
    EXPECT_NEAR(result.bending_before - result.bending_after, pi, 1e-12);
    EXPECT_TRUE(result.removals[0].chained && result.removals[1].chained && !result.removals[2].chained);
}

TEST(SculptChains, WebWhoseFirstCellGains_IsFinishedByAPair) {
    const SculptResult result = sculpted(half_webbed_block(true));
    ASSERT_EQ(result.removals.size(), 3u);
    EXPECT_NEAR(inside_volume(result.tets), 3, 1e-12);
    EXPECT_NEAR(result.removals[0].gain, 120 * degree, 1e-12);
    EXPECT_NEAR(result.removals[1].gain, -150 * degree, 1e-12);
    EXPECT_NEAR(result.removals[2].gain, 210 * degree, 1e-12);
    EXPECT_TRUE(!result.removals[0].chained && result.removals[1].chained && !result.removals[2].chained);
}

TEST(SculptChains, MinGain_CountsForEveryFlipOfAChain) {
    SculptParams params;
    // A chain of three that gains 180 degrees.
    params.min_gain = Angle::degrees(60.001);
    EXPECT_TRUE(sculpted(half_webbed_block(), params).removals.empty());
    params.min_gain = Angle::degrees(59.999);
    EXPECT_EQ(sculpted(half_webbed_block(), params).removals.size(), 3u);
}

TEST(SculptChains, WeightedByLength_CountTheEdges) {
    SculptParams params;
    params.weight = SculptWeight::length;
    const SculptResult result = sculpted(half_webbed_block(), params);
    EXPECT_NEAR(inside_volume(result.tets), 3, 1e-12);
    double gain = 0;
    for (const SculptRemoval& removal : result.removals) gain += removal.gain;
    // Removed: two edges of sqrt(1/2) and two of 1/2 at 90 degrees, and two of 1/2 at 45. Added: three of 1/2 at 90.
    EXPECT_NEAR(gain, (2 * std::sqrt(0.5) * 90 + 2 * 0.5 * 45 + 2 * 0.5 * 90 - 3 * 0.5 * 90) * degree, 1e-12);
}

TEST(SculptChains, OfTwoEqual_TheOneWithTheLowerCornersComesFirst) {
    for (const std::vector<double>& starts : {std::vector<double>{0, 8}, std::vector<double>{8, 0}}) {
        const TetMesh both = half_webbed(starts);
        const SculptResult result = sculpted(both);
        ASSERT_EQ(result.removals.size(), 6u);
        for (std::size_t i = 0; i < 6; ++i) {
            const bool is_low = both.positions[both.cells[result.removals[i].cell][0]].x() < 4;
            EXPECT_EQ(is_low, i < 3) << "removal " << i;
            EXPECT_EQ(result.removals[i].gain, result.removals[i % 3].gain);
        }
    }
}

/// The largest gain of this chain and of all chains that begin with it.
double best_gain(const TetMesh& tets, Carving& carving, std::vector<u32>& chain, bool smooths, double at_start) {
    double best = smooths ? at_start - carving.bending() : -1e9;
    if (chain.size() == 3) return best;
    for (std::size_t i = 0; i < chain.size(); ++i)
        for (u32 cell : tets.neighbours[chain[i]]) {
            if (!carving.may_flip(cell)) continue;
            const bool smooths_too = carving.may_smooth(cell);
            carving.remove(cell);
            chain.push_back(cell);
            best = std::max(best, best_gain(tets, carving, chain, smooths || smooths_too, at_start));
            chain.pop_back();
            carving.put_back(cell);
        }
    return best;
}

/// The best gain of all flips and chains; far below 0 if there are none.
double best_gain_of_all(const TetMesh& tets, Carving& carving) {
    const double bending = carving.bending();
    double best = -1e9;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell) {
        if (!carving.may_flip(cell)) continue;
        std::vector<u32> chain{cell};
        const bool smooths = carving.may_smooth(cell);
        carving.remove(cell);
        best = std::max(best, best_gain(tets, carving, chain, smooths, bending));
        carving.put_back(cell);
    }
    return best;
}

class SculptChainLaws : public testing::TestWithParam<std::size_t> {};

TEST_P(SculptChainLaws, TheBestIsTaken_AndNoneThatGainsIsLeft) {
    const SculptCase given = sculpt_cases()[GetParam()];
    SCOPED_TRACE(given.name);
    const SculptResult result = sculpted(given.tets, given.params);
    Carving carving(given.tets, given.params.weight);
    bool in_chain = false;
    for (std::size_t i = 0; i < result.removals.size(); ++i) {
        if (result.removals[i].chained && !in_chain) {
            double gain = result.removals[i].gain;
            for (std::size_t k = i; result.removals[k].chained; ++k) gain += result.removals[k + 1].gain;
            EXPECT_NEAR(best_gain_of_all(given.tets, carving), gain, 1e-6) << "removal " << i;
        }
        in_chain = result.removals[i].chained;
        carving.remove(result.removals[i].cell);
    }
    const double left = best_gain_of_all(given.tets, carving);
    EXPECT_LE(left, 1e-6);
    if (GetParam() < 3) {
        EXPECT_GT(left, -1e9) << "flips without gain are left";
    }
}

INSTANTIATE_TEST_SUITE_P(Solids, SculptChainLaws, testing::Range(std::size_t(0), std::size_t(9)));

}  // namespace
}  // namespace scanmill
