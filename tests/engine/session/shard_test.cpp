// SPDX-License-Identifier: GPL-3.0-or-later
// Shards divide the cells of a batch: every cell is in one shard.
#include "scanmill/session/shard.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <set>

#include "support/folders.hpp"
#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

class ShardsOfABatch : public testing::Test {
protected:
    ShardsOfABatch() {
        for (const char* scan : {"a", "b", "c", "d", "e"}) folder_.write(std::string(scan) + ".xyz", "0 0 0\n");
        folder_.write(
            "w.yaml",
            "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n"
            "  - voxel-thin: {bin-size: {sweep: [1 u, 2 u]}}\noutputs: {'{scan}-{variant}.ply': voxel-thin}\n");
        folder_.write(
            "v.yaml",
            "scanmill: 1\nname: v\nsteps:\n  - virtual-scan: {shape: sphere}\noutputs: {v.ply: virtual-scan}\n");
    }
    CheckedBatch batch(const std::string& set = "{}") {
        const std::string text =
            "scanmill: 1\nbatch: b\nscans: [\"*.xyz\"]\nworkflows: [w.yaml, v.yaml]\nset: " + set + "\n";
        folder_.write("b.yaml", text);
        CheckedBatch checked = check_batch(text, (folder_ / "b.yaml").string(), library_);
        EXPECT_FALSE(checked.has_errors());
        return checked;
    }
    FilterLibrary library_{{plugin_folder()}};
    TemporaryFolder folder_;
};

TEST_F(ShardsOfABatch, EveryCellIsInOneShard) {
    const CheckedBatch whole = batch();
    EXPECT_EQ(units(whole), 6u) << "five scans, and a run without inputs";
    for (std::size_t count = 1; count <= 6; ++count) {
        std::size_t cells = 0;
        std::set<std::pair<std::size_t, std::size_t>> runs;  // workflow and scan
        for (std::size_t number = 1; number <= count; ++number) {
            CheckedBatch part = whole;
            choose(part, Shard{number, count});
            cells += part.cells();
            for (const BatchPart& each : part.parts)
                for (const std::size_t scan : each.scans) EXPECT_TRUE(runs.emplace(each.workflow, scan).second);
        }
        EXPECT_EQ(cells, whole.cells());
        EXPECT_EQ(runs.size(), 5u);
    }
}

TEST_F(ShardsOfABatch, MoreShardsThanUnits_AreRefused) {
    CheckedBatch checked = batch();
    EXPECT_THAT(sentence_of([&] { choose(checked, Shard{7, 7}); }), HasSubstr("at most 6 shards"));
    CheckedBatch again = batch();
    EXPECT_THAT(sentence_of([&] { choose(again, std::vector<std::size_t>{2, 6}); }), HasSubstr("no unit 6; it has 6"));
}

TEST_F(ShardsOfABatch, ChosenUnits_AreKept) {
    CheckedBatch checked = batch();
    choose(checked, std::vector<std::size_t>{1, 5});
    ASSERT_EQ(checked.parts.size(), 2u);
    EXPECT_THAT(checked.parts[0].scans, testing::ElementsAre(1));
    EXPECT_TRUE(checked.parts[1].scans.empty());
}

TEST_F(ShardsOfABatch, KeyOfCells_ChangesWithScansAndValues_NotWithTheFolder) {
    const std::string key = key_of_cells(batch());
    EXPECT_EQ(key_of_cells(batch()), key);
    EXPECT_EQ(key_of_cells(batch("{}")), key);
    folder_.write("f.xyz", "0 0 0\n");
    EXPECT_NE(key_of_cells(batch()), key);
}

TEST(ShardText, IsANumberAndACount) {
    EXPECT_EQ(Shard::parse("3/7"), (Shard{3, 7}));
    EXPECT_EQ(Shard::parse("3/7").text(), "3/7");
    for (const char* text : {"", "3", "/7", "3/", "a/7", "3/7 ", "+3/7", "-1/7", "3/7/9"})
        EXPECT_THAT(sentence_of([&] { Shard::parse(text); }), HasSubstr("is not a shard")) << text;
    for (const char* text : {"0/7", "8/7", "1/0"})
        EXPECT_THAT(sentence_of([&] { Shard::parse(text); }), HasSubstr("there is no shard")) << text;
}

}  // namespace
}  // namespace scanmill::test
