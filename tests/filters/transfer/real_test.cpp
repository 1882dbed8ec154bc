// SPDX-License-Identifier: GPL-3.0-or-later
/// Colours and labels of a real scan: airborne, with one colour per class of its points.
#include <gmock/gmock.h>

#include <array>
#include <set>

#include "filters/transfer/cases.hpp"
#include "scanmill/formats/files.hpp"
#include "support/real_data.hpp"

namespace scanmill::test {
namespace {

TEST(TransferReal, HalfOfAnAirborneScan_ColoursTheOther_WithoutMixingTheColoursOfItsClasses) {
    SCANMILL_REAL_SCAN(file, fetched_data, "points_3/b9_training.ply");
    const auto scan = read_points(file);
    Array<u32> even, odd;
    for (u32 row = 0; row < scan->size(); ++row) (row % 2 == 0 ? even : odd).push_back(row);
    const PointCloud from = gather(*scan, even), to = gather(*scan, odd);
    const auto colours_of = [](const PointCloud& cloud) {
        const auto numbers = numbers_in(cloud, "colour");
        std::vector<std::array<double, 3>> colours;
        for (std::size_t i = 0; i < numbers.size(); i += 3)
            colours.push_back({numbers[i], numbers[i + 1], numbers[i + 2]});
        return colours;
    };
    const auto truth = colours_of(to), given = colours_of(from);
    const std::set<std::array<double, 3>> classes(given.begin(), given.end());
    ASSERT_EQ(classes.size(), 4u);
    TransferParams params;
    const auto result = carried(from, to, params);
    EXPECT_GT(result.transferred, 0.99 * static_cast<double>(to.size()));
    const auto found = colours_of(result.result);
    const auto marks = numbers_in(result.result, "transferred");
    std::size_t right = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
        if (marks[i] == 0) continue;
        EXPECT_TRUE(classes.contains(found[i])) << "row " << i;
        right += found[i] == truth[i];
    }
    EXPECT_GT(right, 0.98 * static_cast<double>(result.transferred));
}

TEST(TransferReal, AScanToItself_KeepsColoursAndLabels) {
    SCANMILL_REAL_SCAN(file, fetched_data, "points_3/b9_training.ply");
    const auto scan = read_points(file);
    const auto result = carried(*scan, *scan, columns_within({"colour", "label"}, 1, TransferParams::Method::nearest));
    EXPECT_EQ(result.transferred, scan->size());
    // Points at one position take the colour of the first of them.
    const auto before = numbers_in(*scan, "label"), after = numbers_in(result.result, "label");
    std::size_t changed = 0;
    for (std::size_t i = 0; i < before.size(); ++i) changed += before[i] != after[i];
    EXPECT_LE(changed, scan->size() / 1000);
}

}  // namespace
}  // namespace scanmill::test
