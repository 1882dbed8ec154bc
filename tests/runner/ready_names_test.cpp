// SPDX-License-Identifier: GPL-3.0-or-later
// Ready workflows and batches are found by name, by every command that takes a workflow or a batch.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "support/program.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

class ReadyNames : public testing::Test {
protected:
    ProgramResult scanmill(const std::vector<std::string>& arguments) {
        return scanmill_program(arguments, {.folder = folder_.path()});
    }

    const TemporaryFolder folder_;
};

const std::string own_workflow =
    "scanmill: 1\nname: my-own\ninputs: {scan: points}\nsteps: [voxel-thin: {bin-size: 1 u}]\n";

TEST_F(ReadyNames, EveryReadyName_IsFoundFromAnEmptyFolder) {
    std::size_t found = 0;
    for (const auto& entry : std::filesystem::directory_iterator(source_folder() + "/workflows")) {
        if (entry.path().extension() != ".yaml") continue;
        ++found;
        const std::string name = entry.path().stem().string();
        const ProgramResult result = scanmill({"check", name, "--plan"});
        EXPECT_EQ(result.exit_code, 0) << name << ": " << result.err;
        EXPECT_THAT(result.out, HasSubstr("variant")) << name;
    }
    EXPECT_GT(found, 10u);
}

TEST_F(ReadyNames, SmoothSurfaceOfRawViews_BeginsWithTheStepsOfRawScans) {
    const auto plan = [&](const std::string& name) {
        const std::string out = scanmill({"check", name, "--plan"}).out;
        return out.substr(std::min(out.find("   1. "), out.size()));
    };
    const std::string mesh = plan("raw-scans"), begin = mesh.substr(0, mesh.find("   9. fill-holes"));
    EXPECT_THAT(begin, HasSubstr("   8. repair"));
    EXPECT_THAT(plan("bernardini-1997-raw"), StartsWith(begin));
}

