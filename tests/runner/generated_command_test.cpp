// SPDX-License-Identifier: GPL-3.0-or-later
// What the program writes about itself: schema, pages, completion.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "support/folders.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(SchemaCommand, PrintsAndWritesTheSame) {
    const TemporaryFolder folder;
    const ProgramResult printed = scanmill_program({"schema"});
    EXPECT_EQ(printed.exit_code, 0);
    EXPECT_TRUE(json::parse(printed.out)["definitions"]["step"]["properties"].contains("voxel-thin"));
    EXPECT_EQ(scanmill_program({"schema", "-o", (folder / "new").string()}).exit_code, 0);
    EXPECT_EQ(content_of(folder / "new/workflow.schema.json"), printed.out);
    EXPECT_EQ(scanmill_program({"schema", "workflow"}).out, printed.out);
    const ProgramResult of_batches = scanmill_program({"schema", "batch"});
    EXPECT_TRUE(json::parse(of_batches.out)["properties"].contains("limits"));
    EXPECT_EQ(content_of(folder / "new/batch.schema.json"), of_batches.out);
    EXPECT_EQ(scanmill_program({"schema", "nothing"}).exit_code, 2);
}

TEST(SchemaCommand, FolderThatCannotBeMade_IsOneSentence) {
    const TemporaryFolder folder;
    folder.write("file", "x");
    const ProgramResult refused = scanmill_program({"schema", "-o", (folder / "file/below").string()});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("cannot be made"));
}

TEST(DocsCommand, WritesAPageForEveryFilter) {
    const TemporaryFolder folder;
    EXPECT_EQ(scanmill_program({"docs", "-o", folder.path().string()}).exit_code, 0);
    const json filters = json::parse(scanmill_program({"list", "--json"}).out)["filters"];
    for (const json& filter : filters) {
        const std::string name = filter["name"];
        const std::string page = content_of(folder / (name + ".md"));
        EXPECT_TRUE(page.starts_with("# " + name + "\n")) << name;
        for (const json& parameter : filter["parameters"]) {
            EXPECT_THAT(page, HasSubstr("`" + parameter["name"].get<std::string>() + "`"));
            EXPECT_THAT(page, HasSubstr(parameter["help"].get<std::string>()));
        }
        EXPECT_THAT(content_of(folder / "README.md"), HasSubstr("[" + name + "](" + name + ".md)"));
    }
}

TEST(DocsCommand, FilesOfOthers_AreNotReplaced_AndNothingIsWritten) {
    const TemporaryFolder folder;
    folder.write("README.md", "mine\n");
    const ProgramResult refused = scanmill_program({"docs", "-o", folder.path().string()});
    EXPECT_EQ(refused.exit_code, 2);
    EXPECT_THAT(refused.err, HasSubstr("README.md' exists and was not written by scanmill docs"));
    EXPECT_EQ(content_of(folder / "README.md"), "mine\n");
    EXPECT_EQ(folder.files(), 1u);
}

/// What bash proposes behind `scanmill` and these words.
std::string completed(const TemporaryFolder& folder, const std::string& words, int index) {
    folder.write("complete", scanmill_program({"completion", "bash"}).out + "COMP_WORDS=(scanmill " + words +
                                 ")\nCOMP_CWORD=" + std::to_string(index) +
                                 "\n_scanmill\nprintf '%s ' \"${COMPREPLY[@]}\" | sed 's/ $//'; echo\n");
    const std::string programs = std::filesystem::path(test::program_file()).parent_path().string();
    const std::string command = "PATH=\"" + programs + ":$PATH\" bash '" + (folder / "complete").string() + "' > '" +
                                (folder / "proposals").string() + "'";
    EXPECT_EQ(std::system(command.c_str()), 0);
    return content_of(folder / "proposals");
}

