// SPDX-License-Identifier: GPL-3.0-or-later
// `report` on records written by hand: what it prints, its exit codes, acceptances, and every refusal.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <nlohmann/json.hpp>

#include "engine/compare/made_runs.hpp"
#include "scanmill/records/run_records.hpp"
#include "support/program.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using nlohmann::json;
using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;
using testing::StartsWith;

class ReportCommand : public testing::Test {
protected:
    ProgramResult scanmill(const std::vector<std::string>& arguments) {
        return scanmill_program(arguments, {.folder = folder_.path(), .cache = folder_ / "home"});
    }
    ProgramResult report(std::vector<std::string> arguments = {}) {
        arguments.insert(arguments.begin(), {"report", "out"});
        return scanmill(arguments);
    }
    /// Appends the run to the records in a folder, and returns its number. `outcome` empty: it does not end.
    std::int64_t record(const RunDetails& run, const std::string& folder = "out", const std::string& outcome = "ok") {
        std::filesystem::create_directories(folder_ / folder);
        RunRecords records = RunRecords::append_to(folder_ / folder / records_file);
        const std::int64_t id = records.begin(run.start);
        if (outcome.empty())
            records.add(id, run.steps, run.cells);
        else
            records.end(id, run.steps, run.cells, outcome, 12);
        return id;
    }
    ProgramResult accept(const std::string& run) {
        return report({"--accept", "--run", run, "--who", "Ann", "--why", "a new scanner"});
    }

    TemporaryFolder folder_;
};

const std::vector<GateRule> rules{{"hausdorff", "+1 %", {}}};

TEST_F(ReportCommand, TheFirstNight_IsNew) {
    record(run_of_one(1, 0.5, rules));
    const ProgramResult result = report();
    EXPECT_EQ(result.exit_code, 0);
    EXPECT_THAT(result.out, AllOf(StartsWith("nightly: new\n1 cell: 1 new\n"), HasSubstr("no run was accepted yet"),
                                  ContainsRegex("hausdorff  \\+1 %  default +1  0.5 mm +- +0\n")));
}

TEST_F(ReportCommand, ARegression_TripsTheGate) {
    record(run_of_one(1, 0.5, rules));
    EXPECT_EQ(accept("1").exit_code, 0);
    record(run_of_one(2, 0.5, rules));
    EXPECT_EQ(report().exit_code, 0);
    EXPECT_THAT(report().out, StartsWith("nightly: passed\n"));
    record(run_of_one(3, 0.75, rules));
    const ProgramResult tripped = report();
    EXPECT_EQ(tripped.exit_code, 4);
    EXPECT_THAT(tripped.out, AllOf(StartsWith("nightly: regressed\n"), HasSubstr("accepted by Ann: a new scanner"),
                                   HasSubstr("+50 %"), ContainsRegex("hausdorff  \\+1 %  default .*0.75 mm .*1\n"),
                                   HasSubstr("scanmill batch jobs/nightly.yaml --scan scans/a.ply --only default")));
    EXPECT_EQ(report({"--run", "2"}).exit_code, 0);
    EXPECT_EQ(accept("3").exit_code, 0);
    EXPECT_EQ(report().exit_code, 0) << "re-blessed";
    EXPECT_THAT(report().out, HasSubstr("which is the accepted run"));
}

TEST_F(ReportCommand, ARevokedAcceptance_GivesTheOneBefore) {
    record(run_of_one(1, 0.5, rules));
    record(run_of_one(2, 0.75, rules));
    accept("1");
    accept("2");
    EXPECT_EQ(report().exit_code, 0);
    const ProgramResult revoked = report({"--revoke", "--who", "Bob", "--why", "by mistake"});
    EXPECT_EQ(revoked.exit_code, 0);
    EXPECT_EQ(revoked.out, "run 1 is the accepted run of nightly again\n");
    EXPECT_EQ(report().exit_code, 4);
    EXPECT_EQ(report({"--revoke", "--who", "Bob", "--why", "this, too"}).out, "no run of nightly is accepted now\n");
    EXPECT_THAT(report().out, StartsWith("nightly: new\n"));
    EXPECT_EQ(report({"--revoke", "--who", "Bob", "--why", "again"}).exit_code, 2) << "nothing is left to revoke";
}

