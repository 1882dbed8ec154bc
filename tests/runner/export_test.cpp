// SPDX-License-Identifier: GPL-3.0-or-later
// The jobs of `export`, run one after the other by a shell: the merged run is that of one machine.

#include "runner/divided_batch.hpp"

#include <fmt/format.h>

#include <cstdlib>
#include <regex>

#include "support/report_page.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Export : public DividedBatch {
protected:
    /// Exports 15 cells in chunks of one unit, with the arguments added.
    ProgramResult exported(const std::string& scheduler, const std::string& batch, const std::string& out,
                           const fs::path& from) {
        return scanmill_program(
            {"export", scheduler, batch, "-o", out, "--minutes", "0.0001", "--program", program_file()},
            {.folder = from, .cache = folder_ / "home"});
    }
    int shell(const std::string& commands) {
        const fs::path script = folder_.write("script.sh", commands);
        return std::system(fmt::format("env XDG_CACHE_HOME='{}' bash '{}' > '{}' 2>&1", (folder_ / "home").string(),
                                       script.string(), (folder_ / "shell.txt").string())
                               .c_str());
    }
    std::size_t chunks(const fs::path& folder) {
        return static_cast<std::size_t>(
            std::distance(fs::directory_iterator(folder / "chunks"), fs::directory_iterator()));
    }
    /// Makes the commands of Slurm write their arguments to calls.txt, each call a line; `sbatch` ends with this.
    void replace_slurm(const std::string& sbatch) {
        fs::create_directories(folder_ / "bin");
        for (const std::string command : {"sbatch", "scontrol", "scancel"})
            fs::permissions(folder_.write("bin/" + command, fmt::format("#!/bin/sh\necho {} \"$@\" >> '{}'\n{}\n",
                                                                        command, (folder_ / "calls.txt").string(),
                                                                        command == "sbatch" ? sbatch : "")),
                            fs::perms::owner_all);
    }
    /// Runs the chunks as Slurm would, the last one first.
    void run_chunks(const fs::path& folder) {
        std::string commands = fmt::format("cd '{}'\nexport SLURM_CPUS_PER_TASK=1\n", folder.string());
        for (std::size_t chunk = chunks(folder); chunk >= 1; --chunk)
            commands += fmt::format("SLURM_ARRAY_TASK_ID={} sh run.sbatch || exit\n", chunk);
        EXPECT_EQ(shell(commands), 0) << content_of(folder_ / "shell.txt");
    }
    int run_merge(const fs::path& folder) {
        return WEXITSTATUS(shell(fmt::format("cd '{}'\nsh merge.sbatch\n", folder.string())));
    }
    /// Runs the commands of the Snakefile, as Snakemake would.
    void run_with_snakemake(const fs::path& folder) {
        const std::string file = content_of(folder / "Snakefile");
        std::vector<std::string> commands;
        static const std::regex shell_line("    shell: (\".*\")");
        for (std::sregex_iterator found(file.begin(), file.end(), shell_line), end; found != end; ++found)
            commands.push_back(nlohmann::json::parse((*found)[1].str()).get<std::string>());
        ASSERT_EQ(commands.size(), 3u);
        const auto run = [&](std::string command, const std::string& chunk) {
            command = std::regex_replace(command, std::regex("\\{wildcards\\.chunk\\}"), chunk);
            command = std::regex_replace(command, std::regex("\\{(threads|resources\\.attempt)\\}"), "1");
            command = std::regex_replace(command, std::regex("\\{log\\}"), "logs/" + chunk + ".txt");
            command = std::regex_replace(command, std::regex("\\{\\{"), "{");
            command = std::regex_replace(command, std::regex("\\}\\}"), "}");
            EXPECT_EQ(shell(fmt::format("cd '{}'\n{}\n", folder.string(), command)), 0)
                << command << content_of(folder / "logs" / (chunk + ".txt"));
        };
        for (std::size_t chunk = 1; chunk <= chunks(folder); ++chunk) run(commands[0], fmt::format("{:04}", chunk));
        run(commands[1], "merge");
        run(commands[2], "report");
    }
};

