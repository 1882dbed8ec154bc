// SPDX-License-Identifier: GPL-3.0-or-later
// `scanmill check` on batch files.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>
#include <utility>

#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::IsEmpty;

class CheckOfABatch : public testing::Test {
protected:
    CheckOfABatch() {
        for (const char* scan : {"a.xyz", "b.xyz", "c.xyz"}) folder_.write(std::string("scans/") + scan, "0 0 0\n");
        folder_.write("thin.yaml",
                      "scanmill: 1\ninputs: {scan: points}\nparameters: {size: 1 u}\nsteps: [{voxel-thin: {bin-size: "
                      "$size}}]\n");
        folder_.write("merge.yaml", "scanmill: 1\ninputs: {scans: [points]}\nsteps: [{merge: }]\n");
    }
    ProgramResult check(const std::string& batch, std::vector<std::string> options = {}) {
        folder_.write("nightly.yaml", batch);
        options.insert(options.begin(), {"check", "nightly.yaml"});
        return scanmill_program(options, {.folder = folder_.path()});
    }
    static std::string with_size(const std::string& size) {
        return "scanmill: 1\nbatch: nightly\nscans: [scans/*.xyz]\nworkflows: [thin.yaml, merge.yaml]\nset: {size: " +
               size + "}\n";
    }

    TemporaryFolder folder_;
};

TEST_F(CheckOfABatch, SaysHowManyOfWhat) {
    const ProgramResult found = check(with_size("{sweep: [1 u, 2 u, 3 u]}"));
    EXPECT_EQ(found.exit_code, 0);
    EXPECT_EQ(found.out, "nightly.yaml: ok, 3 scans, 2 workflows, 4 variants, 10 cells\n");
    EXPECT_THAT(found.err, IsEmpty());
}

TEST_F(CheckOfABatch, TwoScansThatWriteOneFile_AreFoundWithoutReadingThem) {
    folder_.write("ok.yaml",
                  "scanmill: 1\ninputs: {scan: points}\nsteps: [{voxel-thin: {bin-size: 1 u}}]\noutputs: "
                  "{'{scan}.ply': voxel-thin}\n");
    folder_.write("scans/ok.ply", "no PLY file");
    folder_.write("scans/ok.pcd", "no PCD file");
    const ProgramResult found = check("scanmill: 1\nbatch: nightly\nscans: [scans/ok.*]\nworkflows: ok.yaml\n");
    EXPECT_EQ(found.exit_code, 2);
    EXPECT_THAT(found.err, AllOf(HasSubstr("nightly.yaml:3:9: scan 'scans/ok.pcd' under variant 'default' and scan "
                                           "'scans/ok.ply' under variant 'default' would both write 'ok.ply'"),
                                 HasSubstr("rename one of the scans")));
}

TEST_F(CheckOfABatch, OutputWhereThatOfAnotherWorkflowIsWrittenIfItFails_IsFound) {
    for (const auto& [name, output] : {std::pair("one", "{scan}.ply"), std::pair("two", "failed/{scan}.ply")})
        folder_.write(std::string(name) + ".yaml",
                      std::string("scanmill: 1\nname: ") + name +
                          "\ninputs: {scan: points}\nsteps: [{voxel-thin: {bin-size: 1 u}}]\noutputs: {'" + output +
                          "': voxel-thin}\n");
    const std::string head = "scanmill: 1\nbatch: nightly\nscans: [scans/a.xyz]\nworkflows: ";
    const ProgramResult found = check(head + "[one.yaml, two.yaml]\n");
    EXPECT_EQ(found.exit_code, 2);
    EXPECT_THAT(found.err, AllOf(HasSubstr("nightly.yaml:3:9: "), HasSubstr("of workflow 'one', if it fails, and "),
                                 HasSubstr("would both write 'failed/a.ply'; put {workflow} into the output's name")));
    EXPECT_EQ(check(head + "two.yaml\n").exit_code, 0);
}

TEST_F(CheckOfABatch, PlanOfEveryPart_IsPrinted) {
    EXPECT_THAT(check(with_size("{sweep: [1 u, 2 u]}"), {"--plan"}).out,
                AllOf(HasSubstr("variant size=2u"), HasSubstr("merge.yaml: 1 step, 1 variant")));
    const json files = json::parse(check(with_size("2 u"), {"--plan", "--json"}).out)["files"];
    ASSERT_EQ(files.size(), 3u);
    EXPECT_EQ(files[0]["file"], "nightly.yaml");
    EXPECT_EQ(files[1]["plan"]["steps"].size(), 1u);
    EXPECT_TRUE(files[2].contains("plan"));
}

TEST_F(CheckOfABatch, BadValue_StandsInTheBatch) {
    const ProgramResult found = check(with_size("2 yard"));
    EXPECT_EQ(found.exit_code, 2);
    EXPECT_THAT(found.err, ContainsRegex("nightly.yaml:5:13: .size .*bin-size of voxel-thin.*'yard'"));
    EXPECT_THAT(found.out, IsEmpty());
    const json answer = json::parse(check(with_size("2 yard"), {"--json"}).out);
    EXPECT_EQ(answer["files"][0]["ok"], false);
    EXPECT_EQ(answer["files"][0]["diagnostics"][0]["line"], 5);
    EXPECT_EQ(answer["files"][1]["ok"], true);
}

TEST_F(CheckOfABatch, SettingsOfTheCommandLine_DoNotReachIt) {
    const ProgramResult found = check(with_size("2 u"), {"--set", "size=1 u"});
    EXPECT_EQ(found.exit_code, 2);
    EXPECT_THAT(found.err, HasSubstr("--set does not apply to the batch"));
}

TEST_F(CheckOfABatch, PathsOfItsValues_CountFromItsFolder) {
    folder_.write(
        "posed.yaml",
        "scanmill: 1\ninputs: {scans: [points]}\nparameters: {poses: none}\nsteps: [{merge: {poses: $poses}}]\n");
    folder_.write("sub/b.yaml",
                  "scanmill: 1\nbatch: b\nscans: [../scans/*.xyz]\nworkflows: ../posed.yaml\nset: {poses: p.json}\n");
    const ProgramResult found = scanmill_program({"check", "sub/b.yaml", "--plan"}, {.folder = folder_.path()});
    EXPECT_EQ(found.exit_code, 0) << found.err;
    EXPECT_THAT(found.out, HasSubstr("poses: sub/p.json"));
}

}  // namespace
}  // namespace scanmill::test
