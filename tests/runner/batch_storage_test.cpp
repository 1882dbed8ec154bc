// SPDX-License-Identifier: GPL-3.0-or-later
// Disks that fill up, caches that are shared or may not be written, files and clocks that change.

#include <SQLiteCpp/SQLiteCpp.h>

#include <array>
#include <chrono>
#include <thread>

#include "runner/faults_fixture.hpp"
#include "support/folders.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::IsEmpty;

class Storage : public FaultyBatch {};

TEST_F(Storage, TwoBatchesOnOneCache_DoNotDisturbEachOther) {
    write_workflow();
    write_scans("scan", 6);
    write_batch("scans/*.xyz");
    RunningProgram one({"batch", "b.yaml", "-o", "one", "-j", "2", "--keep", "always"}, options());
    RunningProgram two({"batch", "b.yaml", "-o", "two", "-j", "2", "--keep", "always"}, options());
    EXPECT_EQ(one.wait().exit_code, 0);
    EXPECT_EQ(two.wait().exit_code, 0);
    EXPECT_EQ(outputs("one").size(), 24u);
    EXPECT_EQ(outputs("one"), outputs("two"));
}

TEST_F(Storage, ScanChangedAfterPlanning_FailsAndIsNotTakenForTheOld) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("{path: scans/scan_01.xyz, set: {mode: loop}}, scans/scan_02.xyz, scans/scan_03.xyz",
                "limits: {step: {time: 1 s}}\n");
    RunningProgram batch({"batch", "b.yaml", "-o", "out", "-j", "1"}, options());
    while (!batch.has_ended() && batch.err().find("scan_01.xyz: shared") == std::string::npos)
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    folder_.write("scans/scan_02.xyz", "7 7 7\n8 8 8\n9 9 7\n");
    std::filesystem::remove(folder_ / "scans/scan_03.xyz");
    const ProgramResult result = batch.wait();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, AllOf(HasSubstr("scan_02.xyz' changed during the run"), HasSubstr("scan_03.xyz")));
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "outcome", "failed"), 3u);
    EXPECT_THAT(outputs(), IsEmpty());
}

TEST_F(Storage, ReadOnlyCache_WarnsOnceAndIsRead) {
    write_workflow();
    write_scans("scan", 2);
    write_batch("scans/*.xyz");
    std::filesystem::create_directory(folder_ / "locked");
    std::filesystem::permissions(folder_.path(), std::filesystem::perms::all);
    std::filesystem::permissions(folder_ / "locked",
                                 std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec |
                                     std::filesystem::perms::others_read | std::filesystem::perms::others_exec);
    ProgramOptions unprivileged = options();
    unprivileged.without_rights = true;
    const ProgramResult result =
        scanmill_program({"batch", "b.yaml", "-o", "out", "-j", "2", "--cache", "locked"}, unprivileged);
    if (result.exit_code > 100) GTEST_SKIP() << "the program may not be run without root's rights here";
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(outputs().size(), 8u);
    EXPECT_THAT(result.err, HasSubstr("does not store new results"));
    EXPECT_EQ(result.err.find("does not store"), result.err.rfind("does not store")) << "several workers, one sentence";
}

TEST_F(Storage, FilesThatMayNotGrow_FailWhatCannotBeWritten) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs: "
                  "{'{scan}.ply': test-step.points}\n");
    write_scans("scan", 1);
    std::string many;
    for (int i = 0; i < 20000; ++i) many += fmt::format("{} {} {}\n", i, i % 7, i % 11);
    folder_.write("scans/scan_02.xyz", many);
    write_batch("scans/*.xyz");
    ProgramOptions limited = options();
    limited.file_limit = 200'000;
    const ProgramResult result = scanmill_program({"batch", "b.yaml", "-o", "out", "--keep", "always"}, limited);
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, AllOf(HasSubstr("scan_02.xyz"), HasSubstr("cannot be passed to the next step"),
                                  HasSubstr("TMPDIR"), HasSubstr("does not store new results")));
    EXPECT_EQ(outputs().size(), 1u) << "the small one, and nothing half-written";
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "cause", "output"), 1u);
    ASSERT_EQ(run_batch().exit_code, 0) << "once there is room";
    EXPECT_EQ(outputs().size(), 2u);
}

TEST_F(Storage, RecordsThatCannotGrow_AreToldAndTheRunGoesOn) {
    write_workflow("1");
    write_scans("scan", 3);
    write_batch("scans/*.xyz");
    ProgramOptions limited = options();
    limited.file_limit = 20'000;
    const ProgramResult result = scanmill_program({"batch", "b.yaml", "-o", "out"}, limited);
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.err, HasSubstr("recorded"));
    EXPECT_EQ(outputs().size(), 3u + std::filesystem::exists(folder_ / "out/scanmill.sqlite-journal"));
}