TEST_F(ReadyNames, Nightly_NeedsNoFile) {
    const ProgramResult result = scanmill({"batch", "nightly", "--dry-run", "--no-cache"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr(" 48 cells\n"));
    EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(ReadyNames, MisspeltName_SuggestsTheReadyOne) {
    for (const std::string command : {"run", "batch", "check"}) {
        for (const std::string name : {"raw-scanss", "raw-scanss.yaml"}) {
            const ProgramResult result = scanmill({command, name});
            EXPECT_EQ(result.exit_code, 2) << command;
            EXPECT_THAT(result.err, AllOf(HasSubstr("'" + name + "'"), HasSubstr("did you mean 'raw-scans'"),
                                          HasSubstr("hint: "), HasSubstr("quickstart")))
                << command;
        }
    }
}

TEST_F(ReadyNames, NameOfTheOtherSort_NamesTheCommandForIt) {
    const ProgramResult batch = scanmill({"run", "nightly", "x.ply"});
    EXPECT_EQ(batch.exit_code, 2);
    EXPECT_THAT(batch.err, HasSubstr("scanmill batch nightly"));
    const ProgramResult workflow = scanmill({"batch", "raw-scans"});
    EXPECT_EQ(workflow.exit_code, 2);
    EXPECT_THAT(workflow.err, AllOf(HasSubstr("not a batch"), HasSubstr("scanmill run")));
    const ProgramResult filter = scanmill({"show", "raw-scans"});
    EXPECT_EQ(filter.exit_code, 2);
    EXPECT_THAT(filter.err, HasSubstr("scanmill check raw-scans --plan"));
}

TEST_F(ReadyNames, FolderOfThatName_IsNotTheWorkflow) {
    std::filesystem::create_directory(folder_ / "raw-scans");
    const ProgramResult result = scanmill({"check", "raw-scans", "--plan"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("raw-scans: "));
    EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(ReadyNames, FolderWithoutAReadyName_IsRefusedAsAFolder) {
    std::filesystem::create_directory(folder_ / "scans");
    const ProgramResult result = scanmill({"check", "scans"});
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("is a folder"));
}

TEST_F(ReadyNames, FileOfThatName_IsUsedWithOneWarning) {
    folder_.write("raw-scans", own_workflow);
    const ProgramResult result = scanmill({"check", "raw-scans", "raw-scans", "--plan"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("my-own: "));
    const std::size_t first = result.err.find("warning: ");
    EXPECT_NE(first, std::string::npos);
    EXPECT_EQ(result.err.find("warning: ", first + 1), std::string::npos) << result.err;
    EXPECT_THAT(result.err, HasSubstr("'./raw-scans'"));
    EXPECT_THAT(scanmill({"check", "./raw-scans"}).err, Not(HasSubstr("warning")));
}

TEST_F(ReadyNames, FolderAndYamlFileOfThatName_UseTheReadyOneWithAWarning) {
    std::filesystem::create_directory(folder_ / "raw-scans");
    folder_.write("raw-scans.yaml", own_workflow);
    const ProgramResult ready = scanmill({"check", "raw-scans", "--plan"});
    EXPECT_EQ(ready.exit_code, 0) << ready.err;
    EXPECT_THAT(ready.out, HasSubstr("raw-scans: "));
    EXPECT_THAT(ready.err, AllOf(HasSubstr("warning: "), HasSubstr("'raw-scans.yaml'")));
    const ProgramResult own = scanmill({"check", "raw-scans.yaml", "--plan"});
    EXPECT_THAT(own.out, HasSubstr("my-own: "));
    EXPECT_THAT(own.err, Not(HasSubstr("warning")));
}

class ReadyNamesInABatch : public ReadyNames {
protected:
    ReadyNamesInABatch() { folder_.write("jobs/a.xyz", "0 0 0\n"); }
    ProgramResult check(const std::string& workflow) {
        folder_.write("jobs/b.yaml", "scanmill: 1\nbatch: b\nscans: [a.xyz]\nworkflows: [" + workflow + "]\n");
        return scanmill({"check", "jobs/b.yaml", "--plan"});
    }
};

TEST_F(ReadyNamesInABatch, Name_IsFoundWithoutAFileBesideTheBatch) {
    const ProgramResult result = check("points-with-normals");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("points-with-normals: "));
    EXPECT_THAT(result.err, IsEmpty());
}

TEST_F(ReadyNamesInABatch, YamlFileOfThatName_UsesTheReadyOneWithAWarning) {
    folder_.write("jobs/points-with-normals.yaml", own_workflow);
    const ProgramResult result = check("points-with-normals");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("points-with-normals: "));
    EXPECT_THAT(result.err, AllOf(HasSubstr("jobs/b.yaml:4:13: warning: "), HasSubstr("'points-with-normals.yaml'"),
                                  HasSubstr("in the folder 'jobs'")));
}

TEST_F(ReadyNamesInABatch, FileOfThatNameBesideTheBatch_IsUsedWithAWarning) {
    folder_.write("points-with-normals", "in the current folder, which does not count");
    folder_.write("jobs/points-with-normals", own_workflow);
    const ProgramResult result = check("points-with-normals");
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_THAT(result.out, HasSubstr("my-own: "));
    EXPECT_THAT(result.err, AllOf(HasSubstr("warning: "), HasSubstr("'./points-with-normals'")));
    EXPECT_THAT(check("./points-with-normals").err, Not(HasSubstr("warning")));
}

TEST_F(ReadyNamesInABatch, MisspeltName_SuggestsTheReadyOne) {
    for (const char* name : {"raw-scanss", "raw-scanss.yaml"}) {
        const ProgramResult result = check(name);
        EXPECT_EQ(result.exit_code, 2) << name;
        EXPECT_THAT(result.err, AllOf(HasSubstr("jobs/b.yaml:4:13: "), HasSubstr("did you mean 'raw-scans'"))) << name;
    }
}

}  // namespace
}  // namespace scanmill::test
