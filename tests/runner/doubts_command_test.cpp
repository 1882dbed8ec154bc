// SPDX-License-Identifier: GPL-3.0-or-later
/// How the command reports doubtful results.
#include "runner/batch_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class DoubtsCommand : public Batch {
protected:
    DoubtsCommand() {
        write_scans("a", 2);
        write_workflow("1");
    }
    ProgramResult run(const std::string& mode, const std::vector<std::string>& more = {}) {
        std::vector<std::string> arguments{"run", "w.yaml", "scans/a_01.xyz", "-o", "out", "--set", "mode=" + mode};
        arguments.insert(arguments.end(), more.begin(), more.end());
        return scanmill(arguments);
    }
};

TEST_F(DoubtsCommand, Table_HasTheOutcome_AndStderrTheReason) {
    const ProgramResult ran = run("doubt");
    EXPECT_EQ(ran.exit_code, 0);
    EXPECT_THAT(ran.out, AllOf(HasSubstr("outcome"), HasSubstr("doubtful"), HasSubstr("1 of 1 doubtful")));
    EXPECT_THAT(ran.err, HasSubstr("doubt: scans/a_01.xyz: last: was asked to doubt\n"));
    const ProgramResult sure = run("pass");
    EXPECT_THAT(sure.out, AllOf(HasSubstr(" ok "), Not(HasSubstr("doubtful"))));
}

TEST_F(DoubtsCommand, Strict_MakesADoubtfulResultExitWith1) {
    EXPECT_EQ(run("doubt", {"--strict"}).exit_code, 1);
    EXPECT_EQ(run("pass", {"--strict"}).exit_code, 0);
    EXPECT_EQ(run("warn", {"--strict"}).exit_code, 0);
    write_batch("scans/*.xyz", "set: {mode: doubt}\n");
    EXPECT_EQ(run_batch().exit_code, 0);
    EXPECT_EQ(run_batch({"--strict"}).exit_code, 1);
}

TEST_F(DoubtsCommand, JsonEventsAndRecords_CarryTheDoubts) {
    const Json report = Json::parse(run("doubt", {"--json"}).out);
    EXPECT_EQ(report["cells"][0]["outcome"], "doubtful");
    EXPECT_EQ(report["cells"][0]["doubts"], Json({"last: was asked to doubt"}));
    const Json record = recorded(1);
    EXPECT_EQ(record["run"]["outcome"], "doubtful");
    EXPECT_EQ(record["run"]["doubtful"], 1);
    EXPECT_EQ(record["cells"][0]["doubts"], Json({"last: was asked to doubt"}));
    EXPECT_THAT(scanmill({"runs", "out", "show", "1"}).out,
                HasSubstr("doubt: scans/a_01.xyz [default]: last: was asked to doubt\n"));
    EXPECT_THAT(scanmill({"runs", "out"}).out, HasSubstr("doubtful"));

    write_batch("scans/*.xyz", "set: {mode: doubt}\n");
    const std::string events = run_batch({"--json"}).out;
    EXPECT_THAT(events, HasSubstr(R"("outcome":"doubtful")"));
    EXPECT_THAT(events, HasSubstr(R"("doubts":["last: was asked to doubt"])"));
    EXPECT_THAT(events, HasSubstr(R"("ok":0,"doubtful":2,"failed":0)"));
}

TEST_F(DoubtsCommand, ClosedSurfaceThatIsInsideOut_IsDoubtfulAfterEveryStep) {
    const auto tetrahedron = [](const char* faces) {
        return "OFF\n4 4 0\n0 0 0\n3 0 0\n0 3 0\n0 0 4\n" + std::string(faces);
    };
    folder_.write("out.off", tetrahedron("3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n"));
    folder_.write("in.off", tetrahedron("3 0 1 2\n3 0 3 1\n3 1 3 2\n3 2 3 0\n"));
    folder_.write(
        "flip.yaml",
        "scanmill: 1\nname: flip\ninputs: {scan: mesh}\nsteps: [edge-flip: ]\noutputs: {\"{scan}.ply\": edge-flip}\n");
    const ProgramResult inside_out = scanmill({"run", "flip.yaml", "in.off", "-o", "flipped"});
    EXPECT_THAT(inside_out.out, HasSubstr("doubtful"));
    EXPECT_THAT(inside_out.err, AllOf(HasSubstr("inside out"), HasSubstr("-6 ")));
    EXPECT_THAT(scanmill({"run", "flip.yaml", "out.off", "-o", "flipped"}).out,
                AllOf(HasSubstr(" ok "), Not(HasSubstr("doubtful"))));
}

}  // namespace
}  // namespace scanmill::test
