// SPDX-License-Identifier: GPL-3.0-or-later
// What a run may need in memory follows from its scans' files and from how they are read.
#include "scanmill/session/session.hpp"

#include "engine/run/run_fixture.hpp"

namespace scanmill::test {
namespace {

using MemoryNeed = Run;

const std::string streamed = "  - test-stream: {length: 1 u}\n", whole = "  - test-step:\n";

TEST_F(MemoryNeed, OfScansInMemory_IsThatOfTheLargest) {
    const std::string small = scan("a.xyz"), large = scan("b.xyz", small_scan + small_scan);
    prepare(whole, {small, large, small});
    EXPECT_EQ(memory_need(graph_), 100 * 2 * small_scan.size());
}

TEST_F(MemoryNeed, OfAStreamedScan_CountsThatItMayHaveToBeReadWhole) {
    prepare(streamed, {scan("a.xyz", small_scan + "1 2 nan\n")});
    ASSERT_TRUE(graph_.nodes.front().leaf.is_streamed);
    EXPECT_EQ(memory_need(graph_), 4 * (small_scan.size() + 8));
}

TEST_F(MemoryNeed, OfAStreamedScanBesideOneInMemory_IsThatOfTheHungrier) {
    std::string large;
    while (large.size() < 10 * small_scan.size()) large += small_scan;
    const std::string four_columns = scan("four.xyz", "1 2 3 4\n5 6 7 8\n");
    prepare(streamed, {scan("a.xyz", large), four_columns});
    EXPECT_EQ(memory_need(graph_), 100u * 16u);
    while (large.size() < 100 * small_scan.size()) large += small_scan;
    prepare(streamed, {scan("a.xyz", large), four_columns});
    EXPECT_EQ(memory_need(graph_), 4 * large.size());
}

TEST_F(MemoryNeed, WithoutFiles_IsNothing) {
    const std::string file = scan("a.xyz");
    prepare(whole, {file});
    std::filesystem::remove(file);
    EXPECT_EQ(memory_need(graph_), 0u);
}

}  // namespace
}  // namespace scanmill::test
