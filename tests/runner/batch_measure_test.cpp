// SPDX-License-Identifier: GPL-3.0-or-later
// Batches that feed every input and measure their results by the scans' truths.

#include <algorithm>

#include "runner/batch_fixture.hpp"
#include "scanmill/formats/files.hpp"
#include "support/shapes.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::ContainsRegex;
using testing::HasSubstr;
using testing::Not;

/// Scans are spheres of radius 10 mm; each truth is the same sphere moved by 1 mm along x.
class MeasuredBatch : public Batch {
protected:
    MeasuredBatch() {
        for (const char* name : {"a", "b"}) write_sphere(std::string("scans/") + name + ".ply", 0, 1);
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: mesh}\nsteps:\n  - id: surface\n    edge-flip: \n"
                      "outputs: {'{scan}.ply': surface}\n");
    }
    /// In a unit of `scale` mm.
    void write_sphere(const std::string& name, double shift, double scale) {
        TriangleMesh sphere = geodesic_sphere(10, 15);
        Array<Vec3> moved(sphere.positions.size());
        for (std::size_t i = 0; i < moved.size(); ++i) moved[i] = (sphere.positions[i] + Vec3(shift, 0, 0)) / scale;
        sphere.positions = std::move(moved);
        std::filesystem::create_directories((folder_ / name).parent_path());
        write_file(folder_ / name, std::make_shared<const TriangleMesh>(sphere));
    }
    void write_measured(const std::string& truth, const std::string& more = "measure: {samples: 2000}\n") {
        folder_.write("b.yaml", "scanmill: 1\nbatch: b\nscans: [{path: scans/*.ply, unit: mm, truth: " + truth +
                                    "}]\nworkflows: w.yaml\n" + more);
    }
    static double metric(const Json& step, const std::string& name) {
        return step.at("metrics").at(name).get<double>();
    }

    const std::vector<std::string> once_{"--no-cache", "-q", "-j", "1"};
};

TEST_F(MeasuredBatch, TruthInAnotherUnit_IsConverted) {
    write_sphere("truth/a.stl", 1, 10);
    write_sphere("truth/b.stl", 2, 10);
    write_measured("{path: 'truth/{stem}.stl', unit: cm}");
    const ProgramResult ran = run_batch(once_);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_THAT(ran.out, HasSubstr("hausdorff"));
    std::vector<double> distances;
    for (const Json& step : of_step(recorded(1), "measure-surface")) {
        EXPECT_EQ(step["filter"], "measure");
        distances.push_back(metric(step, "hausdorff"));
    }
    std::ranges::sort(distances);
    ASSERT_EQ(distances.size(), 2u);
    EXPECT_NEAR(distances[0], 1, 0.02) << "mm, as the scan";
    EXPECT_NEAR(distances[1], 2, 0.04);
}

TEST_F(MeasuredBatch, LengthsHaveTheUnitOfTheScans_InTableRecordsAndGate) {
    write_sphere("truth.stl", 1, 1);
    write_measured("{path: truth.stl, unit: mm}", "measure: {samples: 2000}\ngate: {hausdorff: +0.01 mm}\n");
    EXPECT_THAT(run_batch(once_).out, HasSubstr("hausdorff (mm)"));
    scanmill({"report", "out", "--accept", "--who", "Ann", "--why", "looks good"});
    const ProgramResult again = run_batch(once_);
    EXPECT_EQ(again.exit_code, 0) << again.out;
    EXPECT_THAT(again.out, HasSubstr("2 cells: 2 passed"));
    EXPECT_THAT(scanmill({"report", "out", "--metric", "hausdorff"}).out, HasSubstr("hausdorff (mm)"));
    EXPECT_THAT(scanmill({"report", "out"}).out, ContainsRegex("hausdorff  \\+0.01 mm  default +2  [0-9.]+ mm "));
    EXPECT_THAT(scanmill({"report", "out", "--table", "csv"}).out,
                ContainsRegex("measure-surface,hausdorff,[0-9.]+,mm"));
}

TEST_F(MeasuredBatch, TruthInAnUnknownUnit_FailsItsCellsAndIsNeverScored) {
    write_sphere("truth.stl", 1, 1);
    write_measured("truth.stl");
    const ProgramResult ran = run_batch(once_);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, AllOf(ContainsRegex("mesh is in mm, .*truth has no unit"),
                               HasSubstr("in step 'measure-surface' (b.yaml:5:1)"),
                               HasSubstr("declare the truth's unit: `truth: {path: FILE, unit: mm}`")));
    for (const Json& step : of_step(recorded(1), "measure-surface")) EXPECT_EQ(step["outcome"], "failed");
}

