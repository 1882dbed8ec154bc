// SPDX-License-Identifier: GPL-3.0-or-later
/// The certified distance beside the sampled ones.
#include <gtest/gtest.h>

#include "filters/measure/cases.hpp"
#include "scanmill/base/random.hpp"

namespace scanmill::test {
namespace {

TEST(MeasureCertified, RandomSurfaces_BoundEverySample) {
    // No point of either surface is farther from the other than the upper bound.
    for (std::uint64_t seed = 0; seed < 8; ++seed) {
        Random random(seed);
        const auto bumpy = [&](u32 frequency) {
            return with_positions(geodesic_sphere(1, frequency),
                                  [&](const Vec3& p) -> Vec3 { return p * random.uniform(0.9, 1.1); });
        };
        const TriangleMesh one = bumpy(5), other = bumpy(7);
        MeasureParams params;
        params.certify = true;
        params.samples = 50'000;
        const Measurement sampled = measured(one, other, params);
        EXPECT_TRUE(sampled.certified->reached);
        EXPECT_LE(*sampled.hausdorff, sampled.certified->upper);
        EXPECT_LE(sampled.both.max, sampled.certified->upper);
        EXPECT_GE(*sampled.hausdorff, sampled.certified->lower * 0.98);
        EXPECT_GE(sampled.certified->upper, sampled.certified->lower);
    }
}

}  // namespace
}  // namespace scanmill::test
