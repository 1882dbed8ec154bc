// SPDX-License-Identifier: GPL-3.0-or-later
// Parameters that name files: relative paths start at the right folder, and keys contain contents, not names.

#include "scanmill/plan/step_parameters.hpp"

#include <gmock/gmock.h>

#include "engine/run/run_fixture.hpp"

namespace scanmill {
namespace {

class PathParameters : public test::Run {
protected:
    std::string key_with(const std::string& path) {
        prepare("  - test-step: {log: '" + path + "'}\n", {scan("a.xyz")});
        return graph_.nodes.back().key;
    }
    /// The parameter as a filter gets it from a workflow in the folder `w`.
    std::string path_in_workflow(const std::string& step, const std::string& rest, const Settings& settings = {}) {
        Diagnostics diagnostics("w/flow.yaml");
        const Plan plan =
            make_plan(parse_workflow("scanmill: 1\ninputs: {scan: points}\n" + rest + "steps:\n" + step, diagnostics),
                      library_, settings, diagnostics);
        EXPECT_FALSE(diagnostics.has_errors());
        return text(*plan.steps.front().parameters.find("log"));
    }
};

TEST_F(PathParameters, Key_KnowsTheContentAndNotTheName) {
    const std::string key = key_with(folder_.write("p.conf", "one").string());
    EXPECT_EQ(key_with(folder_.write("other/q.conf", "one").string()), key);
    EXPECT_NE(key_with(folder_.write("q.conf", "two").string()), key);
    EXPECT_NE(key_with(folder_.write("p.json", "one").string()), key) << "an extension may decide the format";
    EXPECT_NE(key_with(folder_.write("p.conf", "two").string()), key);
    EXPECT_EQ(key_with(folder_.write("p.conf", "one").string()), key);
}

TEST_F(PathParameters, MissingFile_StandsForItsPath) {
    const std::string key = key_with((folder_ / "absent").string());
    EXPECT_NE(key_with((folder_ / "missing").string()), key);
    EXPECT_NE(key_with(""), key);
}

TEST_F(PathParameters, InTheWorkflow_AreRelativeToIt) {
    EXPECT_EQ(path_in_workflow("  - test-step: {log: x.txt}\n", ""), "w/x.txt");
    EXPECT_EQ(path_in_workflow("  - test-step: {log: ../x.txt}\n", ""), "x.txt");
    EXPECT_EQ(path_in_workflow("  - test-step: {log: /x.txt}\n", ""), "/x.txt");
    EXPECT_EQ(path_in_workflow("  - test-step: {log: ''}\n", ""), "");
    EXPECT_EQ(path_in_workflow("  - test-step: {log: $p}\n", "parameters: {p: x.txt}\n"), "w/x.txt");
}

TEST_F(PathParameters, FromTheCommandLine_AreRelativeToTheWorkingFolder) {
    Diagnostics diagnostics("--set");
    const Settings settings{{"p", parse_value_expression("y.txt", diagnostics)}};
    EXPECT_EQ(path_in_workflow("  - test-step: {log: $p}\n", "parameters: {p: x.txt}\n", settings), "y.txt");
}

TEST_F(PathParameters, ListsAndWords_KeepTheirForm) {
    const ParameterValue list = std::vector<ParameterScalar>{std::string("a"), std::string("/b")};
    EXPECT_EQ(text(with_paths_from("f", list)), "[f/a, /b]");
    EXPECT_EQ(text(with_paths_from("f", ParameterScalar(Word{"none"}))), "none");
    EXPECT_EQ(text(with_paths_from("", ParameterScalar(std::string("a")))), "a");
    EXPECT_TRUE(std::holds_alternative<std::monostate>(with_paths_from("f", ParameterValue())));
}

}  // namespace
}  // namespace scanmill