/// A batch runs whatever became of the records of earlier nights, and leaves them as they are.
TEST_F(Storage, RecordsThatCannotBeUsed_AreReportedAndLeftAlone) {
    write_workflow("1");
    write_scans("scan", 2);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch().exit_code, 0);
    const std::string good = content_of(folder_ / "out/scanmill.sqlite");
    std::string newer = good;
    newer[63] = 99;  // the last byte of the number of its layout
    const std::vector<std::array<std::string, 3>> all{
        {"newer", newer, "another layout"},
        {"truncated", good.substr(0, good.size() / 2), "malformed"},
        {"text", "another program's file, long enough to be taken for a database of its own kind", "not a database"}};
    for (const auto& [what, bytes, sentence] : all) {
        SCOPED_TRACE(what);
        folder_.write("out/scanmill.sqlite", bytes);
        const ProgramResult batch = run_batch();
        EXPECT_EQ(batch.exit_code, 0);
        EXPECT_THAT(batch.err, AllOf(HasSubstr("this run is not recorded: the records 'out/scanmill.sqlite'"),
                                     HasSubstr(sentence)));
        EXPECT_EQ(outputs().size(), 2u);
        EXPECT_EQ(content_of(folder_ / "out/scanmill.sqlite"), bytes);
        const ProgramResult runs = scanmill({"runs", "out"});
        EXPECT_EQ(runs.exit_code, 2);
        EXPECT_THAT(runs.err, HasSubstr(sentence));
    }
}

TEST_F(Storage, RecordsOnAReadOnlyDisk_AreRead) {
    write_workflow("1");
    write_scans("scan", 1);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch().exit_code, 0);
    using std::filesystem::perms;
    const perms read_only = perms::owner_read | perms::owner_exec | perms::group_read | perms::group_exec |
                            perms::others_read | perms::others_exec;
    std::filesystem::create_directories(folder_ / "home");
    ProgramOptions unprivileged = options();
    unprivileged.without_rights = true;
    {
        std::filesystem::permissions(folder_.path(), perms::all);
        std::filesystem::permissions(folder_ / "out/scanmill.sqlite",
                                     perms::owner_read | perms::group_read | perms::others_read);
        std::filesystem::permissions(folder_ / "out", read_only);
        const std::string before = content_of(folder_ / "out/scanmill.sqlite");
        const ProgramResult runs = scanmill_program({"runs", "out", "--json"}, unprivileged);
        const ProgramResult batch = scanmill_program({"batch", "b.yaml", "-o", "out"}, unprivileged);
        std::filesystem::permissions(folder_ / "out", perms::all);
        if (runs.exit_code > 100) GTEST_SKIP() << "the program may not be run without root's rights here";
        EXPECT_EQ(runs.exit_code, 0) << runs.err;
        EXPECT_EQ(Json::parse(runs.out)["runs"].size(), 1u);
        EXPECT_EQ(content_of(folder_ / "out/scanmill.sqlite"), before);
        EXPECT_EQ(batch.exit_code, 2);
        EXPECT_THAT(batch.err, HasSubstr("results cannot be written to 'out'"));
    }
}

TEST_F(Storage, ClockThatMoved_IsNoReasonToTrustOrRunAnything) {
    write_workflow("1");
    write_scans("scan", 2);
    write_batch("scans/*.xyz");
    ASSERT_EQ(run_batch({"--keep", "always"}).exit_code, 0);
    using namespace std::chrono_literals;
    const auto now = std::filesystem::file_time_type::clock::now();
    std::filesystem::last_write_time(folder_ / "scans/scan_01.xyz", now + 24h);
    std::filesystem::last_write_time(folder_ / "scans/scan_02.xyz", now - 24h * 365);
    for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_ / "home"))
        if (entry.is_regular_file()) std::filesystem::last_write_time(entry.path(), now + 48h);
    EXPECT_THAT(run_batch({"--dry-run"}).out, HasSubstr("0 to compute"));
    folder_.write("scans/scan_01.xyz", "7 7 7\n8 8 8\n9 9 7\n");
    std::filesystem::last_write_time(folder_ / "scans/scan_01.xyz", now + 24h);
    EXPECT_THAT(run_batch({"--dry-run"}).out, HasSubstr("3 to compute, 3 cached"));
}

}  // namespace
}  // namespace scanmill::test
