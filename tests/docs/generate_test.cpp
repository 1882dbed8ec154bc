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
        folder_.write("filters/one/README.md", page_with("filter one", "old"));
        folder_.write("filters/two_words/README.md", page_with("filter two-words", "old"));
        folder_.write("docs/filters/README.md", page_with("filters LINK", "old"));
        folder_.write("docs/other.md", "old\n");
        folder_.write("schemas/workflow.schema.json", "old\n");
    }
    /// The exit code; `said_` is what it printed.
    int run(const std::string& filters, const std::string& arguments = "") {
        const fs::path program = folder_.write(
            "built/bin/scanmill", "#!/bin/sh\nfilters='" + filters +
                                      "'\ncase $1 in\n  list) printf '%s  points\\n' filter $filters ;;\n"
                                      "  schema) mkdir -p \"$3\" && echo new >\"$3/workflow.schema.json\" ;;\n"
                                      "  docs) shift 2; sed -i 's/^old$/new/' \"$@\" ;;\nesac\n");
        fs::permissions(program, fs::perms::owner_all);
        const int status = std::system(
            ("cd '" + folder_.path().string() + "' && bash tools/generate.sh built " + arguments + " >said 2>&1")
                .c_str());
        said_ = content_of(folder_ / "said");
        return WEXITSTATUS(status);
    }
    static std::string page_with(const std::string& mark, const std::string& part) {
        return "# Page\n<!-- generated: " + mark + " -->\n" + part + "\n<!-- end -->\n";
    }
    std::string page(const std::string& name) const { return content_of(folder_ / name); }

    TemporaryFolder folder_;
    std::string said_;
};

TEST_F(Generate, WritesTheGeneratedPartsAndNothingElse) {
    EXPECT_EQ(run("one two-words"), 0) << said_;
    EXPECT_EQ(page("filters/one/README.md"), page_with("filter one", "new"));
    EXPECT_EQ(page("filters/two_words/README.md"), page_with("filter two-words", "new"));
    EXPECT_EQ(page("docs/filters/README.md"), page_with("filters LINK", "new"));
    EXPECT_EQ(page("docs/other.md"), "old\n");
    EXPECT_EQ(page("schemas/workflow.schema.json"), "new\n");
    EXPECT_EQ(run("one two-words", "check"), 0) << said_;
}

TEST_F(Generate, WithoutAFilter_RefusesAndTouchesNothing) {
    for (const char* arguments : {"", "check"}) {
        EXPECT_EQ(run("one two", arguments), 1);
        EXPECT_THAT(said_, HasSubstr("lacks scanmill-two-words, which have pages here"));
        EXPECT_THAT(said_, HasSubstr("hint: cmake --build built --target scanmill-two-words\n"));
        EXPECT_EQ(page("filters/one/README.md"), page_with("filter one", "old"));
        EXPECT_EQ(page("schemas/workflow.schema.json"), "old\n");
    }
}

TEST_F(Generate, APageWithoutItsPart_IsRefused) {
    folder_.write("filters/one/README.md", "# Page\n");
    EXPECT_EQ(run("one two-words"), 1);
    EXPECT_THAT(said_, HasSubstr("'filters/one/README.md' lacks the generated part about its filter"));
}

TEST_F(Generate, Check_FailsForPagesThatDifferAndChangesNone) {
    EXPECT_EQ(run("one two-words", "check"), 1);
    EXPECT_THAT(said_, HasSubstr("are not what the filters declare"));
    EXPECT_EQ(page("filters/one/README.md"), page_with("filter one", "old"));
}

}  // namespace
}  // namespace scanmill::test
