// SPDX-License-Identifier: GPL-3.0-or-later
/// Real scans without noise: all points are used, and nothing is invented.

#include <gmock/gmock.h>

#include "filters/tight_cocone/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill {
namespace {

using namespace test;

struct Scan {
    const char* file;
    long genus;
};

void PrintTo(const Scan& scan, std::ostream* stream) { *stream << scan.file; }

class TightCoconeOfRealScan : public testing::TestWithParam<Scan> {};

TEST_P(TightCoconeOfRealScan, IsOneClosedSurfaceThroughAllItsPoints) {
    SCANMILL_REAL_SCAN(path, fetched_data, GetParam().file);
    const auto cloud = read_points(path);
    const Outcome outcome = outcome_of(*cloud);
    ASSERT_TRUE(outcome.result) << outcome.refusal->what();
    expect_promised(*outcome.result, cloud->size());
    const MeshTopology found = topology(outcome.result->mesh);
    EXPECT_EQ(found.components, 1u);
    EXPECT_EQ(found.genus, GetParam().genus);
    EXPECT_EQ(outcome.result->unused, 0u);
    EXPECT_LT(outcome.result->invented_area, 0.001 * outcome.result->area);
    EXPECT_EQ(intersections(outcome.result->mesh), 0u);
    EXPECT_THAT(outcome.doubts, testing::IsEmpty());
}

INSTANTIATE_TEST_SUITE_P(Scans, TightCoconeOfRealScan,
                         testing::Values(Scan{"meshes/bunny00.off", 0}, Scan{"points_3/kitten.xyz", 1}));

}  // namespace
}  // namespace scanmill
