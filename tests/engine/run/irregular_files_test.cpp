// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/io/mapped_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "engine/run/run_fixture.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class NoFile : public Run {
protected:
    std::string pipe() {
        const std::string path = (folder_ / "pipe.xyz").string();
        EXPECT_EQ(::mkfifo(path.c_str(), 0600), 0);
        return path;
    }
    static std::string path_prefix(const std::filesystem::path& path) {
        const std::optional<Error> error = why_no_file(path);
        return error ? error->what() : "";
    }
};

TEST_F(NoFile, FilesAndLinksToThem_AreFiles) {
    const std::string file = scan("a.xyz");
    EXPECT_FALSE(why_no_file(file));
    std::filesystem::create_symlink(file, folder_ / "link.xyz");
    EXPECT_FALSE(why_no_file(folder_ / "link.xyz"));
}

TEST_F(NoFile, WhatIsThereInstead_IsNamedWithAWayOut) {
    EXPECT_THAT(path_prefix(pipe()), AllOf(HasSubstr("pipe.xyz' is a pipe, not a file"), HasSubstr("\nhint: copy")));
    EXPECT_THAT(path_prefix("/dev/zero"), AllOf(HasSubstr("'/dev/zero' is a device"), HasSubstr("\nhint: copy")));
    EXPECT_THAT(path_prefix(folder_.path()), AllOf(HasSubstr("is a folder"), HasSubstr("hint: name one file")));
    EXPECT_THAT(path_prefix(folder_ / "absent.ply"), HasSubstr("there is no such file"));
    std::filesystem::create_symlink(folder_ / "absent.ply", folder_ / "broken.ply");
    EXPECT_THAT(path_prefix(folder_ / "broken.ply"), HasSubstr("there is no such file"));
    std::filesystem::create_symlink(folder_ / "loop", folder_ / "loop");
    EXPECT_THAT(path_prefix(folder_ / "loop"), HasSubstr("cannot be examined"));
}

TEST_F(NoFile, GraphOverAPipe_SaysWhatItIsAndIsNotKeptWaiting) {
    prepare("  - test-step:\n", {pipe()});
    EXPECT_THAT(graph_.nodes[0].unreadable, AllOf(HasSubstr("is a pipe"), HasSubstr("copy its content")));
    prepare("  - test-step:\n", {"/dev/zero"});
    EXPECT_THAT(graph_.nodes[0].unreadable, HasSubstr("is a device"));
    prepare("  - test-step:\n", {folder_.path().string()});
    EXPECT_THAT(graph_.nodes[0].unreadable, AllOf(HasSubstr("is a folder"), HasSubstr("*.ply")));
    prepare("  - test-step:\n", {"/no/such/scan.ply"});
    EXPECT_THAT(graph_.nodes[0].unreadable, HasSubstr("there is no such file"));
}

}  // namespace
}  // namespace scanmill::test