TEST_F(ReportCommand, FailedAndDoubtfulCells_DecideTheExitCode) {
    RunDetails doubtful = run_of_one(1, 0.5, rules);
    doubtful.cells[0].outcome = Outcome::doubtful;
    doubtful.cells[0].doubts = {"alpha is 12 times the spacing"};
    record(doubtful, "out", "doubtful");
    EXPECT_EQ(report().exit_code, 0);
    EXPECT_EQ(report({"--strict"}).exit_code, 1);
    EXPECT_THAT(report().out, HasSubstr("doubtful   scans/a.ply [default]: alpha is 12 times the spacing"));
    RunDetails failed = run_of_one(2, 0.5, rules);
    failed.cells[0].outcome = Outcome::failed;
    failed.cells[0].failure = {Cause::refused, 0, "the file ends too early"};
    record(failed, "out", "failed");
    EXPECT_EQ(report().exit_code, 1);
    // A regression in another cell is the graver news.
    add_cell(failed, "jobs/scans/b.ply", "default", 9);
    RunDetails before = run_of_one(3, 0.5, rules);
    add_cell(before, "jobs/scans/b.ply", "default", 0.5);
    const std::int64_t accepted = record(before);
    accept(std::to_string(accepted));
    record(failed, "out", "failed");
    EXPECT_EQ(report().exit_code, 4);
}

TEST_F(ReportCommand, AcknowledgedDoubts_AreKnown_UntilANewOneComes) {
    const auto night = [](const std::vector<std::string>& doubts) {
        RunDetails run = run_of_one(1, 0.5, rules);
        run.cells[0].outcome = doubts.empty() ? Outcome::ok : Outcome::doubtful;
        run.cells[0].doubts = doubts;
        return run;
    };
    const std::string hole = "fill-holes: 8 % of the surface is new", noise = "region-grow: the surface is rough";
    record(night({hole}), "out", "doubtful");
    EXPECT_THAT(report().out, StartsWith("nightly: doubtful\n"));
    const ProgramResult known =
        report({"--acknowledge", "scans/a.ply", "--who", "Ann", "--why", "the base was not scanned"});
    EXPECT_EQ(known.exit_code, 0) << known.err;
    EXPECT_EQ(known.out, "1 doubt of scans/a.ply [default] is known now\n");
    const ProgramResult after = report({"--strict"});
    EXPECT_EQ(after.exit_code, 0) << "a known doubt does not count";
    EXPECT_THAT(after.out, AllOf(StartsWith("nightly: new\n1 cell: 1 new; the doubts of 1 are known\n"),
                                 HasSubstr("Known doubts\n"), HasSubstr("the base was not scanned")));
    EXPECT_EQ(json::parse(report({"--json"}).out)["report"]["cells"][0]["known"]["who"], "Ann");
    EXPECT_EQ(json::parse(report({"--json"}).out)["report"]["cells"][0]["doubts"][0], hole);
    record(night({hole, noise}), "out", "doubtful");
    EXPECT_EQ(report({"--strict"}).exit_code, 1) << "one doubt is new";
    EXPECT_THAT(report().out, StartsWith("nightly: doubtful\n"));
    report({"--acknowledge", "scans/a.ply [default]", "--who", "Bob", "--why", "looked at it"});
    EXPECT_THAT(report().out, AllOf(StartsWith("nightly: new\n"), HasSubstr("Bob")));
    record(night({noise}), "out", "doubtful");
    EXPECT_THAT(report().out, StartsWith("nightly: new\n")) << "fewer doubts than are known";
    EXPECT_THAT(report({"--format", "markdown"}).out, HasSubstr("**Known doubts**"));
}

