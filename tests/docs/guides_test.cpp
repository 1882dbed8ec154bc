// SPDX-License-Identifier: GPL-3.0-or-later
// The pages of docs/ that have commands, followed word by word.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdlib>
#include <sstream>

#include "support/folders.hpp"
#include "support/guide.hpp"
#include "support/program.hpp"
#include "support/real_data.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;

const fs::path source = test::source_folder();

TEST(Guide, Matching_TakesGapsInLinesAndBetweenThem) {
    EXPECT_TRUE(matches({"a", "…", "z"}, {"a", "b", "c", "z"}));
    EXPECT_TRUE(matches({"a … c"}, {"a bb c"}));
    EXPECT_TRUE(matches({"…"}, {}));
    EXPECT_FALSE(matches({"a"}, {"a", "b"}));
    EXPECT_FALSE(matches({"a … c"}, {"a bb d"}));
    EXPECT_FALSE(matches({}, {"a"}));
}

/// The pages whose commands each run in an empty folder of their own.
std::vector<std::string> pages_with_commands() {
    std::vector<std::string> pages;
    for (const std::string folder : {"docs/how-to", "docs/reference", "docs/tutorial"}) {
        if (!fs::is_directory(source / folder)) continue;
        for (const auto& entry : fs::directory_iterator(source / folder))
            if (entry.path().extension() == ".md" && !read_guide(entry.path()).commands.empty())
                pages.push_back(folder + "/" + entry.path().filename().string());
    }
    std::ranges::sort(pages);
    return pages;
}

/// `docs/how-to/make-a-print.md` as `how_to_make_a_print`.
std::string page_test_name(const testing::TestParamInfo<std::string>& info) {
    std::string name = fs::path(info.param).replace_extension().string().substr(std::string("docs/").size());
    std::ranges::replace_if(
        name, [](unsigned char c) { return std::isalnum(c) == 0; }, '_');
    return name;
}

class GuidePage : public testing::TestWithParam<std::string> {};

TEST_P(GuidePage, PrintsWhatItShows) {
    const TemporaryFolder folder;
    follow(read_guide(source / GetParam()), folder.path(), folder / "home");
}

INSTANTIATE_TEST_SUITE_P(Docs, GuidePage, testing::ValuesIn(pages_with_commands()), page_test_name);

/// The commands of the first page, after what `make demo` does before them.
TEST(Guide, TheFirstPage_PrintsWhatItShows) {
    SCANMILL_REAL_SCAN(model, fetched_data, "meshes/ChineseDragon-10kv.off");
    const TemporaryFolder folder;
    fs::copy_file(model, folder / "lion.off");
    const ProgramResult scanned =
        scanmill_program({"run", "virtual-scans", (folder / "lion.off").string(), "--set", "noise=0.15 %diag", "-o",
                          (folder / "build/virtual-views").string(), "-q"});
    ASSERT_EQ(scanned.exit_code, 0) << scanned.err;
    const Guide guide = read_guide(source / "README.md");
    ASSERT_EQ(guide.commands.size(), 3u);
    follow(guide, folder.path(), folder / "home");
}

TEST(Guide, ConsoleBlocks_AreAllRun) {
    for (const auto& entry : fs::recursive_directory_iterator(source / "docs")) {
        if (entry.path().extension() != ".md") continue;
        std::istringstream lines(content_of(entry.path()));
        std::string before;
        for (std::string line; std::getline(lines, line); before = line)
            if (line == "```console") {
                EXPECT_EQ(before, "<!-- run -->") << entry.path();
            }
    }
}

/// The mark of a file is a comment, which a reader of the page does not see.
TEST(Guide, NamesOfFiles_AreInTheParagraphBefore) {
    for (const auto& entry : fs::recursive_directory_iterator(source / "docs")) {
        if (entry.path().extension() != ".md") continue;
        std::istringstream lines(content_of(entry.path()));
        std::string before, paragraph;
        for (std::string line; std::getline(lines, line);) {
            const std::string mark = "<!-- file: ";
            if (line.starts_with(mark)) {
                const std::string name = line.substr(mark.size(), line.find(" -->") - mark.size());
                EXPECT_THAT(paragraph, testing::HasSubstr(name)) << entry.path();
            }
            if (line.empty()) paragraph = before;
            before = line.empty() ? "" : before + line + "\n";
        }
    }
}

TEST(Guide, PluginGuide_MakesAFilterThatWorks) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "the guide builds without sanitizers, which a module must share with the program";
#endif
    const TemporaryFolder folder;
    const fs::path prefix = folder / "home/scanmill";
    const std::string install =
        "cmake --install '" + test::build_folder() + "' --prefix '" + prefix.string() + "' >/dev/null";
    ASSERT_EQ(std::system(install.c_str()), 0);
    const Guide guide = read_guide(source / "docs/plugin-guide/README.md");
    ASSERT_GE(guide.commands.size(), 8u);
    follow(guide, folder.path(), folder / "home");
    const std::string install_module = "cmake --install '" + (folder / "build").string() + "' >/dev/null";
    ASSERT_EQ(std::system(install_module.c_str()), 0);
    EXPECT_TRUE(fs::exists(prefix / "lib/scanmill/plugins/scanmill-crop-sphere.so")) << "beside Scanmill's own modules";
}

}  // namespace
}  // namespace scanmill::test