TEST_F(Export, JobsGiveTheOutputsAndDescriptionsOfOneRun_HoweverTheBatchIsNamed) {
    fs::create_directories(folder_ / "elsewhere");
    const std::vector<std::pair<std::string, fs::path>> names{
        {"b.yaml", folder_.path()},
        {"../b.yaml", folder_ / "elsewhere"},
        {(folder_ / "b.yaml").string(), folder_ / "elsewhere"},
    };
    int number = 0;
    for (const auto& [name, from] : names) {
        SCOPED_TRACE(name);
        const std::string one = fmt::format("one{}", ++number), many = fmt::format("ma{{n}}y CHUNK {}", number);
        scanmill_program({"batch", name, "-o", (folder_ / one).string(), "-q", "--no-cache"},
                         {.folder = from, .cache = folder_ / "home"});
        const auto expected = outputs(one);
        ASSERT_GE(expected.size(), 2u * 8);
        EXPECT_THAT(expected.at("s1-bin-size=0.1u.ply.json"), HasSubstr("scans/s1.xyz"));
        for (const std::string scheduler : {"slurm", "snakemake"}) {
            SCOPED_TRACE(scheduler);
            const fs::path folder = folder_ / (many + scheduler);
            const ProgramResult result = exported(scheduler, name, folder.string(), from);
            ASSERT_EQ(result.exit_code, 0) << result.err;
            ASSERT_EQ(chunks(folder), 8u);
            if (scheduler == "slurm") {
                run_chunks(folder);
                run_merge(folder);
            } else {
                run_with_snakemake(folder);
            }
            const std::string whole = many + scheduler + "/result";
            auto found = outputs(whole);
            std::erase_if(found, [](const auto& file) {  // leaves out what the report adds
                return file.first == "report.html" || file.first.starts_with("previews/");
            });
            EXPECT_THAT(differences(found, expected), testing::IsEmpty()) << content_of(folder_ / "shell.txt");
            EXPECT_EQ(report(whole), report(one));
        }
    }
}

TEST_F(Export, ChunkOutOfMemory_FailsAndIsSubmittedAgainWithTwiceTheMemory) {
    folder_.write("k.yaml",
                  "scanmill: 1\nname: k\ninputs: {scan: points}\nparameters: {mode: pass}\nsteps:\n"
                  "  - test-step: {mode: $mode}\noutputs: {'{scan}.ply': test-step.points}\n");
    folder_.write("killed.yaml",
                  "scanmill: 1\nbatch: killed\nscans: [scans/s0.xyz, {path: scans/s1.xyz, set: {mode: kill}}]\n"
                  "workflows: k.yaml\n");
    ASSERT_EQ(scanmill({"export", "slurm", "killed.yaml", "-o", "cluster", "--minutes", "0.0001", "--program",
                        program_file()})
                  .exit_code,
              0);
    const fs::path calls = folder_ / "calls.txt";
    replace_slurm("echo 7");
    const auto job = [&](const std::string& command) {
        return WEXITSTATUS(shell(fmt::format("cd '{}'\nexport SLURM_CPUS_PER_TASK=1 PATH='{}':$PATH {}\n{}\n",
                                             (folder_ / "cluster").string(), (folder_ / "bin").string(),
                                             environment_.front(), command)));
    };
    EXPECT_EQ(job("SLURM_ARRAY_TASK_ID=1 sh run.sbatch"), 0);
    EXPECT_EQ(job("SLURM_ARRAY_TASK_ID=2 sh run.sbatch"), 5) << content_of(folder_ / "shell.txt");
    const nlohmann::json chunks =
        nlohmann::json::parse(scanmill({"batch", "--status", "cluster", "--json"}).out)["chunks"];
    EXPECT_EQ(chunks[0]["state"], "done");
    EXPECT_EQ(chunks[1]["state"], "failed");

    EXPECT_EQ(job("sh merge.sbatch 400"), 0) << content_of(folder_ / "shell.txt");
    EXPECT_THAT(content_of(calls), HasSubstr("--array=2 --mem=800M run.sbatch"));
    EXPECT_THAT(content_of(calls), HasSubstr("merge.sbatch 800"));
    EXPECT_THAT(content_of(calls), HasSubstr("scontrol release 7\n"));
    EXPECT_FALSE(fs::exists(folder_ / "cluster/result"));

    EXPECT_EQ(job("sh merge.sbatch 1000000"), 1) << "after the last attempt, the report shows the failure";
    EXPECT_THAT(content_of(folder_ / "shell.txt"), HasSubstr("out of memory or disk in chunks 2;"));
    EXPECT_TRUE(fs::exists(folder_ / "cluster/result/s0.ply"));
}

TEST_F(Export, RefusedMerge_CancelsTheChunksBeforeTheyRun) {
    ASSERT_EQ(exported("slurm", "b.yaml", "clu 'ster", folder_.path()).exit_code, 0);
    replace_slurm("case \"$*\" in *merge.sbatch*) exit 1 ;; *) echo 7 ;; esac");
    EXPECT_NE(shell(fmt::format("cd '{0}'\nPATH='{0}/bin':$PATH \"clu 'ster/submit.sh\" 3\n", folder_.path().string())),
              0);
    EXPECT_THAT(content_of(folder_ / "shell.txt"), HasSubstr("the merge was refused, so the chunks were cancelled"));
    EXPECT_THAT(content_of(folder_ / "calls.txt"),
                testing::AllOf(HasSubstr("--hold --array=3 run.sbatch"), testing::EndsWith("scancel 7\n")));
}

