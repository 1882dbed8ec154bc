// SPDX-License-Identifier: GPL-3.0-or-later
// The page on converting names every column that `convert --to-unit` scales, and no other.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <regex>
#include <set>

#include "support/folders.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

using Names = std::set<std::string>;

/// What the pattern's first group matches.
Names matches_in(const std::string& text, const std::string& pattern) {
    const std::regex expression(pattern);
    Names all;
    for (std::sregex_iterator match(text.begin(), text.end(), expression), end; match != end; ++match)
        all.insert((*match)[1]);
    return all;
}

TEST(LengthColumns, ThePageOnConvertNamesThem) {
    const std::filesystem::path root = test::source_folder();
    Names scaled;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(root / "filters"))
        if (entry.path().extension() == ".cpp")
            scaled.merge(matches_in(content_of(entry.path()),
                                    "Column\\(\"([a-z0-9-]+)\"[^\n]*with_length_exponent\\((?:1|-1)\\)"));
    ASSERT_TRUE(scaled.contains("bin-size") && scaled.contains("curvature-1"));
    const std::string page = content_of(root / "docs/how-to/convert-files.md");
    const std::size_t begin = page.find("`--to-unit mm` multiplies");
    ASSERT_NE(begin, std::string::npos);
    const std::string named = page.substr(begin + 15, page.find("\n\n", begin) - begin - 15);
    EXPECT_EQ(matches_in(named, "`([a-z0-9-]+)`"), scaled);
}

}  // namespace
}  // namespace scanmill::test
