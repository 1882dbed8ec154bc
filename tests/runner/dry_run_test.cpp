// SPDX-License-Identifier: GPL-3.0-or-later
// The output of `--dry-run`: scans that are not files, values that are missing, and counts.
#include <sys/stat.h>

#include "runner/batch_fixture.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

class DryRun : public Batch {
protected:
    DryRun() { write_workflow("1"); }
    void make_pipe(const std::string& name) { EXPECT_EQ(::mkfifo((folder_ / name).c_str(), 0600), 0); }
    std::string path_prefix(const std::string& scan, std::vector<std::string> more = {}, int exit_code = 0) {
        more.insert(more.begin(), {"run", "w.yaml", scan, "-o", "out", "--dry-run"});
        const ProgramResult result = scanmill(more);
        EXPECT_EQ(result.exit_code, exit_code) << result.err;
        return result.out;
    }
};

TEST_F(DryRun, ScanThatIsNoFile_SaysWhatItIsAndWhatCanBeDone) {
    make_pipe("pipe.ply");
    const auto path_prefix = [&](const std::string& scan) { return DryRun::path_prefix(scan, {}, 1); };
    EXPECT_THAT(path_prefix("pipe.ply"),
                AllOf(HasSubstr("'pipe.ply' is a pipe"), HasSubstr("; copy its content into")));
    EXPECT_THAT(path_prefix("/dev/null"), HasSubstr("'/dev/null' is a device"));
    EXPECT_THAT(path_prefix("."), AllOf(HasSubstr("'.' is a folder"), HasSubstr("by a pattern such as DIR/*.ply")));
    EXPECT_THAT(path_prefix("absent.ply"), HasSubstr("'absent.ply': there is no such file"));
}

TEST_F(DryRun, BatchOverAPipe_SaysSoWhereItStands) {
    make_pipe("pipe.ply");
    write_batch("pipe.ply");
    for (const ProgramResult& result : {run_batch({"--dry-run"}), scanmill({"check", "b.yaml", "--plan"})}) {
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_THAT(result.err, AllOf(HasSubstr("b.yaml:3:9: "), HasSubstr("pipe.ply' is a pipe, not a file"),
                                      HasSubstr("; copy its content into"), HasSubstr("\n1 error in 'b.yaml'\n")));
    }
    write_scans("a", 1);
    write_batch("{path: scans/*.xyz, truth: pipe.ply}");
    EXPECT_THAT(run_batch({"--dry-run"}).err,
                AllOf(HasSubstr("warning: "), HasSubstr("is a pipe"), HasSubstr("expected the truth of")));
    std::filesystem::remove(folder_ / "w.yaml");
    make_pipe("w.yaml");
    write_batch("scans/*.xyz");
    EXPECT_THAT(run_batch({"--dry-run"}).err, AllOf(HasSubstr("w.yaml' is a pipe"), HasSubstr("expected a workflow")));
}

TEST_F(DryRun, ValueThatIsNotKept_HasTheReasonThatWasAskedFor) {
    write_scans("a", 1);
    const std::string scan = "scans/a_01.xyz";
    ASSERT_EQ(scanmill({"run", "w.yaml", scan, "-o", "out", "--keep", "never"}).exit_code, 0);
    EXPECT_THAT(path_prefix(scan), ContainsRegex("'points' is not in the cache.* earlier run"));
    EXPECT_THAT(path_prefix(scan, {"--keep", "never"}),
                AllOf(ContainsRegex("'points' is not in the cache.* 'never'"), Not(HasSubstr("quick"))));
}

TEST_F(DryRun, OneOfAThing_IsNamedAsOne) {
    write_scans("a", 2);
    EXPECT_THAT(path_prefix("scans/a_01.xyz"), HasSubstr(" cached, 1 cell\n"));
    EXPECT_THAT(path_prefix("scans/a_01.xyz", {"scans/a_02.xyz"}), HasSubstr(" cached, 2 cells\n"));
    EXPECT_THAT(scanmill({"check", "w.yaml", "--plan"}).out, HasSubstr("w: 2 steps, 1 variant\n"));
    folder_.write("w.yaml", "scanmill: 1\nname: w\nsteps: [{test-step: {factor: {sweep: [1, 2]}}}]\n");
    EXPECT_THAT(scanmill({"check", "w.yaml", "--plan"}).out, HasSubstr("w: 2 steps, 2 variants\n"));
    folder_.write("w.yaml", "scanmill: 1\nname: w\nsteps: [test-step: ]\n");
    EXPECT_THAT(scanmill({"check", "w.yaml", "--plan"}).out, HasSubstr("w: 1 step, 1 variant\n"));
    folder_.write("one.xyz", "0 0 0\n1 1 nan\n");
    EXPECT_THAT(scanmill({"convert", "--drop-invalid", "one.xyz", "one.ply"}).err,
                ContainsRegex("warning: 1 point .*NaN.* left out"));
    folder_.write("mesh.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nv nan 0 0\nv 0 nan 0\nf 1 2 3\nf 1 2 4\n");
    EXPECT_THAT(scanmill({"convert", "--drop-invalid", "mesh.obj", "mesh.ply"}).err,
                ContainsRegex("warning: 2 points .*NaN.* left out.* 1 triangle"));
}

}  // namespace
}  // namespace scanmill::test