/// The page is the last part of the job, so its failure must not hide behind a good merge.
TEST_F(Export, PageThatCannotBeWritten_FailsTheJob) {
    if (!has_report_page()) GTEST_SKIP() << no_report_page;
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: 0.1 u}\n"
                  "outputs: {'{scan}.ply': voxel-thin}\n");
    ASSERT_EQ(exported("slurm", "b.yaml", "cluster", folder_.path()).exit_code, 0);
    fs::create_directories(folder_ / "cluster/result/report.html");
    run_chunks(folder_ / "cluster");
    EXPECT_NE(run_merge(folder_ / "cluster"), 0);
    EXPECT_THAT(content_of(folder_ / "shell.txt"), HasSubstr("report.html' exists and is not a page"));
    EXPECT_TRUE(fs::exists(folder_ / "cluster/result/s0.ply"));
}

TEST_F(Export, MissingProgram_GivesOneSentenceAndAFailedChunk) {
    ASSERT_EQ(scanmill({"export", "slurm", "b.yaml", "-o", "cluster", "--program", "no-scanmill"}).exit_code, 0);
    EXPECT_NE(
        shell(fmt::format("cd '{}'\nSLURM_CPUS_PER_TASK=1 SLURM_ARRAY_TASK_ID=1 SLURMD_NODENAME=n4 sh run.sbatch\n",
                          (folder_ / "cluster").string())),
        0);
    EXPECT_THAT(content_of(folder_ / "shell.txt"), HasSubstr("error: n4 cannot run no-scanmill; install"));
    EXPECT_EQ(nlohmann::json::parse(scanmill({"batch", "--status", "cluster", "--json"}).out)["chunks"][0]["state"],
              "failed");
}

/// Snakemake goes by its marks, which a chunk has after its last attempt, too.
TEST_F(Export, StatusOfSnakemake_PrintsACommandThatRemovesTheMarksOfFailedChunks) {
    ASSERT_EQ(exported("snakemake", "b.yaml", "sf", folder_.path()).exit_code, 0);
    fs::create_directories(folder_ / "sf/parts/0002");
    EXPECT_THAT(scanmill({"batch", "--status", "sf"}).out,
                HasSubstr("rm -f sf/done/0002 sf/done/merge sf/done/report; snakemake -s sf/Snakefile -j 4\n"));
}

/// The chunk is checked before a scan is opened.
TEST_F(Export, NodeWithoutAModule_NamesTheFilterAndTheChunkIsFailed) {
    folder_.write(
        "step.yaml",
        "scanmill: 1\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs:\n  \"{scan}.ply\": test-step\n");
    folder_.write("step-batch.yaml", "scanmill: 1\nbatch: step\nscans: [\"scans/*\"]\nworkflows: [step.yaml]\n");
    const ProgramResult exported =
        scanmill_program({"export", "slurm", "step-batch.yaml", "-o", "cluster", "--program", program_file()},
                         {.folder = folder_.path(), .environment = {"SCANMILL_PLUGIN_PATH=" + test_plugin_folder()}});
    ASSERT_EQ(exported.exit_code, 0) << exported.err;
    EXPECT_NE(shell(fmt::format("cd '{}'\nSLURM_CPUS_PER_TASK=1 SLURM_ARRAY_TASK_ID=1 sh run.sbatch\n",
                                (folder_ / "cluster").string())),
              0);
    EXPECT_THAT(content_of(folder_ / "shell.txt"), HasSubstr("filter 'test-step'; `scanmill list`"));
    EXPECT_EQ(nlohmann::json::parse(scanmill({"batch", "--status", "cluster", "--json"}).out)["chunks"][0]["state"],
              "failed");
}

TEST_F(Export, RecordedCosts_AreFoundFromAnotherFolder) {
    scanmill({"batch", "b.yaml", "-o", "one", "-q", "--no-cache"});
    fs::create_directories(folder_ / "elsewhere");
    const ProgramResult result = scanmill_program(
        {"export", "slurm", "../b.yaml", "-o", "cluster", "--records", "../one", "--dry-run", "--json"},
        {.folder = folder_ / "elsewhere"});
    ASSERT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(nlohmann::json::parse(result.out)["estimated-units"], 0) << result.out;
}

}  // namespace
}  // namespace scanmill::test
