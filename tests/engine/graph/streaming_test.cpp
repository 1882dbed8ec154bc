// SPDX-License-Identifier: GPL-3.0-or-later
// What decides whether a scan is streamed, before it is opened.
#include "scanmill/graph/graph.hpp"

#include <gtest/gtest.h>

#include "engine/run/run_fixture.hpp"
#include "support/point_files.hpp"

namespace scanmill::test {
namespace {

const std::string streams = "  - test-stream: {length: 1 u}\n";
const std::string also_streams = "  - id: b\n    test-stream: {length: 2 u}\n    in: scan\n";
const std::string output = "outputs: {'{scan}.ply': test-stream}\n";

class Streaming : public Run {
protected:
    /// Whether the first scan is streamed, by the plan and by the graph.
    struct Verdict {
        bool plan = false, graph = false;
        bool operator==(const Verdict&) const = default;
    };
    Verdict verdict(const std::string& steps, const std::string& tail, const std::string& file,
                    const std::string& inputs = "{scan: points}") {
        prepare(steps, {file}, tail, inputs);
        return {is_streamed(plan_, 0), leaf_is_streamed()};
    }
    bool leaf_is_streamed() const {
        for (const RunNode& node : graph_.nodes)
            if (node.is_scan) return node.leaf.is_streamed;
        return false;
    }
    const std::string ply_ = written(folder_ / "a.ply", helix(10));
};

constexpr bool yes = true, no = false;

TEST_F(Streaming, AFilterThatCan_Streams) {
    EXPECT_EQ(verdict(streams, output, ply_), (Verdict{yes, yes}));
    EXPECT_EQ(verdict(streams + also_streams, output, ply_), (Verdict{yes, yes})) << "two that read the same";
    EXPECT_EQ(verdict(streams + "  - test-step:\n", output, ply_), (Verdict{yes, yes})) << "the second reads the first";
    EXPECT_EQ(verdict(streams + "    expect: {points: 2}\n", output, ply_), (Verdict{yes, yes}));
    EXPECT_EQ(verdict("  - test-stream: {length: {sweep: [1 %diag, 2 u]}}\n", "", ply_), (Verdict{yes, yes}));
    EXPECT_EQ(verdict(streams, output, ply_, "{scan: {kind: points, unit: mm, frame: part}}"), (Verdict{yes, yes}));
}

TEST_F(Streaming, AFilterThatCannot_DoesNot) {
    EXPECT_EQ(verdict("  - test-step:\n", "", ply_), (Verdict{no, no}));
    EXPECT_EQ(verdict("  - test-step:\n  - test-stream: {length: 1 u}\n", output, ply_), (Verdict{no, no}))
        << "it is not the first that reads the scan";
}

TEST_F(Streaming, ParameterWithoutAValue_PreventsIt) {
    EXPECT_EQ(verdict("  - test-stream: {length: auto}\n", output, ply_), (Verdict{no, no}));
    EXPECT_EQ(verdict("  - test-stream:\n", output, ply_), (Verdict{no, no}));
    EXPECT_EQ(verdict("  - test-stream: {length: {sweep: [auto, 1 u]}}\n", "", ply_), (Verdict{no, no}))
        << "one of the variants needs the whole scan";
}

TEST_F(Streaming, LengthInSpacings_PreventsIt) {
    EXPECT_EQ(verdict("  - test-stream: {length: 3 spacing}\n", output, ply_), (Verdict{no, no}));
    EXPECT_EQ(verdict("  - test-stream: {length: 1 u, more: 3 spacing}\n", output, ply_), (Verdict{no, no}));
    EXPECT_EQ(verdict("  - test-stream: {length: 1 u, more: 3 %diag}\n", output, ply_), (Verdict{yes, yes}));
}

TEST_F(Streaming, AnotherReader_PreventsIt) {
    EXPECT_EQ(verdict(streams + "  - test-step:\n    in: {points: scan}\n", output, ply_), (Verdict{no, no}));
    EXPECT_EQ(verdict(streams, "outputs: {'{scan}.copy.ply': scan}\n", ply_), (Verdict{no, no})) << "an output";
}

TEST_F(Streaming, ReadersThatAreNotRun_DoNotCount) {
    const std::string steps = streams + "  - test-step:\n    in: {points: scan}\n";
    request_.until = "test-stream";
    EXPECT_EQ(verdict(steps, output, ply_), (Verdict{no, yes})) << "the plan knows nothing of --until";
    request_.until.clear();
    EXPECT_EQ(verdict(steps, output, ply_), (Verdict{no, no}));
}

TEST_F(Streaming, Pose_PreventsIt) {
    prepare(streams, {ply_}, output);
    ASSERT_TRUE(leaf_is_streamed());
    request_.scans.front().pose.emplace();
    graph_ = make_graph(plan_, library_, request_);
    EXPECT_FALSE(leaf_is_streamed());
}

TEST_F(Streaming, FilesThatCannotBeReadSo_AreRead) {
    const Verdict whole{yes, no};
    EXPECT_EQ(verdict(streams, output, scan("a.xyz")), (Verdict{yes, yes}));
    EXPECT_EQ(verdict(streams, output, scan("six.xyz", "1 2 3 4 5 6\n")), whole);
    EXPECT_EQ(verdict(streams, output,
                      scan("ascii.ply",
                           "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                           "property float z\nend_header\n1 2 3\n")),
              whole);
    EXPECT_EQ(verdict(streams, output, scan("cut.ply", content_of(ply_).substr(0, content_of(ply_).size() - 1))),
              whole);
    EXPECT_EQ(verdict(streams, output, scan("empty.ply", "")), whole);
    EXPECT_EQ(verdict(streams, output, (folder_ / "missing.ply").string()), whole);
    EXPECT_EQ(verdict(streams, output, folder_.path().string()), whole);
}

TEST_F(Streaming, OtherInputs_AreDecidedOneByOne) {
    request_.inputs = {{"other", {scan("b.xyz")}}};
    prepare("  - test-stream: {length: 1 u}\n    in: {points: other}\n  - test-step:\n    in: {points: scan}\n", {ply_},
            "", "{scan: points, other: points}");
    EXPECT_FALSE(is_streamed(plan_, 0));
    EXPECT_TRUE(is_streamed(plan_, 1));
    for (const RunNode& node : graph_.nodes) EXPECT_EQ(node.leaf.is_streamed, !node.step && !node.is_scan);
}

}  // namespace
}  // namespace scanmill::test
