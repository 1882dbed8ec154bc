// SPDX-License-Identifier: GPL-3.0-or-later
// Workflows written to exhaust their reader. Memory and processor time are limited far above what a check takes,
// and far below what following such a file would: where it is followed, the program dies and the exit code shows it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using testing::HasSubstr;

struct HostileWorkflow {
    std::string test_name;
    std::function<std::string()> text;
    std::string message;
};
void PrintTo(const HostileWorkflow& workflow, std::ostream* stream) { *stream << workflow.test_name; }

const std::string head = "scanmill: 1\ninputs: {scan: points}\n";

std::string repeated(int count, const std::function<std::string(std::string)>& line) {
    std::string text;
    for (int i = 0; i < count; ++i) text += line(std::to_string(i));
    return text;
}

/// Ten times ten times ten … nodes.
std::string bomb_of_aliases() {
    std::string text = "a0: &a0 [x, x, x, x, x, x, x, x, x, x]\n";
    for (int level = 1; level < 12; ++level) {
        const std::string below = "*a" + std::to_string(level - 1);
        text += "a" + std::to_string(level) + ": &a" + std::to_string(level) + " [" + below;
        for (int i = 1; i < 10; ++i) text += ", " + below;
        text += "]\n";
    }
    return head + text + "steps: *a11\n";
}

/// Every anchor keeps a copy of what is below it.
std::string bomb_of_anchors() {
    std::string text = "[" + repeated(400'000, [](const std::string&) { return "x,"; }) + "x]";
    for (int level = 0; level < 400; ++level) text = "&a" + std::to_string(level) + " [" + text + "]";
    return head + "steps: " + text + "\n";
}

std::string bomb_of_text() {
    return head + "name: &a " + std::string(1'000'000, 'x') + "\nsteps: [" +
           repeated(100'000, [](const std::string&) { return "*a,"; }) + "*a]\n";
}

/// Forks in forks, 240 in a line and each line inside the one before: deeper than a stack.
std::string forks_in_forks() {
    std::string text = head, inner = "[{voxel-thin: {bin-size: 1 u}}]";
    for (int line = 0; line < 43; ++line) {
        std::string fork = inner;
        for (int level = 0; level < 240; ++level) fork = "[{one-of: " + fork + "}]";
        text += "a" + std::to_string(line) + ": &a" + std::to_string(line) + " " + fork + "\n";
        inner = "*a" + std::to_string(line);
    }
    return text + "steps: " + inner + "\n";
}

std::string steps_times_variants() {
    const std::string sweep = "{sweep: [1, 2, 3, 4, 5, 6, 7, 8, 9, 10]}";
    return head + "steps:\n" +
           repeated(4,
                    [&](const std::string& i) {
                        return "- {id: a" + i + ", voxel-thin: {bin-size: 1 u, min-points: " + sweep + "}}\n";
                    }) +
           repeated(300, [](const std::string& i) { return "- {id: s" + i + ", voxel-thin: {bin-size: 1 u}}\n"; });
}

const std::vector<HostileWorkflow> hostile_workflows{
    {"AliasesOfAliases", bomb_of_aliases, "expands to more than 1000000 nodes"},
    {"AnchorsAroundAnchors", bomb_of_anchors, "expands to more than 1000000 nodes"},
    {"AliasesOfALongText", bomb_of_text, "expands to more than 67108864 bytes"},
    {"ForksInForks", forks_in_forks, "expands to more than 500 levels"},
    {"ListsInLists", [] { return head + "steps: " + std::string(100'000, '[') + std::string(100'000, ']'); },
     "invalid YAML"},
    {"MapsInMaps", [] { return head + "steps: " + repeated(100'000, [](const std::string&) { return "{a: "; }); },
     "invalid YAML"},
    {"StepsTimesVariants", steps_times_variants, "more than 500000 steps in all its variants"},
    {"TenMegabytesOfOneText", [] { return head + "steps: [" + std::string(10'000'000, 'x') + "]\n"; },
     "a text of 10000000 bytes"},
    {"TenMegabytesOfBlanks", [] { return head + "steps:" + std::string(10'000'000, ' ') + "\n"; }, "expected a list"},
    {"ALongList",
     [] { return head + "steps: [" + repeated(490'000, [](const std::string&) { return "x, "; }) + "x]\n"; },
     "490001 errors in"},
    {"AMillionKeys", [] { return head + repeated(1'000'000, [](const std::string& i) { return "k" + i + ": 1\n"; }); },
     "expands to more than 1000000 nodes"},
    {"ManyParametersOfAStep",
     [] {
         return head + "steps:\n- voxel-thin:\n" +
                repeated(200'000, [](const std::string& i) { return "    k" + i + ": 1\n"; });
     },
     "200000 errors"},
    {"ManyOutputs",
     [] {
         return head + "steps: [{voxel-thin: {bin-size: 1 u}}]\noutputs:\n" +
                repeated(200'000, [](const std::string& i) { return "  f" + i + ".ply: voxl-thin\n"; });
     },
     "200000 errors"},
    {"AZeroByte", [] { return head + "name: a" + std::string(1, '\0') + "b\n"; }, "w.yaml:3:8: found a zero byte"},
};

class HostileWorkflowTest : public testing::TestWithParam<HostileWorkflow> {};

TEST_P(HostileWorkflowTest, Check_RefusesWithinLimits) {
    const TemporaryFolder folder;
    folder.write("w.yaml", GetParam().text());
    ProgramOptions options{.folder = folder.path(), .seconds_limit = 300};
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    options.memory_limit = std::size_t(1) << 31;
    options.seconds_limit = 40;
#endif
    const ProgramResult ran = scanmill_program({"check", "w.yaml"}, options);
    EXPECT_EQ(ran.exit_code, 2) << ran.err.substr(0, 1000);
    EXPECT_THAT(ran.err.substr(0, 2000) + ran.err.substr(ran.err.size() - std::min<std::size_t>(ran.err.size(), 2000)),
                HasSubstr(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(All, HostileWorkflowTest, testing::ValuesIn(hostile_workflows),
                         [](const auto& workflow) { return workflow.param.test_name; });

}  // namespace
}  // namespace scanmill::test
