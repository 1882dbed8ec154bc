// SPDX-License-Identifier: GPL-3.0-or-later
// tools/generate.sh in a tree of two filters, with a program that has the filters passed to it.

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/wait.h>

#include <cstdlib>

#include "support/folders.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

class Generate : public testing::Test {
protected:
    Generate() {
        fs::create_directories(folder_ / "tools");
        fs::copy_file(fs::path(test::source_folder()) / "tools/generate.sh", folder_ / "tools/generate.sh");
        folder_.write("filters/CMakeLists.txt", "scanmill_add_filter(one LINK x)\nscanmill_add_filter(two_words)\n");
        for (const char* page : {"one.md", "two-words.md", "gone.md"})
            folder_.write(std::string("docs/filters/") + page, "old\n");
        folder_.write("schemas/workflow.schema.json", "old\n");
    }
    /// The exit code; `said_` is what it printed.
    int run(const std::string& filters, const std::string& arguments = "") {
        const fs::path program =
            folder_.write("built/bin/scanmill",
                          "#!/bin/sh\nfilters='" + filters +
                              "'\ncase $1 in\n  list) printf '%s  points\\n' filter $filters ;;\n"
                              "  schema) mkdir -p \"$3\" && echo new >\"$3/workflow.schema.json\" ;;\n"
                              "  docs) mkdir -p \"$3\"; for f in $filters; do echo new >\"$3/$f.md\"; done ;;\nesac\n");
        fs::permissions(program, fs::perms::owner_all);
        const int status = std::system(
            ("cd '" + folder_.path().string() + "' && bash tools/generate.sh built " + arguments + " >said 2>&1")
                .c_str());
        said_ = content_of(folder_ / "said");
        return WEXITSTATUS(status);
    }
    std::string page(const std::string& name) const { return content_of(folder_ / ("docs/filters/" + name)); }

    TemporaryFolder folder_;
    std::string said_;
};

TEST_F(Generate, WithAllFilters_WritesTheirPagesAndNoOthers) {
    EXPECT_EQ(run("one two-words"), 0) << said_;
    EXPECT_EQ(page("one.md"), "new\n");
    EXPECT_EQ(page("two-words.md"), "new\n");
    EXPECT_FALSE(fs::exists(folder_ / "docs/filters/gone.md"));
    EXPECT_EQ(content_of(folder_ / "schemas/workflow.schema.json"), "new\n");
    EXPECT_EQ(run("one two-words", "check"), 0) << said_;
}

TEST_F(Generate, WithoutAFilter_RefusesAndTouchesNothing) {
    for (const char* arguments : {"", "check"}) {
        EXPECT_EQ(run("one two", arguments), 1);
        EXPECT_THAT(said_, HasSubstr("lacks scanmill-two-words, whose pages would be lost"));
        EXPECT_THAT(said_, HasSubstr("hint: cmake --build built --target scanmill-two-words\n"));
        EXPECT_EQ(page("two-words.md"), "old\n");
        EXPECT_EQ(content_of(folder_ / "schemas/workflow.schema.json"), "old\n");
    }
}

TEST_F(Generate, Check_FailsForPagesThatDifferAndChangesNone) {
    EXPECT_EQ(run("one two-words", "check"), 1);
    EXPECT_THAT(said_, HasSubstr("are not what the filters declare"));
    EXPECT_EQ(page("gone.md"), "old\n");
}

}  // namespace
}  // namespace scanmill::test
