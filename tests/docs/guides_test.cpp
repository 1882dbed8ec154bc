// SPDX-License-Identifier: GPL-3.0-or-later
// The guides, followed word by word.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "support/folders.hpp"
#include "support/guide.hpp"
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

TEST(Guide, UserGuide_PrintsWhatItShows) {
    const TemporaryFolder folder;
    const Guide guide = read_guide(source / "docs/user-guide.md");
    ASSERT_GE(guide.commands.size(), 10u);
    follow(guide, folder.path(), folder / "home");
}

TEST(Guide, Inspection_PrintsWhatItShows) {
    const TemporaryFolder folder;
    const Guide guide = read_guide(source / "docs/inspection.md");
    ASSERT_GE(guide.commands.size(), 5u);
    follow(guide, folder.path(), folder / "home");
}

TEST(Guide, PartChanged_PrintsWhatItShows) {
    const TemporaryFolder folder;
    const Guide guide = read_guide(source / "docs/part-changed.md");
    ASSERT_GE(guide.commands.size(), 10u);
    follow(guide, folder.path(), folder / "home");
}

TEST(Guide, TouchedEdges_PrintsWhatItShows) {
    const TemporaryFolder folder;
    const Guide guide = read_guide(source / "docs/touched-edges.md");
    ASSERT_GE(guide.commands.size(), 6u);
    follow(guide, folder.path(), folder / "home");
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
}

}  // namespace
}  // namespace scanmill::test
