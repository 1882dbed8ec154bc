// SPDX-License-Identifier: GPL-3.0-or-later
// Limits of time and memory, wherever they strike: which scan, which step or the reading, which limit, what was
// reached, and the way out.
#include <filesystem>

#include "runner/batch_fixture.hpp"
#include "support/point_files.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;

/// Allocating failed, or more was seen to be resident: whichever came first.
const auto what_was_reached =
    ContainsRegex("; the largest resident size was [0-9.]+ [KMG]iB|stopped at [0-9.]+ [KMG]iB, ");
constexpr const char* way_out = "\nhint: raise the limit, or thin the scan first";

class Limits : public Batch {
protected:
    /// The error of the one scan that there is.
    std::string error_under(const std::string& limits, const std::string& cause, const std::string& scan) {
        write_batch(scan, "limits: " + limits + "\n");
        std::filesystem::remove_all(folder_ / "out");
        const ProgramResult result = run_batch({"-j", "1", "--no-cache"});
        EXPECT_EQ(result.exit_code, 1) << result.err;
        const Json cell = recorded(1)["cells"][0];
        EXPECT_EQ(cell["cause"], cause) << cell;
        return cell.value("error", "");
    }
    void write_thinning(const std::string& bin_size) {
        folder_.write("w.yaml", "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: " +
                                    bin_size + "}\noutputs: {'{scan}.out.ply': voxel-thin}\n");
    }
};

TEST_F(Limits, TimeIsOverWhileAScanIsRead_SaysSo) {
    written(folder_ / "large.xyz", without_columns(helix(1'000'000)));
    for (const char* bin_size : {"auto", "0.01 u"}) {  // as a whole, and as a stream
        write_thinning(bin_size);
        EXPECT_THAT(error_under("{step: {time: 1 ms}}", "time", "large.xyz"),
                    AllOf(ContainsRegex("^time limit exceeded: stopped after [0-9]+\\.[0-9]+ s, the limit of "
                                        "a step is 1 ms\n"),
                          HasSubstr("\n  while reading 'large.xyz'\n  on scan 'large.xyz'"), HasSubstr(way_out)));
        EXPECT_THAT(error_under("{time: 1 ms}", "time", "large.xyz"),
                    AllOf(HasSubstr("the limit of a cell is 1 ms"),
                          HasSubstr("\n  while reading 'large.xyz'\n  on scan 'large.xyz'"), HasSubstr(way_out)));
    }
}

TEST_F(Limits, TimeIsOverInAStep_SaysWhichAndHowLongItTook) {
    write_workflow("1");
    write_scans("a", 1);
    EXPECT_THAT(
        error_under("{step: {time: 300 ms}}", "time", "{path: scans/a_01.xyz, set: {mode: loop}}"),
        AllOf(ContainsRegex("stopped after [0-9]+\\.[0-9]+ s, the limit of a step is 300 ms\n"),
              HasSubstr("\n  in step 'last' (w.yaml:"), HasSubstr("\n  on scan 'scans/a_01.xyz'"), HasSubstr(way_out)));
}

/// The first attempt takes the cell's time; the second is not begun.
TEST_F(Limits, TimeOfACellIsOverBeforeARetry_SaysWhatIsNotDone) {
    write_workflow("1");
    write_scans("a", 1);
    EXPECT_THAT(
        error_under("{time: 400 ms, retries: 1}", "time", "{path: scans/a_01.xyz, set: {mode: loop}}"),
        AllOf(ContainsRegex("the limit of a cell is 400 ms, [0-9]+\\.[0-9]+ s were used and this task is not done\n"),
              HasSubstr("\n  in step 'last' (w.yaml:"), HasSubstr("\n  on scan 'scans/a_01.xyz'"), HasSubstr(way_out)));
}

#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
TEST_F(Limits, MemoryIsNotEnoughToReadAScan_SaysSo) {
    written(folder_ / "large.xyz", without_columns(helix(4'000'000)));  // 96 MB in memory
    write_thinning("auto");
    EXPECT_THAT(error_under("{memory: 64 MiB}", "memory", "large.xyz"),
                AllOf(HasSubstr("memory limit exceeded"), HasSubstr("the limit is 64.0 MiB"), what_was_reached,
                      HasSubstr("\n  while reading 'large.xyz'\n  on scan 'large.xyz'"), HasSubstr(way_out)));
}

TEST_F(Limits, MemoryIsNotEnoughForAStepOfAStream_SaysSo) {
    written(folder_ / "large.ply", without_columns(helix(4'000'000)));
    write_thinning("1e-5 u");  // every point has a bin of its own
    EXPECT_THAT(
        error_under("{memory: 64 MiB}", "memory", "large.ply"),
        AllOf(HasSubstr("the limit is 64.0 MiB"), what_was_reached, HasSubstr("\n  in step 'voxel-thin' (w.yaml:"),
              HasSubstr("\n  on scan 'large.ply'"), HasSubstr(way_out)));
}
#endif

/// Other errors of reading name the file too, and only once.
TEST_F(Limits, RefusalOfAReader_NamesItsFileOnce) {
    write_thinning("auto");
    folder_.write("bad.xyz", "0 0 zero\n");
    EXPECT_THAT(
        error_under("{memory: 1 GiB}", "refused", "bad.xyz"),
        AllOf(HasSubstr("'bad.xyz'"), testing::Not(HasSubstr("while reading")), testing::Not(HasSubstr("on scan"))));
}

}  // namespace
}  // namespace scanmill::test
