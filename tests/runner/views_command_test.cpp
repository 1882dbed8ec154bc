// SPDX-License-Identifier: GPL-3.0-or-later
// A file of several views where lists, single scans and conversions are asked for.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "scanmill/formats/files.hpp"
#include "support/program.hpp"

namespace scanmill::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

std::string ptx_scan(double x, double z) {
    std::string cells;
    for (int i = 0; i < 4; ++i) cells += fmt::format("{} {} 1 0.5\n", x + i, i * i);
    return fmt::format("2\n2\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 {} 1\n", z) + cells;
}

class ViewsCommand : public testing::Test {
protected:
    ViewsCommand() {
        folder_.write("room.ptx", ptx_scan(1, 10) + ptx_scan(2, 20));
        folder_.write("list.yaml",
                      "scanmill: 1\nname: joined\ninputs: {views: {kind: points, list: true, frame: \"{stem}\"}}\n"
                      "steps: [merge: ]\noutputs: {\"{scan}.ply\": merge}\n");
        folder_.write("one.yaml",
                      "scanmill: 1\ninputs: {scan: points}\nsteps: [{voxel-thin: {bin-size: 0.001 u}}]\n"
                      "outputs: {\"{scan}.ply\": voxel-thin}\n");
    }
    ProgramResult run(const std::vector<std::string>& arguments) {
        return scanmill_program(arguments, {.folder = folder_.path()});
    }
    TemporaryFolder folder_;
};

TEST_F(ViewsCommand, List_TakesEveryView) {
    const ProgramResult ran = run({"run", "list.yaml", "room.ptx", "-o", "out"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const auto cloud = read_points(folder_ / "out/joined.ply");
    EXPECT_EQ(cloud->size(), 8u);
    const Column* source = cloud->columns.find("source");
    ASSERT_NE(source, nullptr);
    EXPECT_EQ(source->number(0), 0);
    EXPECT_EQ(source->number(7), 1) << "the scans of the file are two views";
    EXPECT_THAT(run({"run", "list.yaml", "room.ptx#2", "--dry-run"}).out, HasSubstr("room.ptx#2"));
}

TEST_F(ViewsCommand, SingleScan_IsTheWholeFile_OrTheViewThatIsNamed) {
    const ProgramResult ran = run({"run", "one.yaml", "room.ptx", "room.ptx#2", "-o", "out"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(read_points(folder_ / "out/room.ply")->size(), 8u);
    EXPECT_EQ(read_points(folder_ / "out/room-2.ply")->size(), 4u);
    const ProgramResult missing = run({"run", "one.yaml", "room.ptx#3", "-o", "out"});
    EXPECT_EQ(missing.exit_code, 1);
    EXPECT_THAT(missing.err, testing::AllOf(HasSubstr("room.ptx#3': has no scan 3"), HasSubstr("from #1 to #2")));
}

TEST_F(ViewsCommand, Views_AreCachedApart) {
    for (const char* name : {"room.ptx#1", "room.ptx#2"})
        ASSERT_EQ(run({"run", "one.yaml", name, "-o", "out", "--cache", "cache", "--keep", "always"}).exit_code, 0);
    const double first = read_points(folder_ / "out/room-1.ply")->positions[0].z();
    EXPECT_NE(first, read_points(folder_ / "out/room-2.ply")->positions[0].z());
}

TEST_F(ViewsCommand, Convert_WritesAFilePerView) {
    const ProgramResult ran = run({"convert", "room.ptx", "made.ply"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.err, HasSubstr("wrote 'made-1.ply'"));
    EXPECT_EQ(read_points(folder_ / "made-1.ply")->size(), 4u);
    EXPECT_EQ(read_points(folder_ / "made-2.ply")->size(), 4u);
    EXPECT_FALSE(std::filesystem::exists(folder_ / "made.ply"));
    ASSERT_EQ(run({"convert", "room.ptx#2", "second.ply"}).exit_code, 0);
    EXPECT_EQ(content_of(folder_ / "second.ply"), content_of(folder_ / "made-2.ply"));
    EXPECT_EQ(run({"convert", "room.ptx#2", "room.ptx"}).exit_code, 1) << "the input";
}

TEST_F(ViewsCommand, Info_CountsThem) {
    EXPECT_THAT(run({"info", "room.ptx"}).out, HasSubstr("views           2"));
    EXPECT_THAT(run({"info", "--json", "room.ptx"}).out, HasSubstr("\"views\": 2"));
    EXPECT_THAT(run({"info", "room.ptx#1"}).out, testing::Not(HasSubstr("views")));
}

TEST_F(ViewsCommand, Batch_TakesAViewByName) {
    folder_.write("batch.yaml", "scanmill: 1\nbatch: b\nscans: [{path: \"room.ptx#2\"}]\nworkflows: [one.yaml]\n");
    const ProgramResult ran = run({"batch", "batch.yaml", "-o", "out"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err << ran.out;
    EXPECT_EQ(read_points(folder_ / "out/room-2.ply")->size(), 4u);
}

TEST_F(ViewsCommand, FrameOfABatch_IsNamedAfterEachView) {
    for (const char* scan :
         {"{path: room.ptx, frame: \"f-{stem}\"}", "{path: o/a/*.ptx, by: folder, frame: \"f-{stem}\"}"}) {
        std::filesystem::remove_all(folder_ / "out");
        folder_.write("o/a/room.ptx", ptx_scan(1, 10) + ptx_scan(2, 20));
        folder_.write("batch.yaml", fmt::format("scanmill: 1\nbatch: b\nscans: [{}]\nworkflows: [list.yaml]\n", scan));
        const ProgramResult ran = run({"batch", "batch.yaml", "-o", "out"});
        ASSERT_EQ(ran.exit_code, 0) << ran.err;
        std::vector<std::string> frames;
        const auto recorded = nlohmann::json::parse(run({"runs", "out", "show", "1", "--json"}).out);
        for (const auto& step : recorded["steps"])
            if (step["step"] == "read") frames.push_back(step["authored"]["frame"]);
        EXPECT_THAT(frames, ElementsAre("f-room-1", "f-room-2")) << scan;
    }
}

}  // namespace
}  // namespace scanmill::test
