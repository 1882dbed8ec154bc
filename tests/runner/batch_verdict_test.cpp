// SPDX-License-Identifier: GPL-3.0-or-later
// Nights of a batch with a gate: a regression trips it in exactly its cells, undone it passes, and a part of a batch
// can be run again by the command that the report prints.

#include "runner/batch_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

class BatchVerdict : public Batch {
protected:
    BatchVerdict() {
        write_scans("a", 2);
        write_variants("2 u");
        write_batch("'scans/*.xyz'", "gate: {length: exact, outputs: exact}\n");
    }
    /// Two variants; the second one's step has this length.
    void write_variants(const std::string& length) {
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - id: last\n    one-of:\n"
                      "      - {name: fine, steps: [{test-step: {length: 1 u}}]}\n"
                      "      - {name: coarse, steps: [{test-step: {length: " +
                          length + "}}]}\noutputs: {'{scan}.{variant}.ply': last.mesh}\n");
    }
    ProgramResult accept() { return scanmill({"report", "out", "--accept", "--who", "Ann", "--why", "looks good"}); }
    /// "scans/a_01.xyz coarse regressed" for the cells of the last run that did not pass.
    std::vector<std::string> judged() {
        const Json report = Json::parse(scanmill({"report", "out", "--json"}).out)["report"];
        std::vector<std::string> cells;
        for (const Json& cell : report["cells"])
            if (cell["verdict"] != "passed")
                cells.push_back(fmt::format("{} {} {}", cell["scan"].get<std::string>(),
                                            cell["variant"].get<std::string>(), cell["verdict"].get<std::string>()));
        return cells;
    }
};

TEST_F(BatchVerdict, ARegression_TripsInExactlyItsCells) {
    const ProgramResult first = run_batch();
    EXPECT_EQ(first.exit_code, 0) << first.err;
    EXPECT_THAT(first.out, AllOf(HasSubstr("\nb: new\n4 cells: 4 new\n"), HasSubstr("scanmill report out")));
    EXPECT_EQ(accept().out, "run 1 is the accepted run of b\n");
    EXPECT_THAT(run_batch().out, HasSubstr("\nb: passed\n4 cells: 4 passed\n"));

    write_variants("2.5 u");
    const ProgramResult tripped = run_batch();
    EXPECT_EQ(tripped.exit_code, 4);
    EXPECT_THAT(tripped.out, AllOf(HasSubstr("\nb: regressed\n4 cells: 2 regressed, 2 passed\n"),
                                   HasSubstr("test-step: length 2 u → 2.5 u")));
    EXPECT_THAT(judged(), ElementsAre("scans/a_01.xyz coarse regressed", "scans/a_02.xyz coarse regressed"));

    write_variants("2 u");
    EXPECT_EQ(run_batch().exit_code, 0);
    EXPECT_THAT(judged(), ElementsAre());
}

TEST_F(BatchVerdict, Runs_ListTheRegressionsOfEveryGate) {
    run_batch();
    accept();
    write_variants("2.5 u");
    run_batch();
    write_batch("'scans/*.xyz'");
    run_batch();
    const Json runs = Json::parse(scanmill({"runs", "out", "--json"}).out)["runs"];
    ASSERT_EQ(runs.size(), 3u);
    EXPECT_EQ(runs[0]["regressions"], 0);
    EXPECT_EQ(runs[1]["regressions"], 2);
    EXPECT_TRUE(runs[2]["regressions"].is_null()) << "without a gate";
    EXPECT_THAT(scanmill({"runs", "out"}).out,
                AllOf(HasSubstr("  failed  regressions  computed  "), ContainsRegex("\n  2  [^ ]+  b +4 +0 +0 +2 +"),
                      ContainsRegex("\n  3  [^ ]+  b +4 +0 +0 +- +")));
    accept();
    EXPECT_EQ(Json::parse(scanmill({"runs", "out", "--json"}).out)["runs"][1]["regressions"], 2)
        << "under the baseline of its time";
}

TEST_F(BatchVerdict, TheTrippedGate_OutweighsFailures) {
    run_batch();
    accept();
    folder_.write("scans/a_01.xyz", "no numbers\n");
    const ProgramResult failed = run_batch();
    EXPECT_EQ(failed.exit_code, 1);
    EXPECT_THAT(failed.out, HasSubstr("\nb: failed\n4 cells: 2 failed, 2 passed\n"));
    write_variants("3 u");
    const ProgramResult both = run_batch();
    EXPECT_EQ(both.exit_code, 4);
    EXPECT_THAT(both.out, HasSubstr("\nb: regressed\n4 cells: 2 failed, 1 regressed, 1 passed\n"));
}

