// SPDX-License-Identifier: GPL-3.0-or-later
/// inspect on a real scan.
#include <gtest/gtest.h>

#include "filters/inspect/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

TEST(InspectOfRealScan, CoarseDragon_DeviatesFromTheFineOneByLittle) {
    SCANMILL_REAL_SCAN(coarse, fetched_data, "dragon/dragon_vrip_res4.ply");
    SCANMILL_REAL_SCAN(fine, fetched_data, "dragon/dragon_vrip_res3.ply");
    const auto scan = read_mesh(coarse), nominal = read_mesh(fine);
    const double diagonal = bounding_box(nominal->positions.span()).diagonal();
    InspectParams params = params_with(-0.002 * diagonal, 0.002 * diagonal);
    params.max_distance.reset();
    params.label_distance = 0.05 * diagonal;
    const Inspection found = inspected(*scan, *nominal, params);
    EXPECT_EQ(found.points, found.numbers.counted + found.cut + found.undecided + found.beyond_border + found.too_far);
    EXPECT_GT(found.numbers.counted, found.points / 2);
    EXPECT_LT(std::abs(found.numbers.mean), 0.001 * diagonal);
    EXPECT_LT(found.numbers.rms, 0.005 * diagonal);
    EXPECT_LE(found.numbers.p1, found.numbers.p50);
    EXPECT_LE(found.numbers.p50, found.numbers.p99);
    ASSERT_FALSE(found.labels.empty());
    EXPECT_EQ(std::abs(found.labels[0].deviation), std::max(-found.numbers.min, found.numbers.max));
}

TEST(InspectOfRealScan, AgainstItself_IsZero) {
    SCANMILL_REAL_SCAN(path, shared_data, "3-mechanical/fandisk_large.off");
    const auto mesh = read_mesh(path);
    const Inspection found = inspected(*mesh, *mesh);
    EXPECT_EQ(found.numbers.min, 0);
    EXPECT_EQ(found.numbers.max, 0);
    EXPECT_EQ(found.numbers.in_tolerance, 1);
    EXPECT_EQ(found.undecided, 0u);
}

}  // namespace
}  // namespace scanmill::test