TEST_F(MeasuredBatch, TruthInAnotherFrame_FailsItsCells) {
    write_sphere("truth.stl", 1, 1);
    folder_.write("b.yaml",
                  "scanmill: 1\nbatch: b\nscans: [{path: scans/*.ply, unit: mm, frame: part, truth: {path: truth.stl, "
                  "unit: mm, frame: machine}}]\nworkflows: w.yaml\nmeasure:\n");
    const ProgramResult ran = run_batch(once_);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, ContainsRegex("mesh .*frame 'part', .*truth .*frame 'machine'"));
}

TEST_F(MeasuredBatch, TruthOfPoints_IsReadAsPoints) {
    folder_.write("truth.xyz", "11 0 0\n-9 0 0\n1 10 0\n1 -10 0\n1 0 10\n1 0 -10\n");
    write_measured("{path: truth.xyz, unit: mm}");
    const ProgramResult ran = run_batch(once_);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_NEAR(metric(of_step(recorded(1), "measure-surface")[0], "max"), 1, 0.1);
}

TEST_F(MeasuredBatch, MissingTruth_FailsItsCellAndNoOther) {
    write_sphere("truth/a.stl", 1, 1);
    write_measured("{path: 'truth/{stem}.stl', unit: mm}");
    const ProgramResult checked = scanmill({"check", "b.yaml"});
    EXPECT_EQ(checked.exit_code, 0);
    EXPECT_THAT(checked.err,
                AllOf(HasSubstr("b.yaml:3:53: warning: "), HasSubstr("truth/b.stl': there is no such file"),
                      HasSubstr("expected the truth of 'scans/b.ply'")));
    const ProgramResult dry = run_batch({"--dry-run", "--no-cache"});
    EXPECT_EQ(dry.exit_code, 1);
    EXPECT_THAT(dry.out, HasSubstr("truth/b.stl': there is no such file"));
    const ProgramResult ran = run_batch(once_);
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err, AllOf(HasSubstr("error: 'truth/b.stl': there is no such file"), HasSubstr("scans/b.ply")));
    const Json run = recorded(1);
    ASSERT_EQ(run["cells"].size(), 2u);
    EXPECT_EQ(count(run["cells"], "outcome", "failed"), 1u);
    EXPECT_EQ(of_step(run, "measure-surface").size(), 1u) << "of the scan that has its truth";
}

TEST_F(MeasuredBatch, MeasuringSteps_AreInPlanAndDryRun_AndInTheCache) {
    write_sphere("truth.stl", 1, 1);
    write_measured("{path: truth.stl, unit: mm}");
    EXPECT_THAT(scanmill({"check", "b.yaml", "--plan"}).out,
                AllOf(HasSubstr("input truth: mesh or points\n"), HasSubstr("measure-surface (measure)\n"),
                      HasSubstr("        truth <- truth\n"), HasSubstr("        mesh <- surface\n"),
                      HasSubstr("        samples: 2000\n")));
    const Json plan = Json::parse(scanmill({"check", "b.yaml", "--plan", "--json"}).out)["files"][1]["plan"];
    EXPECT_EQ(plan["steps"].back()["in"]["truth"], Json{"truth"});
    EXPECT_EQ(plan["steps"].back()["file"], "b.yaml");
    EXPECT_FALSE(plan["steps"].front().contains("file"));
    EXPECT_THAT(run_batch({"--dry-run"}).out, HasSubstr(" measure-surface\n"));
    const std::vector<std::string> cached{"-q", "-j", "1", "--keep", "always"};
    ASSERT_EQ(run_batch(cached).exit_code, 0);
    ASSERT_EQ(run_batch(cached).exit_code, 0);
    const Json run = recorded(2);
    EXPECT_EQ(count(run["steps"], "origin", "ran"), 0u);
    EXPECT_EQ(of_step(run, "measure-surface").size(), 1u) << "the scans and their truths are equal";
    write_measured("{path: truth.stl, unit: mm}", "measure: {samples: 3000}\n");
    EXPECT_THAT(run_batch({"--dry-run"}).out, HasSubstr("will run because"));
}