TEST(Completion, Bash_ProposesCommandsOptionsAndFilters) {
    const TemporaryFolder folder;
    EXPECT_EQ(completed(folder, "sh", 1), "show\n");
    EXPECT_EQ(completed(folder, "run --un", 2), "--unit --until\n");
    EXPECT_EQ(completed(folder, "show vox", 2), "voxel-thin\n");
    EXPECT_EQ(completed(folder, "completion f", 2), "fish\n");
    EXPECT_EQ(completed(folder, "schema w", 2), "workflow\n");
}

TEST(Completion, Bash_ProposesReadyWorkflowsAsTheFirstArgument) {
    const TemporaryFolder folder;
    for (const std::string command : {"run", "batch", "check"})
        EXPECT_EQ(completed(folder, command + " raw-sc", 2), "raw-scans\n") << command;
    EXPECT_EQ(completed(folder, "run quickstart raw-sc", 3), "\n");
}

TEST(Completion, Bash_ProposesTheValuesOfOptions) {
    const TemporaryFolder folder;
    EXPECT_EQ(completed(folder, "run w.yaml --keep ''", 4), "worth always never\n");
    EXPECT_EQ(completed(folder, "run w.yaml --keep a", 4), "always\n");
    EXPECT_EQ(completed(folder, "run w.yaml --keep = n", 5), "never\n");
    EXPECT_EQ(completed(folder, "check --format d", 3), "dot\n");
    EXPECT_EQ(completed(folder, "convert --unit c", 3), "cm\n");
}

TEST(Completion, Bash_ProposesTheParametersOfTheWorkflow) {
    const TemporaryFolder folder;
    const std::string run = "run '" +
                            folder
                                .write("w.yaml",
                                       "scanmill: 1\ninputs: {scan: points, truth: mesh}\n"
                                       "parameters: {size: 1 u, exact: true, size-of-bins: auto}\n"
                                       "steps:\n  - voxel-thin: {bin-size: $size-of-bins, tolerance: $size}\n"
                                       "  - measure: {certify: $exact}\n    in: {mesh: truth, truth: scan}\n")
                                .string() +
                            "' --set ";
    EXPECT_EQ(completed(folder, run + "''", 4), "exact= size-of-bins= size=\n");
    EXPECT_EQ(completed(folder, run + "e", 4), "exact=\n");
    EXPECT_EQ(completed(folder, run + "exact =", 5), "false true\n");
    EXPECT_EQ(completed(folder, run + "exact = t", 6), "true\n");
    EXPECT_EQ(completed(folder, run + "size-of-bins = ''", 6), "auto\n");
    EXPECT_EQ(completed(folder, "measure a.ply b.ply --set cert", 5), "certify=\n");
}

TEST(Completion, ZshAndFish_ProposeValuesToo) {
    const std::string zsh = scanmill_program({"completion", "zsh"}).out;
    EXPECT_THAT(zsh, HasSubstr(":value:(worth always never)"));
    EXPECT_THAT(zsh, HasSubstr(":value:_scanmill_settings"));
    const std::string fish = scanmill_program({"completion", "fish"}).out;
    EXPECT_THAT(fish, HasSubstr("-l keep -x -a 'worth always never'"));
    EXPECT_THAT(fish, HasSubstr("-l set -x -a '(scanmill complete-set"));
}

TEST(Completion, Bash_ProposesFilesWithBlanksWhole) {
    const TemporaryFolder folder;
    const std::filesystem::path file = folder.write("my scan.ply", "");
    folder.write("my notes.txt", "");
    const std::string word = "\"" + (folder / "my s").string() + "\"";
    EXPECT_EQ(completed(folder, "info " + word, 2), file.string() + "\n");
}

TEST(Completion, EveryShell_HasEveryCommand) {
    for (const char* shell : {"bash", "zsh", "fish"}) {
        const ProgramResult script = scanmill_program({"completion", shell});
        EXPECT_EQ(script.exit_code, 0);
        for (const char* command : {"run", "check", "list", "show", "info", "convert", "schema", "docs", "completion"})
            EXPECT_THAT(script.out, HasSubstr(command)) << shell;
    }
    EXPECT_EQ(scanmill_program({"completion", "tcsh"}).exit_code, 2);
}

}  // namespace
}  // namespace scanmill::test