TEST_F(ReportCommand, AKnownDoubt_HidesNoRegression) {
    RunDetails run = run_of_one(1, 0.5, rules);
    record(run);
    accept("1");
    run = run_of_one(2, 0.75, rules);
    run.cells[0].outcome = Outcome::doubtful;
    run.cells[0].doubts = {"rough"};
    record(run, "out", "doubtful");
    report({"--acknowledge", "scans/a.ply", "--who", "Ann", "--why", "x"});
    EXPECT_EQ(report().exit_code, 4);
    EXPECT_THAT(report().out, StartsWith("nightly: regressed\n"));
}

TEST_F(ReportCommand, Acknowledge_RefusesWhatIsNotDoubtful) {
    RunDetails run = run_of_one(1, 0.5, rules);
    add_cell(run, "jobs/scans/b.ply").doubts = {"rough"};
    run.cells[1].outcome = Outcome::doubtful;
    record(run, "out", "doubtful");
    const auto refusal = [&](const std::string& cell) {
        const ProgramResult refused = report({"--acknowledge", cell, "--who", "Ann", "--why", "x"});
        EXPECT_EQ(refused.exit_code, 2);
        return refused.err;
    };
    EXPECT_THAT(refusal("scans/a.ply"), AllOf(HasSubstr("the cell 'scans/a.ply' of run 1 has no doubts"),
                                              HasSubstr("cells with doubts are scans/b.ply [default]")));
    EXPECT_THAT(refusal("scans/c.ply"), HasSubstr("run 1 has no cell 'scans/c.ply'"));
    EXPECT_THAT(report({"--acknowledge", "scans/b.ply", "--who", "Ann"}).err, HasSubstr("needs a name and a reason"));
    EXPECT_EQ(report({"--acknowledge", "scans/b.ply", "--accept", "--who", "A", "--why", "x"}).exit_code, 2);
}

TEST_F(ReportCommand, Against_ComparesFolders) {
    record(run_of_one(1, 0.5, rules), "main");
    record(run_of_one(2, 0.6, rules), "main");
    record(run_of_one(1, 0.6, rules));
    EXPECT_EQ(report({"--against", "main"}).exit_code, 0) << "its last run, as none is accepted";
    EXPECT_EQ(report({"--against", "main:1"}).exit_code, 4);
    EXPECT_THAT(report({"--against", "main:1"}).out, HasSubstr("in main"));
    EXPECT_EQ(report({"--against", "out:1"}).exit_code, 0);
    EXPECT_THAT(report({"--against", "main:7"}).err, HasSubstr("there is no run 7 in 'main'"));
    EXPECT_THAT(report({"--against", "main:x"}).err, ContainsRegex("'x' .*number of a run.* DIR:RUN"));
    EXPECT_THAT(report({"--against", "nowhere"}).err, HasSubstr("there are no records in 'nowhere'"));
    std::filesystem::rename(folder_ / "main", folder_ / "main:1");
    EXPECT_EQ(report({"--against", "main:1"}).exit_code, 0) << "a folder whose name ends so";
}

TEST_F(ReportCommand, Formats_AreWhatTheySay) {
    record(run_of_one(1, 0.5, rules));
    accept("1");
    record(run_of_one(2, 0.75, rules));
    const ProgramResult as_json = report({"--json"});
    EXPECT_EQ(as_json.exit_code, 4);
    EXPECT_EQ(json::parse(as_json.out)["report"]["verdict"], "regressed");
    EXPECT_EQ(report({"--json"}).out, as_json.out);
    EXPECT_THAT(report({"--format", "junit"}).out, AllOf(StartsWith("<?xml"), HasSubstr("failures=\"1\"")));
    EXPECT_THAT(report({"--format", "markdown"}).out, StartsWith("### nightly: regressed"));
    const ProgramResult table = report({"--table", "csv"});
    EXPECT_EQ(table.exit_code, 0) << "a table judges nothing";
    EXPECT_THAT(table.out, AllOf(StartsWith("run,started,workflow,scan,variant,outcome,source,metric,value,unit\r\n"),
                                 HasSubstr("measure-surface,hausdorff,0.5,mm\r\n"),
                                 HasSubstr("measure-surface,hausdorff,0.75,mm\r\n")));
    EXPECT_THAT(report({"--table", "csv", "--run", "1"}).out, Not(HasSubstr("0.75")));
}