TEST_F(BatchVerdict, ScansThatComeOrGo_AreNewOrMissing) {
    run_batch();
    accept();
    std::filesystem::rename(folder_ / "scans/a_02.xyz", folder_ / "scans/b_02.xyz");
    EXPECT_EQ(run_batch().exit_code, 4);
    EXPECT_THAT(judged(), ElementsAre("scans/b_02.xyz fine new", "scans/b_02.xyz coarse new",
                                      "scans/a_02.xyz fine missing", "scans/a_02.xyz coarse missing"));
}

TEST_F(BatchVerdict, Events_HoldTheVerdictBeforeTheEnd) {
    run_batch();
    accept();
    write_variants("3 u");
    const ProgramResult result = run_batch({"--json"});
    EXPECT_EQ(result.exit_code, 4);
    std::vector<Json> events;
    std::istringstream lines(result.out);
    for (std::string line; std::getline(lines, line);) events.push_back(Json::parse(line));
    const Json& verdict = events.at(events.size() - 2);
    EXPECT_EQ(verdict["event"], "verdict");
    EXPECT_EQ(verdict["verdict"], "regressed");
    EXPECT_EQ(verdict["tripped"], true);
    EXPECT_EQ(verdict["accepted"], 1);
    EXPECT_EQ(verdict["counts"]["regressed"], 2);
    ASSERT_EQ(verdict["cells"].size(), 2u);
    EXPECT_THAT(verdict["cells"][0]["reasons"][0].get<std::string>(), HasSubstr("length 2 u → 3 u"));
}

TEST_F(BatchVerdict, TheCommandOfACell_RunsItAgain) {
    write_scans("it's b", 1);
    run_batch();
    accept();
    write_variants("3 u");
    run_batch();
    const Json report = Json::parse(scanmill({"report", "out", "--json"}).out)["report"];
    const Json& cell = report["cells"][5];
    ASSERT_EQ(cell["scan"], "scans/it's b_01.xyz");
    EXPECT_EQ(cell["command"], "scanmill batch b.yaml --scan 'scans/it'\\''s b_01.xyz' --only coarse -o reproduced");
    const ProgramResult again =
        scanmill({"batch", "b.yaml", "--scan", "scans/it's b_01.xyz", "--only", "coarse", "-o", "reproduced"});
    EXPECT_EQ(again.exit_code, 0) << again.err;
    EXPECT_THAT(outputs("reproduced"), ElementsAre(testing::Key("it's b_01.coarse.ply")));
    EXPECT_EQ(outputs("reproduced")["it's b_01.coarse.ply"], outputs("out")["it's b_01.coarse.ply"]);
}

TEST_F(BatchVerdict, APartOfABatch_IsNoNightOfIt) {
    run_batch();
    accept();
    const ProgramResult part = run_batch({"--scan", "scans/a_01.xyz"});
    EXPECT_EQ(part.exit_code, 0) << "the other cells are not missing";
    EXPECT_THAT(part.out, AllOf(HasSubstr("b, in part: new"), HasSubstr("2 cells")));
}

TEST_F(BatchVerdict, UnknownParts_AreRefused) {
    const ProgramResult scan = run_batch({"--scan", "scans/a_03.xyz"});
    EXPECT_EQ(scan.exit_code, 2);
    EXPECT_THAT(scan.err, AllOf(ContainsRegex("no scan 'scans/a_03.xyz'.*mean 'scans/a_01.xyz'"),
                                HasSubstr("it has scans/a_01.xyz and scans/a_02.xyz")));
    EXPECT_THAT(run_batch({"--only", "fin"}).err, ContainsRegex("no variant 'fin'.*mean 'fine'"));
    EXPECT_THAT(run_batch({"--workflow", "x"}).err, HasSubstr("the batch has no workflow 'x'"));
    EXPECT_THAT(outputs("."), Not(testing::Contains(testing::Key("out"))));
}

TEST_F(BatchVerdict, AGateWithoutRecords_DoesNotPass) {
    folder_.write("out/scanmill.sqlite", "another program's file, long enough to be read as a database");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err, ContainsRegex("gate was not judged.* not recorded"));
}

TEST_F(BatchVerdict, WithoutGateAndAcceptance_NothingIsSaid) {
    write_batch("'scans/*.xyz'");
    EXPECT_THAT(run_batch().out, Not(HasSubstr("scanmill report")));
    accept();
    EXPECT_THAT(run_batch().out, HasSubstr("\nb: passed\n"));
    EXPECT_THAT(scanmill({"report", "out"}).out, HasSubstr("against run 1"));
}

}  // namespace
}  // namespace scanmill::test
