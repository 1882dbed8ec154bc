// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "filters/features/laws.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill {
namespace {

using namespace test;

class FeaturesOfAPart : public testing::TestWithParam<const char*> {};

TEST_P(FeaturesOfAPart, AgreeWithAnIndependentCount_InAnyOrder) {
    SCANMILL_REAL_SCAN(path, shared_data, GetParam());
    const auto mesh = read_mesh(path);
    expect_counted(*mesh, 40, 35);
    expect_counted(*mesh, 20, 60);
    const FeatureLines lines = features_of(*mesh);
    EXPECT_GT(lines.counts.creases, 10u);
    EXPECT_EQ(lines.counts.boundaries + lines.counts.holes, 0u);
    EXPECT_TRUE(same_graph(lines.graph, features_of(permuted(*mesh, 5), {}, 2).graph));
    expect_normals(lines);
}

INSTANTIATE_TEST_SUITE_P(Parts, FeaturesOfAPart,
                         testing::Values("3-mechanical/fandisk_large.off", "3-mechanical/anchor_dense.off"));

TEST(FeaturesOfAnOpenScan, HaveEveryLoop) {
    SCANMILL_REAL_SCAN(path, shared_data, "4-open/holes.off");
    const auto mesh = read_mesh(path);
    expect_counted(*mesh, 40, 35);
}

}  // namespace
}  // namespace scanmill
