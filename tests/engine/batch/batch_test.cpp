// SPDX-License-Identifier: GPL-3.0-or-later
// Batch files: their content, and their errors.

#include "engine/batch/batch_support.hpp"

namespace scanmill {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::StartsWith;

class BatchFile : public test::Batches {};

TEST_F(BatchFile, Everything_IsReadAsItStands) {
    folder_.write("scans/c/d.xyz", "x");
    folder_.write("other.yaml", "x");
    folder_.write("truth/a.stl", "x");
    folder_.write("truth/b.stl", "x");
    folder_.write("poses.json",
                  "{\"scanmill\": 1, \"unit\": \"m\", \"frame\": \"part\", \"poses\": ["
                  "{\"scan\": \"a\", \"rotation\": [0, 0, 0, 1], \"translation\": [1, 0, 0]},"
                  "{\"scan\": \"b.ply\", \"rotation\": [0, 0, 0, 1], \"translation\": [2, 0, 0]}]}");
    EXPECT_THAT(findings(R"(scanmill: 1
batch: nightly
summary: All of it.
scans:
  - {path: scans/*.ply, unit: mm, frame: "f-{stem}", pose: poses.json, truth: "truth/{stem}.stl", set: {n: 2}}
  - {path: scans/c/d.xyz, truth: {path: "truth/{folder}.ply", unit: cm, frame: "t-{stem}"}, in: {to: e.ply, more: [f.ply, "{stem}/{folder}.ply"]}}
workflows: [w.yaml, other.yaml]
set: {n: {sweep: [1, 3]}, s: 0.1 %diag}
limits: {memory: 8 GiB, time: 10 min, step: {memory: 500 MB, time: 2.5 s}, retries: 1}
measure: {of: [a, b.mesh], filter: measure, samples: 5}
gate: {hausdorff: +1 %, repeats: 2}
)"),
                testing::Each(HasSubstr("warning: ")));
    EXPECT_EQ(batch_.file, file());
    EXPECT_EQ(batch_.name, "nightly");
    EXPECT_EQ(batch_.summary, "All of it.");
    ASSERT_THAT(names(), ElementsAre("scans/a.ply", "scans/b.ply", "scans/c/d.xyz"));
    const BatchScan& b = batch_.scans[1];
    EXPECT_EQ(b.position, (Position{5, 12}));
    EXPECT_EQ(b.unit, LengthUnit::millimetre);
    EXPECT_EQ(b.frame, "f-{stem}") << "as written";
    EXPECT_EQ(b.pose->translation, Vec3(2, 0, 0));
    EXPECT_EQ(b.pose->unit, LengthUnit::metre);
    EXPECT_EQ(b.pose->to, "part");
    EXPECT_EQ(b.truth.files.front(), folder_ / "truth/b.stl");
    EXPECT_EQ(b.truth.unit, LengthUnit::unknown) << "its own, not that of the scan";
    EXPECT_EQ(b.truth.position, (Position{5, 72}));
    EXPECT_THAT(b.settings.at("n").values.at(0).literal.items, ElementsAre("2"));
    EXPECT_EQ(batch_.scans[2].unit, LengthUnit::unknown);
    EXPECT_FALSE(batch_.scans[2].pose);
    EXPECT_EQ(batch_.scans[2].truth.files.front(), folder_ / "truth/c.ply");
    EXPECT_EQ(batch_.scans[2].truth.unit, LengthUnit::centimetre);
    EXPECT_EQ(batch_.scans[2].truth.frame, "t-d");
    EXPECT_THAT(batch_.scans[2].inputs.at("to").files, ElementsAre(folder_ / "e.ply"));
    EXPECT_THAT(batch_.scans[2].inputs.at("more").files, ElementsAre(folder_ / "f.ply", folder_ / "d/c.ply"));
    ASSERT_EQ(batch_.workflows.size(), 2u);
    EXPECT_EQ(batch_.workflows[1].file, folder_ / "other.yaml");
    EXPECT_EQ(batch_.workflows[1].position, (Position{7, 21}));
    EXPECT_EQ(batch_.settings.at("n").values.size(), 2u);
    EXPECT_EQ(batch_.settings.at("s").position, (Position{8, 27})) << "of the name";
    EXPECT_EQ(batch_.limits, (Limits{u64(8) << 30, 500'000'000, 600, 2.5, 1}));
    ASSERT_TRUE(batch_.measure && batch_.gate);
    ASSERT_EQ(batch_.measure->of.size(), 2u);
    EXPECT_EQ(batch_.measure->of[1].text, "b.mesh");
    EXPECT_EQ(batch_.measure->filter, "measure");
    ASSERT_EQ(batch_.measure->parameters.size(), 1u);
    EXPECT_EQ(batch_.measure->parameters[0].name, "samples");
    EXPECT_EQ(*batch_.gate, (Gate{{{"hausdorff", "+1 %", {}}}, 2}));
}

TEST_F(BatchFile, MissingKeys_GiveNoLimitsAndNoValues) {
    EXPECT_THAT(rest("set:\nlimits:\n"), IsEmpty());
    EXPECT_EQ(batch_.limits, Limits{});
}

TEST_F(BatchFile, FilesThatRunsWriteBesideResults_AreNoScansOfAPattern) {
    for (const char* file : {"own/a.ply", "own/a.ply.json", "own/scanmill.sqlite", "own/scanmill.sqlite-journal",
                             "own/pose.json", "none/scanmill.lock"})
        folder_.write(file, "x");
    EXPECT_THAT(findings("scanmill: 1\nbatch: b\nscans: [\"own/*\"]\nworkflows: [w.yaml]\n"), IsEmpty());
    ASSERT_EQ(batch_.scans.size(), 2u);
    EXPECT_EQ(batch_.scans[0].file, folder_ / "own/a.ply");
    EXPECT_EQ(batch_.scans[1].file, folder_ / "own/pose.json") << "not the description of a file that is there";
    EXPECT_THAT(findings("scanmill: 1\nbatch: b\nscans: [\"none/*\"]\nworkflows: [w.yaml]\n"),
                ElementsAre(HasSubstr("'none/*' matches only files that Scanmill wrote beside results")));
    EXPECT_THAT(findings("scanmill: 1\nbatch: b\nscans: [own/a.ply.json]\nworkflows: [w.yaml]\n"), IsEmpty())
        << "named by its path";
}

TEST_F(BatchFile, ManyMistakes_AreAllFoundInOneGoWithTheirPlace) {
    EXPECT_THAT(
        findings(R"(scanmill: 1
batch: nightly
scans:
  - scans/*.plyy
  - {path: scans/a.ply, unit: yard, set: {n: $m}}
workflows: [missing.yaml]
limits: {memory: 8, retries: 11}
measure: {samples: {sweep: [1]}}
gate: {genus: exact, repeats: 0}
sumary: It.
)"),
        ElementsAre(AllOf(StartsWith("b:4:5: no file matches 'scans/*.plyy'; looked in '"), HasSubstr("/scans'")),
                    StartsWith("b:5:31: 'yard' is not a unit"),
                    StartsWith("b:5:46: a setting cannot refer to a parameter"),
                    AllOf(StartsWith("b:6:13: "), HasSubstr("missing.yaml' cannot be opened")),
                    "b:7:18: memory: '8' has no unit; expected a size, as 8 GiB",
                    AllOf(StartsWith("b:7:30: retries: 11 is out of range"), HasSubstr("at most 10")),
                    StartsWith("b:8:20: a parameter of `measure` has one value"),
                    StartsWith("b:9:31: repeats: 0 is out of range"),
                    AllOf(StartsWith("b:10:1: a batch has no key 'sumary'"), HasSubstr("did you mean 'summary'?"))));
}

TEST_F(BatchFile, WithoutItsParts_SaysWhichAreMissing) {
    EXPECT_THAT(findings(""), ElementsAre(HasSubstr("b: is empty; expected a batch")));
    EXPECT_THAT(findings("[]"), ElementsAre(HasSubstr("found a list; expected a batch")));
    EXPECT_THAT(findings("summary: x\n"),
                ElementsAre(HasSubstr("`scanmill: 1`"), HasSubstr("`batch: NAME`"), HasSubstr("has no workflows")));
    EXPECT_THAT(findings("scanmill: 2\nbatch: a b\nscans: []\nworkflows: []\n"),
                ElementsAre(HasSubstr("'2'"), HasSubstr("'a b' is not a name for a batch"),
                            HasSubstr("the list of scans is empty"), HasSubstr("the list of workflows is empty")));
    EXPECT_THAT(findings(head + "batch: c\n"), ElementsAre(HasSubstr("already at line 2")));
    EXPECT_THAT(findings("scanmill: 1\nbatch: [b]\nscans: x\nworkflows: {}\n"),
                ElementsAre(HasSubstr("expected a text for 'batch'"), HasSubstr("expected a list of scans"),
                            HasSubstr("expected a list of workflow files")));
}

TEST_F(BatchFile, WorkflowTwice_NamesTheEarlierLine) {
    EXPECT_THAT(findings("scanmill: 1\nbatch: b\nscans: [scans/*.ply]\nworkflows:\n  - w.yaml\n  - ./w.yaml\n"),
                ElementsAre(AllOf(StartsWith("b:6:5: "), HasSubstr("already at line 5"))));
    EXPECT_THAT(findings("scanmill: 1\nbatch: b\nscans: [scans/*.ply]\nworkflows: [scans, '', {}]\n"),
                ElementsAre(HasSubstr("is a folder"), HasSubstr("is a folder"), HasSubstr("found a map")));
}

TEST_F(BatchFile, LimitsThatAreNone_AreRefused) {
    const auto limit = [&](const std::string& text) { return rest("limits: {" + text + "}\n"); };
    EXPECT_THAT(limit("memory: 8 Gb"), ElementsAre(HasSubstr("memory: '8 Gb' is not a size")));
    EXPECT_THAT(limit("memory: 0 B"),
                ElementsAre(HasSubstr("memory: 0 B is out of range; expected 64 MiB to 1024 TiB")));
    EXPECT_THAT(limit("time: 10"), ElementsAre(HasSubstr("time: '10' has no unit; expected a time, as 10 min")));
    EXPECT_THAT(limit("time: 10 minutes"), ElementsAre(HasSubstr("time: '10 minutes' is not a time")));
    EXPECT_THAT(limit("memory: 1 MiB"), ElementsAre(HasSubstr("is out of range"))) << "no process lives on that";
    EXPECT_THAT(limit("time: 1e-300 s"), ElementsAre(HasSubstr("is out of range")));
    EXPECT_THAT(limit("time: 1e300 h"), ElementsAre(HasSubstr("is out of range")));
    EXPECT_THAT(limit("time: 0 s"), ElementsAre(HasSubstr("is out of range; expected 1 ms to 10000 h")));
    EXPECT_THAT(limit("time: [1 s]"), ElementsAre(HasSubstr("found a list")));
    EXPECT_THAT(limit("retries: -1"), ElementsAre(HasSubstr("retries: -1 is out of range")));
    EXPECT_THAT(limit("retries: 1.5"), ElementsAre(HasSubstr("retries: '1.5' is not a whole number")));
    EXPECT_THAT(limit("step: 1 s"), ElementsAre(HasSubstr("expected the limits of one step")));
    EXPECT_THAT(limit("step: {retries: 1}"), ElementsAre(HasSubstr("the limits of a step has no key 'retries'")));
    EXPECT_THAT(limit("tme: 1 s"), ElementsAre(HasSubstr("did you mean 'time'?")));
    EXPECT_THAT(rest("limits: 8 GiB\n"), ElementsAre(HasSubstr("expected a map of limits")));
}

TEST_F(BatchFile, SettingsThatAreNone_AreRefused) {
    EXPECT_THAT(rest("set: {a b: 1}\n"), ElementsAre(HasSubstr("'a b' is not a name for a parameter")));
    EXPECT_THAT(rest("set: {n: {sweep: []}}\n"), ElementsAre(HasSubstr("the sweep has no values")));
    EXPECT_THAT(rest("set: {n: {sweep: [1, $n]}}\n"), ElementsAre(HasSubstr("cannot refer to a parameter")));
    EXPECT_THAT(rest("set: [n]\n"), ElementsAre(HasSubstr("expected a map of parameters")));
    EXPECT_THAT(rest("set: {n: }\n"), ElementsAre(HasSubstr("found nothing")));
    EXPECT_THAT(rest("set: {n: $$x}\n"), IsEmpty());
}

TEST(IsBatch, TakesTheKeyAtTheRoot) {
    EXPECT_TRUE(is_batch("scanmill: 1\nbatch: b\n"));
    EXPECT_FALSE(is_batch("scanmill: 1\nname: b\nparameters: {batch: 1}\n"));
    EXPECT_FALSE(is_batch("[batch]"));
    EXPECT_FALSE(is_batch(""));
    EXPECT_FALSE(is_batch("batch: [\n"));
}

TEST(IsBatch, AsAWorkflow_SaysHowToRunIt) {
    Diagnostics diagnostics("b");
    parse_workflow("scanmill: 1\nbatch: b\nscans: []\n", diagnostics);
    ASSERT_EQ(diagnostics.errors(), 1u);
    EXPECT_THAT(diagnostics.sorted()[0].message, HasSubstr("`scanmill batch`"));
}

}  // namespace
}  // namespace scanmill