TEST_F(ReportCommand, TenThousandCells_FitAScreen) {
    RunDetails before = made_run(1, rules), now = made_run(2, rules);
    for (int scan = 0; scan < 2500; ++scan)
        for (const char* variant : {"fine", "coarse", "a b: c", "grün"}) {
            add_cell(before, "jobs/scans/" + std::to_string(scan) + ".ply", variant, 0.5);
            add_cell(now, "jobs/scans/" + std::to_string(scan) + ".ply", variant,
                     scan % 2 == 0 && *variant == 'f' ? 0.5 + scan : 0.5);
        }
    record(before);
    accept("1");
    record(now);
    const ProgramResult result = report();
    EXPECT_EQ(result.exit_code, 4);
    EXPECT_LT(std::ranges::count(result.out, '\n'), 50);
    EXPECT_THAT(result.out,
                AllOf(ContainsRegex("hausdorff  \\+1 %  fine +2500  0.5 mm .*1249\n"),
                      ContainsRegex("hausdorff  \\+1 %  grün +2500  0.5 mm +\\+0 % +0\n"), HasSubstr("scans/2498.ply"),
                      HasSubstr("and 1239 more\n"), HasSubstr("and 1246 more\n"),
                      HasSubstr("For every scan: scanmill report out --metric NAME; for everything: --json\n")));
}

TEST_F(ReportCommand, Metric_ChoosesTheTable) {
    record(run_of_one(1, 0.5, rules));
    EXPECT_THAT(report({"--metric", "genus"}).out, AllOf(HasSubstr("\ngenus"), Not(HasSubstr("\nhausdorff"))));
    EXPECT_THAT(report({"--metric", "surface.flips"}).out, HasSubstr("\nsurface.flips"));
    EXPECT_THAT(report({"--metric", "seconds"}).out, HasSubstr("1.5 s"));
    const ProgramResult unknown = report({"--metric", "hausdorf"});
    EXPECT_EQ(unknown.exit_code, 2);
    EXPECT_THAT(unknown.err, ContainsRegex("metric 'hausdorf'.*mean 'hausdorff'"));
}

TEST_F(ReportCommand, RunsThatHaveNotEnded_AreReported) {
    EXPECT_THAT(report().err, AllOf(HasSubstr("there are no records in 'out'"), HasSubstr("hint")));
    EXPECT_EQ(report().exit_code, 2);
    record(run_of_one(1, 0.5, rules), "out", "");
    EXPECT_THAT(report().err, HasSubstr("no run in 'out' has ended"));
    record(run_of_one(2, 0.5, rules));
    EXPECT_EQ(report().exit_code, 0);
    EXPECT_THAT(report({"--run", "1"}).err, HasSubstr("run 1 in 'out' has not ended"));
    EXPECT_THAT(report({"--run", "9"}).err, ContainsRegex("no run 9 in 'out'.* 1 to 2"));
    record(run_of_one(3, 0.5, rules), "out", "");
    EXPECT_THAT(report().out, HasSubstr("run 3 of")) << "the reader must not take last night's report for tonight's";
    EXPECT_THAT(accept("3").err, HasSubstr("has not ended"));
}

TEST_F(ReportCommand, Acceptances_NeedANameAndAReason) {
    record(run_of_one(1, 0.5, rules));
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--accept"},
                                                      {"--accept", "--who", "Ann"},
                                                      {"--accept", "--why", "x"},
                                                      {"--accept", "--who", " ", "--why", "x"},
                                                      {"--revoke", "--who", "Ann"}}) {
        const ProgramResult refused = report(arguments);
        EXPECT_EQ(refused.exit_code, 2);
        EXPECT_THAT(refused.err, AllOf(HasSubstr("needs a name and a reason"), HasSubstr("--who NAME --why TEXT")));
    }
    EXPECT_THAT(report({"--who", "Ann"}).err,
                HasSubstr("--who and --why are for --accept, --revoke and --acknowledge"));
    EXPECT_EQ(report({"--accept", "--revoke", "--who", "A", "--why", "x"}).exit_code, 2);
    EXPECT_EQ(report({"--accept", "--json", "--who", "A", "--why", "x"}).exit_code, 2);
    EXPECT_THAT(report().out, StartsWith("nightly: new\n")) << "nothing was accepted";
}

