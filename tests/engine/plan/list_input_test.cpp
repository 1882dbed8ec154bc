// SPDX-License-Identifier: GPL-3.0-or-later
// Inputs that are lists, the first one among them, and the frames that scans are given by their names.

#include <gmock/gmock.h>

#include "engine/run/run_fixture.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/formats/files.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

class ListInput : public test::Run {
protected:
    static constexpr const char* views = "{views: [points]}";
    static constexpr const char* step = "  - test-step:\n    in: {more: views}\n";
};

TEST_F(ListInput, First_TakesAllScansInOneRunOfTheWorkflowsName) {
    const RunReport report = run(step, {scan("c.xyz", "0 0 0\n1 1 1\n"), scan("a.xyz"), scan("b.xyz", "2 2 2\n")},
                                 "outputs: {'{scan}.ply': test-step}\n", views);
    EXPECT_TRUE(report.outcome() == Outcome::ok);
    ASSERT_EQ(graph_.cells.size(), 1u);
    EXPECT_THAT(graph_.scan_names, ElementsAre("w"));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/w.ply"));
    const RunNode& node = graph_.nodes.back();
    ASSERT_EQ(node.inputs.size(), 3u);
    EXPECT_EQ(report.nodes.back().metrics.find("more")->value, 7);
    std::vector<std::string> order;
    for (const NodeInput& input : node.inputs) order.push_back(graph_.nodes[input.node].leaf.file.stem());
    EXPECT_THAT(order, ElementsAre("c", "a", "b")) << "as they were given";
}

TEST_F(ListInput, OrderOfTheScans_IsPartOfTheKey) {
    const std::string a = scan("a.xyz"), b = scan("b.xyz", "2 2 2\n");
    prepare(step, {a, b}, "", views);
    const std::string key = graph_.nodes.back().key;
    prepare(step, {b, a}, "", views);
    EXPECT_NE(graph_.nodes.back().key, key);
    prepare(step, {a, b}, "", views);
    EXPECT_EQ(graph_.nodes.back().key, key);
}

TEST_F(ListInput, OneBadScan_FailsTheRunAndIsNamed) {
    const RunReport report = run(step, {scan("a.xyz"), (folder_ / "missing.xyz").string()}, "", views);
    ASSERT_EQ(report.cells.size(), 1u);
    EXPECT_EQ(report.cells[0].outcome, Outcome::failed);
    EXPECT_THAT(report.cells[0].failure.whole().what(), AllOf(HasSubstr("missing.xyz"), HasSubstr("on scan 'w'")));
}

TEST_F(ListInput, WithoutScans_IsRefused) {
    EXPECT_THAT(test::sentence_of([&] { prepare(step, {}, "", views); }), HasSubstr("no scan was given"));
}

TEST_F(ListInput, FirstInputFedByName_SaysThatScansFeedIt) {
    request_.inputs = {{"views", {"x.xyz"}}};
    EXPECT_THAT(test::sentence_of([&] { prepare(step, {scan("a.xyz")}, "", views); }),
                HasSubstr("'views' is the workflow's first input, which takes the scans"));
}

TEST_F(ListInput, FramesNamedByStem_AreThoseOfTheFiles) {
    const std::string inputs = "{scan: {kind: points, frame: 'v-{stem}'}}";
    run("  - test-step:\n", {scan("a.xyz"), scan("sub/b.c.xyz")}, "outputs: {'{scan}.ply': test-step}\n", inputs);
    EXPECT_EQ(read_points(folder_ / "out/a.ply")->frame.name, "v-a");
    EXPECT_EQ(read_points(folder_ / "out/b.c.ply")->frame.name, "v-b.c") << "equal content, another frame";
}

TEST_F(ListInput, FrameOfTheFile_IsReplacedAndTold) {
    const RunReport report = run("  - test-step:\n", {scan("a.xyz", "# frame lab\n" + test::small_scan)}, "",
                                 "{scan: {kind: points, frame: '{stem}'}}");
    ASSERT_TRUE(report.outcome() == Outcome::ok);
    EXPECT_THAT(report.nodes[0].warnings, ElementsAre(HasSubstr("'lab' was renamed to 'a'")));
}

TEST_F(ListInput, OutputThatIsAnInput_IsThatInputsFile) {
    request_.inputs = {{"other", {scan("o.xyz", "7 8 9\n")}}};
    run("  - test-step:\n    in: {points: scan}\n", {scan("a.xyz")}, "outputs: {'copy.xyz': other}\n",
        "{scan: points, other: points}");
    EXPECT_EQ(test::content_of(folder_ / "out/copy.xyz"), "7 8 9\n");
}

}  // namespace
}  // namespace scanmill