TEST_F(MeasuredBatch, TruthThatTheBatchWouldWrite_IsRefusedBeforeAnythingRuns) {
    write_measured("{path: 'out/{stem}.ply', unit: mm}");
    const ProgramResult ran = run_batch(once_);
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.err, AllOf(HasSubstr("out/a.ply' is an input")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

TEST_F(MeasuredBatch, GateWithAMistake_IsRefusedByCheckAndBatch) {
    write_sphere("truth.stl", 1, 1);
    write_measured("{path: truth.stl, unit: mm}", "measure:\ngate: {hausdorf: +1 %}\n");
    for (const ProgramResult& result : {run_batch(), scanmill({"check", "b.yaml"})}) {
        EXPECT_EQ(result.exit_code, 2);
        EXPECT_THAT(result.err, AllOf(HasSubstr("b.yaml:6:8: "), HasSubstr("did you mean 'hausdorff'?")));
    }
}

TEST_F(MeasuredBatch, HostileNames_WorkThroughout) {
    std::filesystem::remove_all(folder_ / "scans");
    const std::vector<std::string> names{"two words",      "it's \"quoted\"",
                                         "line\nbreak",    "<script>alert(1)<script>",
                                         "{stem} and {x}", std::string(200, 'n')};
    for (const std::string& name : names) {
        write_sphere("scans/" + name + ".ply", 0, 1);
        write_sphere("truth/" + name + ".stl", 1, 1);
    }
    write_measured("{path: 'truth/{stem}.stl', unit: mm}");
    const ProgramResult ran = run_batch(once_);
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    for (const std::string& name : names)
        EXPECT_TRUE(std::filesystem::exists(folder_ / "out" / (name + ".ply"))) << name;
    const Json run = recorded(1);
    EXPECT_EQ(run["cells"].size(), names.size());
    for (const std::string& name : names) EXPECT_EQ(count(run["cells"], "scan", "scans/" + name + ".ply"), 1u) << name;
    EXPECT_EQ(std::ranges::count(ran.out, '\n'), static_cast<long>(names.size() + 2))
        << "one line per scan, the headers, and a line about columns that do not fit";
}

class FedBatch : public Batch {
protected:
    FedBatch() {
        write_scans("a", 2);
        folder_.write("w.yaml",
                      "scanmill: 1\nname: w\ninputs: {scan: points, other: [points]}\nsteps:\n  - test-step:\n    in: "
                      "{points: scan, more: other}\noutputs: {'{scan}.ply': test-step}\n");
    }
};

TEST_F(FedBatch, EveryScanHasItsOwnFurtherInputs) {
    folder_.write("others/a_01.xyz", "0 0 0\n");
    folder_.write("others/a_02.xyz", "0 0 0\n1 1 1\n");
    folder_.write("others/scans.xyz", "5 5 5\n6 6 6\n7 7 7\n");
    write_batch("{path: scans/*.xyz, in: {other: ['others/{stem}.xyz', 'others/{folder}.xyz']}}");
    const ProgramResult ran = run_batch({"--no-cache", "-q"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    const Json run = recorded(1);
    std::map<std::string, int> points;
    for (const Json& step : of_step(run, "test-step"))
        points[step["scan"].get<std::string>()] = step["metrics"]["more"].get<int>();
    EXPECT_EQ(points, (std::map<std::string, int>{{"scans/a_01.xyz", 4}, {"scans/a_02.xyz", 5}}));
}

TEST_F(FedBatch, MissingFile_FailsItsCellAndIsNamed) {
    folder_.write("others/a_01.xyz", "0 0 0\n");
    write_batch("{path: scans/*.xyz, in: {other: 'others/{stem}.xyz'}}");
    const ProgramResult ran = run_batch({"--no-cache", "-q"});
    EXPECT_EQ(ran.exit_code, 1);
    EXPECT_THAT(ran.err,
                AllOf(HasSubstr("error: 'others/a_02.xyz': there is no such file"), Not(HasSubstr("a_01.xyz'"))));
    EXPECT_EQ(count(recorded(1)["cells"], "outcome", "failed"), 1u);
}

TEST_F(FedBatch, FurtherInputs_AreNotReplaced) {
    folder_.write("out/a_01.ply", "not a scan");
    write_batch("{path: scans/*.xyz, in: {other: out/a_01.ply}}");
    const ProgramResult ran = run_batch({"-q"});
    EXPECT_EQ(ran.exit_code, 2);
    EXPECT_THAT(ran.err, HasSubstr("is an input"));
    EXPECT_EQ(content_of(folder_ / "out/a_01.ply"), "not a scan");
}

TEST_F(FedBatch, WorkflowWithoutInputs_RunsOnceBesideTheOthers) {
    folder_.write("none.yaml",
                  "scanmill: 1\nname: none\nsteps: [{test-step: {length: 1 u}}]\noutputs: {'{scan}.ply': test-step}\n");
    folder_.write("b.yaml",
                  "scanmill: 1\nbatch: b\nscans: [{path: scans/*.xyz, in: {other: scans/a_01.xyz}}]\n"
                  "workflows: [w.yaml, none.yaml]\n");
    EXPECT_THAT(scanmill({"check", "b.yaml"}).out, HasSubstr("2 scans, 2 workflows, 2 variants, 3 cells"));
    const ProgramResult ran = run_batch({"-q"});
    ASSERT_EQ(ran.exit_code, 0) << ran.err;
    EXPECT_EQ(outputs().size(), 3u);
    EXPECT_TRUE(outputs().contains("none.ply"));
    const Json run = recorded(1);
    EXPECT_EQ(count(run["cells"], "scan", "none"), 1u);
}

}  // namespace
}  // namespace scanmill::test