TEST_F(ReportCommand, WrongOptions_AreRefused) {
    record(run_of_one(1, 0.5, rules));
    for (const std::vector<std::string>& arguments : {std::vector<std::string>{"--format", "yaml"},
                                                      {"--table", "xls"},
                                                      {"--run", "x"},
                                                      {"--table", "csv", "--json"},
                                                      {"--json", "--format", "text"}})
        EXPECT_EQ(report(arguments).exit_code, 2) << arguments[0];
    EXPECT_THAT(report({"--format", "yaml"}).err, AllOf(HasSubstr("junit"), HasSubstr("scanmill report --help")));
}

TEST_F(ReportCommand, HostileNames_StayOnTheirLines) {
    RunDetails run = made_run(1, rules);
    for (const std::string& name : {std::string("a b\n\x1b[2J<script>'\".ply"), std::string(200, 'x') + ".ply"}) {
        CellRecord& cell = add_cell(run, "jobs/" + name);
        cell.outcome = Outcome::failed;
        cell.failure.error = "broken '" + name + "'";
    }
    record(run, "out", "failed");
    for (const std::vector<std::string>& format :
         std::vector<std::vector<std::string>>{{}, {"--json"}, {"--format", "junit"}, {"--format", "markdown"}}) {
        const ProgramResult result = report(format);
        EXPECT_EQ(result.exit_code, 1);
        EXPECT_THAT(result.out, AllOf(Not(HasSubstr("\x1b")), HasSubstr(std::string(200, 'x'))));
    }
    EXPECT_THAT(report().out, HasSubstr("--scan $'a b\\n\\x1b[2J<script>\\'\".ply'"));
}

TEST_F(ReportCommand, LengthsKeepTheirUnit_InTheRecords) {
    record(run_of_one(1, 0.5, {{"hausdorff", "+0.1 mm", {}}}));
    accept("1");
    record(run_of_one(2, 0.55, {{"hausdorff", "+0.1 mm", {}}}));
    EXPECT_EQ(report().exit_code, 0);
    record(run_of_one(3, 0.65, {{"hausdorff", "+0.1 mm", {}}}));
    EXPECT_EQ(report().exit_code, 4);
}

TEST_F(ReportCommand, Costs_AreComparedWithEarlierNights) {
    const auto night = [](double seconds) {
        RunDetails run = run_of_one(1, 0.5, {{"seconds", "+20 %", {}}});
        run.cells[0].costs = passes({seconds, 1.01 * seconds, 1.02 * seconds});
        return run;
    };
    record(night(1));
    accept("1");
    for (const double seconds : {1.05, 0.98, 1.1, 1.01}) {
        record(night(seconds));
        EXPECT_EQ(report().exit_code, 0) << report().out;
    }
    RunDetails blip = night(1);
    blip.cells[0].costs[1].seconds = 30;
    record(blip);
    EXPECT_EQ(report().exit_code, 0);
    record(night(2));
    EXPECT_EQ(report().exit_code, 4);
    EXPECT_THAT(report().out, AllOf(HasSubstr("seconds"), HasSubstr(", p 0.00"), HasSubstr("regressed")));
    RunDetails elsewhere = night(4);
    elsewhere.start.machine = "another box";
    record(elsewhere);
    EXPECT_EQ(report().exit_code, 0) << "another machine starts anew";
    EXPECT_THAT(report().out, HasSubstr("the machine changed"));
}

}  // namespace
}  // namespace scanmill::test
