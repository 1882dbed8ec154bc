// SPDX-License-Identifier: GPL-3.0-or-later
// Which file belongs to which cell of a batch, and which may not be written.

#include "runner/batch_fixture.hpp"
#include "scanmill/worker/file_description.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST_F(Batch, TwoCellsOfOneFile_AreRefusedBeforeAnythingRuns) {
    write_workflow("2");
    folder_.write("scans/one/a.xyz", "1 0 0\n");
    folder_.write("scans/two/a.xyz", "2 0 0\n");
    write_batch("scans/**/a.xyz");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, AllOf(HasSubstr("would both write"), HasSubstr("put {folder} into")));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out"));
}

/// One of them may fail its expectation; the content of the file would then be undefined.
TEST_F(Batch, OneFileOfTwoWorkflowsThatExpectDifferentThings_IsRefused) {
    write_scans("scan", 1);
    const std::string head =
        "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\n    expect: {points: ";
    folder_.write("strict.yaml", head + "77}\noutputs: {'{scan}.ply': test-step}\n");
    folder_.write("lax.yaml", head + "5}\noutputs: {'{scan}.ply': test-step}\n");
    folder_.write("b.yaml", "scanmill: 1\nbatch: b\nscans: [scans/*.xyz]\nworkflows: [strict.yaml, lax.yaml]\n");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, AllOf(HasSubstr("would both write"), HasSubstr("give the outputs, or the workflows,")))
        << "both workflows are called w";
}

/// Reading what all scans share is the only thing that is done more than once.
TEST_F(Batch, SharedInput_BelongsToEveryScan) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points, other: points}\nsteps:\n  - test-step: "
                  "{mode: slow}\n    in: {points: scan, more: [other]}\noutputs: {'{scan}.ply': test-step}\n");
    write_scans("scan", 6);
    folder_.write("other.xyz", "5 5 5\n");
    std::map<std::string, std::string> expected;
    for (const char* jobs : {"0", "3"}) {
        std::filesystem::remove_all(folder_ / "out");
        std::vector<std::string> arguments{"run", "w.yaml"};
        for (int i = 1; i <= 6; ++i) arguments.push_back(fmt::format("scans/scan_{:02}.xyz", i));
        arguments.insert(arguments.end(), {"--in", "other=other.xyz", "-o", "out", "--no-cache", "-j", jobs});
        const ProgramResult result = scanmill(arguments);
        ASSERT_EQ(result.exit_code, 0) << result.err;
        const Json run = recorded(1);
        EXPECT_EQ(run["steps"].size(), 13u) << "seven reads, one of which is the shared one, and six steps";
        if (expected.empty()) expected = outputs();
        EXPECT_EQ(outputs(), expected);
    }
}

TEST_F(Batch, TruthAndPoseFiles_AreNotReplaced) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs: "
                  "{'{scan}.ply': test-step}\n");
    folder_.write("in/p.xyz", "1 2 3\n4 5 6\n");
    folder_.write("out/p.ply", "the truth");
    write_batch("{path: in/p.xyz, truth: out/p.ply}");
    EXPECT_EQ(run_batch().exit_code, 2);
    EXPECT_EQ(content_of(folder_ / "out/p.ply"), "the truth");
    const std::string pose = "{\"scanmill\": 1, \"poses\": [{\"rotation\": [0, 0, 0, 1], \"translation\": [1, 0, 0]}]}";
    folder_.write("out/p.ply.json", pose);
    write_batch("{path: in/p.xyz, pose: out/p.ply.json}");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 2);
    EXPECT_THAT(result.err, HasSubstr("is an input"));
    EXPECT_EQ(content_of(folder_ / "out/p.ply.json"), pose);
}

TEST_F(Batch, ScanThatItsPoseFileRefuses_FailsAlone) {
    folder_.write("w.yaml",
                  "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs: "
                  "{'{scan}.ply': test-step}\n");
    folder_.write("in/p.xyz", "1 2 3\n4 5 6\n");
    folder_.write("in/q.xyz", "1 2 3\n4 5 6\n");
    folder_.write("poses.json",
                  "{\"scanmill\": 1, \"poses\": [{\"scan\": \"p.xyz\", \"rotation\": [0, 0, 0, 1], \"translation\": "
                  "[1, 0, 0]}, {\"scan\": \"q.xyz\", \"refused\": \"no-overlap: at most 12 %\"}]}");
    write_batch("{path: in/*.xyz, pose: poses.json}");
    const ProgramResult result = run_batch();
    EXPECT_EQ(result.exit_code, 1);
    EXPECT_THAT(result.err + result.out, AllOf(HasSubstr("'q.xyz'"), HasSubstr("no-overlap: at most 12 %")));
    EXPECT_TRUE(std::filesystem::exists(folder_ / "out/p.ply"));
    EXPECT_FALSE(std::filesystem::exists(folder_ / "out/q.ply"));
}

TEST_F(Batch, EqualScansOfOneName_NeedTwoFiles_WhichTheFolderGives) {
    const auto workflow = [&](const std::string& name) {
        folder_.write("w.yaml", "scanmill: 1\nname: w\ninputs: {scan: points}\nsteps:\n  - test-step:\noutputs: {'" +
                                    name + "': test-step}\n");
    };
    folder_.write("scans/one/a.xyz", "1 2 3\n4 5 6\n");
    folder_.write("scans/two/a.xyz", "1 2 3\n4 5 6\n");
    write_batch("{path: scans/*/a.xyz, frame: lab, unit: mm}");
    workflow("{scan}.ply");
    EXPECT_EQ(run_batch().exit_code, 2);
    workflow("{folder}/{scan}.ply");
    ASSERT_EQ(run_batch().exit_code, 0);
    const Json described = Json::parse(content_of(folder_ / "out/two/a.ply.json"));
    EXPECT_EQ(described["scan"], "scans/two/a.xyz");
    EXPECT_EQ(described["steps"][0]["file"], "scans/two/a.xyz") << "though it was read as the other one";
    EXPECT_EQ(described["steps"][0]["frame"], "lab");
    EXPECT_EQ(described["steps"][0]["unit"], "mm");
    Sha256 hash;
    hash.add(content_of(folder_ / "out/two/a.ply"));
    EXPECT_EQ(described["file"]["sha256"], hash.text());
}

}  // namespace
}  // namespace scanmill::test
