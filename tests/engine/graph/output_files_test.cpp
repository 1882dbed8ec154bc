// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/graph/output_files.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <utility>

#include "support/temporary_folder.hpp"
#include "support/thrown.hpp"

namespace scanmill {
namespace {

using test::error_of;
using test::sentence_of;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;
namespace fs = std::filesystem;

class OutputFilesTest : public testing::Test {
protected:
    OutputFiles files(const std::string& folder = "out") { return OutputFiles(folder_.path().string() + "/" + folder); }
    fs::path expected(const std::string& name) const { return fs::canonical(folder_.path()) / "out" / name; }

    test::TemporaryFolder folder_;
};

TEST_F(OutputFilesTest, Paths_LieBelowTheFolderHoweverItIsWritten) {
    for (const char* folder : {"out", "out/", "out//", "./out/.", "x/../out"})
        EXPECT_EQ(files(folder).add("a/b.ply", {"k", ""}, "A"), expected("a/b.ply")) << folder;
}

TEST_F(OutputFilesTest, SameContent_MayBeAddedTwice) {
    OutputFiles outputs = files();
    const fs::path file = outputs.add("a.ply", {"k", "mesh"}, "A");
    EXPECT_EQ(outputs.add("a.ply", {"k", "mesh"}, "B"), file);
    EXPECT_THAT(sentence_of([&] { outputs.add("a.ply", {"k", "tets"}, "C"); }), HasSubstr("A and C would both write"));
    EXPECT_THAT(sentence_of([&] {
                    outputs.add("a.ply", {"other", "mesh"}, "D");
                }),
                HasSubstr("A and D would both write"));
}

TEST_F(OutputFilesTest, TwoCellsOfOneFile_AreToldWhichPlaceholdersDiffer) {
    const TemplateValues first{"a", "default", "w", "one"};
    const auto hint = [&](const TemplateValues& second) {
        OutputFiles outputs = files();
        outputs.add("x.ply", {"k", ""}, "A", first);
        return error_of([&] { outputs.add("x.ply", {"l", ""}, "B", second); }).hint();
    };
    EXPECT_THAT(hint({"b", "default", "w", "one"}), AllOf(HasSubstr("put {scan} into"), Not(HasSubstr("{folder}"))));
    EXPECT_THAT(hint({"a", "default", "w", "two"}), HasSubstr("put {folder} into"));
    EXPECT_THAT(hint({"a", "other", "w", "one"}), HasSubstr("put {variant} into"));
    EXPECT_THAT(hint({"a", "other", "v", "one"}), HasSubstr("one of {variant} and {workflow}"));
    EXPECT_THAT(hint(first), AllOf(HasSubstr("rename one of the scans"), Not(HasSubstr("{"))));
}

TEST_F(OutputFilesTest, FileThatIsAnothersFolder_IsRefusedInEitherOrder) {
    OutputFiles outputs = files();
    outputs.add("a.stl", {"k", ""}, "A");
    EXPECT_THAT(sentence_of([&] {
                    outputs.add("a.stl/x/b.stl", {"l", ""}, "B");
                }),
                HasSubstr("into a folder that A writes as a file"));
    OutputFiles others = files();
    others.add("a.stl/x/b.stl", {"l", ""}, "B");
    EXPECT_THAT(sentence_of([&] { others.add("a.stl", {"k", ""}, "A"); }), HasSubstr("the folder that B writes into"));
    EXPECT_THAT(sentence_of([&] { others.add("a.stl/x", {"k", ""}, "A"); }), HasSubstr("the folder that B writes"));
}

TEST_F(OutputFilesTest, ExistingFolder_IsRefused) {
    folder_.write("out/a.stl/x", "");
    OutputFiles outputs = files();
    EXPECT_THAT(sentence_of([&] { outputs.add("a.stl", {"k", ""}, "A"); }), HasSubstr("is an existing folder"));
}

TEST_F(OutputFilesTest, Input_IsNotReplacedByWhateverName) {
    const fs::path scan = folder_.write("out/scan.ply", "x");
    fs::create_hard_link(scan, folder_ / "out/same.ply");
    OutputFiles outputs = files();
    outputs.protect(scan);
    EXPECT_THAT(sentence_of([&] { outputs.add("scan.ply", {"k", ""}, "A"); }), HasSubstr("is an input"));
    EXPECT_THAT(sentence_of([&] { outputs.add("same.ply", {"k", ""}, "A"); }), HasSubstr("is an input"));
    EXPECT_NO_THROW(outputs.add("other.ply", {"k", ""}, "A"));
}

TEST_F(OutputFilesTest, InputBelowFailed_IsNotReplaced) {
    OutputFiles outputs = files();
    outputs.protect(folder_.write("out/failed/scan.ply", "x"));
    EXPECT_THAT(sentence_of([&] {
                    outputs.add("scan.ply", {"k", ""}, "A");
                }),
                HasSubstr("failed/scan.ply' is an input"));
    EXPECT_NO_THROW(outputs.add("other.ply", {"k", ""}, "A"));
}

TEST_F(OutputFilesTest, FailedOutputThatIsAnothersFile_IsRefusedInEitherOrder) {
    OutputFiles outputs = files();
    outputs.add("a.ply", {"k", ""}, "A");
    EXPECT_THAT(sentence_of([&] { outputs.add("failed/a.ply", {"l", ""}, "B"); }), HasSubstr("would both write"));
    OutputFiles others = files();
    others.add("failed/a.ply", {"l", ""}, "B");
    EXPECT_NO_THROW(others.add("b.ply", {"k", ""}, "A"));
    EXPECT_THAT(sentence_of([&] { others.add("a.ply", {"k", ""}, "A"); }), HasSubstr("would both write"));
}

/// The next success of the first output would remove the second.
TEST_F(OutputFilesTest, SameContentBelowFailed_IsRefusedInEitherOrder) {
    for (const auto& [first, second] : {std::pair("a.ply", "failed/a.ply"), std::pair("failed/a.ply", "a.ply")}) {
        OutputFiles outputs = files();
        outputs.add(first, {"k", ""}, "A");
        const Error error = error_of([&] { outputs.add(second, {"k", ""}, "A"); });
        EXPECT_THAT(error.sentence(), AllOf(HasSubstr("A, if it fails,"), HasSubstr("failed/a.ply'"))) << first;
        EXPECT_THAT(error.hint(), HasSubstr("another folder than 'failed'")) << first;
    }
}

TEST_F(OutputFilesTest, FailedFolderThatLeadsOut_IsRefused) {
    fs::create_directories(folder_ / "out");
    fs::create_directories(folder_ / "elsewhere");
    fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "out/failed");
    OutputFiles outputs = files();
    EXPECT_THAT(sentence_of([&] { outputs.add("a.ply", {"k", ""}, "A"); }), HasSubstr("outside the output folder"));
}

TEST_F(OutputFilesTest, ProtectedFile_IsNotReplaced) {
    OutputFiles outputs = files();
    outputs.protect(folder_.write("out/poses.txt", "x"));
    outputs.protect(folder_ / "out/not-there");
    outputs.protect(folder_.path() / "out/../out/x/not-there");
    EXPECT_THAT(sentence_of([&] { outputs.add("poses.txt", {"k", ""}, "A"); }), HasSubstr("is an input"));
    for (const char* absent : {"not-there", "x/not-there"})
        EXPECT_THAT(sentence_of([&] {
                        outputs.add(absent, {"k", ""}, "A");
                    }),
                    HasSubstr("is an input"))
            << "a truth that a step of the same run would make";
    EXPECT_NO_THROW(outputs.add("other", {"k", ""}, "A"));
}

TEST_F(OutputFilesTest, LinkOutOfTheFolder_IsRefused) {
    fs::create_directories(folder_ / "out");
    fs::create_directories(folder_ / "elsewhere");
    fs::create_directory_symlink(folder_ / "elsewhere", folder_ / "out/link");
    OutputFiles outputs = files();
    EXPECT_THAT(sentence_of([&] {
                    outputs.add("link/a.ply", {"k", ""}, "A");
                }),
                HasSubstr("outside the output folder"));
}

}  // namespace
}  // namespace scanmill
