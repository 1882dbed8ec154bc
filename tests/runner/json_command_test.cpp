// SPDX-License-Identifier: GPL-3.0-or-later
// With --json a program that reads stdout gets an object, also when something is wrong.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::IsEmpty;

TEST(Json, BadRequests_AreAnErrorObjectAndASentence) {
    for (const std::vector<std::string>& arguments : std::vector<std::vector<std::string>>{
             {"run", "--json"},
             {"run", shipped("quickstart.yaml"), "--json"},
             {"run", "no-such-workflow.yaml", "x.ply", "--json"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--unit", "yard", "--json"},
             {"run", shipped("quickstart.yaml"), "x.ply", "--only", "nothing", "--json"},
             {"show", "no-such-filter", "--json"},
             {"list", "--json", "--frobnicate"}}) {
        const ProgramResult result = scanmill_program(arguments);
        EXPECT_EQ(result.exit_code, 2) << arguments[0];
        const json answer = json::parse(result.out);
        EXPECT_EQ(answer["scanmill"], 1);
        const std::string message = answer["error"]["message"];
        EXPECT_THAT(message, testing::Not(IsEmpty()));
        EXPECT_THAT(result.err, HasSubstr("error: " + message));
    }
}

TEST(Json, RunOfABadWorkflow_GivesWhatCheckGives) {
    const TemporaryFolder folder;
    const std::string workflow =
        folder
            .write("bad.yaml", "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - voxel-thinn:\n  - delaunay: {x: 1}\n")
            .string();
    const ProgramResult run = scanmill_program({"run", workflow, "x.ply", "--json"});
    const ProgramResult check = scanmill_program({"check", workflow, "--json"});
    EXPECT_EQ(run.exit_code, 2);
    EXPECT_EQ(json::parse(run.out), json::parse(check.out));
    const json diagnostics = json::parse(run.out)["files"][0]["diagnostics"];
    ASSERT_EQ(diagnostics.size(), 2u);
    EXPECT_EQ(diagnostics[0]["line"], 4);
    EXPECT_EQ(diagnostics[0]["severity"], "error");
}

TEST(Json, NamesThatAreNoUtf8_DoNotBreakIt) {
    const ProgramResult result = scanmill_program({"check", "no-such-\xff.yaml", "--json"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_EQ(json::parse(result.out)["files"][0]["ok"], false);
    EXPECT_EQ(json::parse(scanmill_program({"info", "no-such-\xff.ply", "--json"}).out)["files"].size(), 1u);
}

TEST(Json, ShowExample_CarriesTheWorkflow) {
    const json answer = json::parse(scanmill_program({"show", "delaunay", "--example", "--json"}).out);
    EXPECT_EQ(answer["filter"], "delaunay");
    EXPECT_EQ(answer["example"], scanmill_program({"show", "delaunay", "--example"}).out);
}

TEST(Json, PlanFormatWithoutPlan_IsRefused) {
    const ProgramResult result = scanmill_program({"check", shipped("quickstart.yaml"), "--format", "dot"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("--plan"));
}

}  // namespace
}  // namespace scanmill::test
