// SPDX-License-Identifier: GPL-3.0-or-later
// How the command describes scans that are streamed, and that it thins scans larger than its memory.
#include "runner/batch_fixture.hpp"
#include "support/point_files.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

class StreamingCommand : public Batch {
protected:
    void write_thinning(const std::string& bin_size, const std::string& more = "") {
        folder_.write("w.yaml", "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - voxel-thin: {bin-size: " +
                                    bin_size + "}\noutputs: {'{scan}.out.ply': voxel-thin" + more + "}\n");
    }
    std::string checked(const std::string& format) {
        std::vector<std::string> arguments{"check", "w.yaml", "--plan"};
        if (format == "json")
            arguments.emplace_back("--json");
        else
            arguments.insert(arguments.end(), {"--format", format});
        const ProgramResult result = scanmill(arguments);
        EXPECT_EQ(result.exit_code, 0) << result.err;
        return result.out;
    }
};

TEST_F(StreamingCommand, CheckedPlan_SaysWhichStepReadsAStream) {
    write_thinning("2 u");
    EXPECT_THAT(checked("text"), HasSubstr("points <- scan, as a stream\n"));
    EXPECT_THAT(checked("dot"), HasSubstr("input0 -> step0 [label=\"points (stream)\"]"));
    EXPECT_EQ(Json::parse(checked("json"))["files"][0]["plan"]["steps"][0]["streams"], Json({"points"}));
    write_thinning("auto");
    EXPECT_THAT(checked("text"), HasSubstr("points <- scan\n"));
    EXPECT_THAT(checked("dot"), HasSubstr("input0 -> step0 [label=\"points\"]"));
    EXPECT_EQ(Json::parse(checked("json"))["files"][0]["plan"]["steps"][0]["streams"], Json::array());
}

TEST_F(StreamingCommand, DryRun_SaysWhichScanIsStreamed) {
    written(folder_ / "a.ply", helix(10));
    folder_.write("six.xyz", "1 2 3 4 5 6\n");
    write_thinning("2 u");
    const std::string text = scanmill({"run", "w.yaml", "a.ply", "six.xyz", "--dry-run"}).out;
    EXPECT_THAT(text, HasSubstr(" read a.ply, as a stream\n"));
    EXPECT_THAT(text, HasSubstr(" read six.xyz\n"));
    const Json nodes = Json::parse(scanmill({"run", "w.yaml", "a.ply", "six.xyz", "--dry-run", "--json"}).out)["nodes"];
    EXPECT_EQ(count(nodes, "streamed", true), 1u);
    EXPECT_EQ(count(nodes, "streamed", false), 1u);
}

TEST_F(StreamingCommand, Filter_SaysThatItStreams) {
    EXPECT_THAT(scanmill({"show", "voxel-thin"}).out, HasSubstr("With bin-size given"));
    const Json shown = Json::parse(scanmill({"show", "voxel-thin", "--json"}).out);
    EXPECT_EQ(shown["filter"]["streams"]["given"], Json({"bin-size"}));
    EXPECT_THAT(scanmill({"show", "crop"}).out, HasSubstr("As the first step, without `near`, a scan"));
    EXPECT_THAT(scanmill({"show", "delaunay"}).out, Not(HasSubstr("in chunks")));
}

TEST_F(StreamingCommand, OptionalInputThatIsWired_MakesTheScanRead) {
    const auto workflow = [](const std::string& step) {
        return "scanmill: 1\nname: w\ninputs: {scan: points, other: points}\nsteps:\n  - crop: " + step +
               "\noutputs: {'{scan}.out.ply': crop}\n";
    };
    folder_.write("w.yaml", workflow("{within: 1 u}\n    in: {points: scan, near: other}"));
    EXPECT_THAT(checked("text"), AllOf(HasSubstr("points <- scan\n"), HasSubstr("near <- other\n")));
    written(folder_ / "a.ply", helix(10));
    const ProgramResult both = scanmill({"run", "w.yaml", "a.ply", "--in", "other=a.ply", "-o", "out"});
    EXPECT_EQ(both.exit_code, 0) << both.err;
    EXPECT_EQ(read_points(folder_ / "out/a.out.ply")->size(), 10u);
    // The same file at both ports.
    folder_.write("w.yaml", workflow("{within: 1 u}\n    in: {points: scan, near: scan}"));
    EXPECT_THAT(checked("text"), Not(HasSubstr("as a stream")));
    folder_.write("w.yaml", workflow("{centre: [0 u, 0 u, 0 u], radius: 2 u}\n    in: {points: scan}"));
    EXPECT_THAT(checked("text"), HasSubstr("points <- scan, as a stream\n"));
}

TEST_F(StreamingCommand, ScanLargerThanTheLimit_IsThinned) {
    written(folder_ / "large.ply", without_columns(helix(8'000'000)));  // 192 MB of coordinates
    write_batch("large.ply", "limits: {memory: 128 MiB}\n");
    write_thinning("1 %diag");
    const ProgramResult result = run_batch({"-j", "1"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(recorded(1)["cells"][0]["outcome"], "ok");
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    // Copied as well, it has to be read as a whole.
    write_thinning("1 %diag", ", '{scan}.copy.ply': scan");
    EXPECT_EQ(run_batch({"-j", "1"}).exit_code, 1);
    EXPECT_EQ(recorded(2)["cells"][0]["cause"], "memory");
#endif
}

}  // namespace
}  // namespace scanmill::test
