// SPDX-License-Identifier: GPL-3.0-or-later
// Pages are short, and their relative links lead to files and headings that exist.

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <iterator>
#include <map>
#include <regex>
#include <set>
#include <sstream>

#include "support/folders.hpp"
#include "support/temporary_folder.hpp"

namespace scanmill::test {
namespace {

namespace fs = std::filesystem;

const fs::path tree = test::source_folder();

std::vector<fs::path> pages_of_docs() {
    std::vector<fs::path> pages;
    for (const auto& entry : fs::recursive_directory_iterator(tree / "docs"))
        if (entry.path().extension() == ".md") pages.push_back(entry.path());
    std::ranges::sort(pages);
    return pages;
}

std::vector<fs::path> linked_pages() {
    std::vector<fs::path> pages = pages_of_docs();
    pages.push_back(tree / "README.md");
    for (const auto& entry : fs::directory_iterator(tree / "filters"))
        if (fs::exists(entry.path() / "README.md")) pages.push_back(entry.path() / "README.md");
    return pages;
}

/// The page without its fenced blocks.
std::string prose_of(const std::string& markdown) {
    std::istringstream lines(markdown);
    std::string prose;
    bool fenced = false;
    for (std::string line; std::getline(lines, line);) {
        if (line.starts_with("```"))
            fenced = !fenced;
        else if (!fenced)
            prose += line + "\n";
    }
    return prose;
}

std::string without_code_spans(const std::string& prose) {
    std::string rest;
    for (std::size_t at = 0; at < prose.size();) {
        const std::size_t begin = std::min(prose.find('`', at), prose.size());
        rest += prose.substr(at, begin - at);
        const std::size_t end = begin < prose.size() ? prose.find('`', begin + 1) : std::string::npos;
        at = end == std::string::npos ? prose.size() : end + 1;
    }
    return rest;
}

/// The targets of its links and pictures.
std::vector<std::string> link_targets(const std::string& markdown) {
    const std::regex link(R"re(\]\(([^)\s]+)\)|<img src="([^"]+)")re");
    const std::string prose = without_code_spans(prose_of(markdown));
    std::vector<std::string> targets;
    for (std::sregex_iterator match(prose.begin(), prose.end(), link), end; match != end; ++match)
        targets.push_back((*match)[1].matched ? (*match)[1] : (*match)[2]);
    return targets;
}

/// The anchors of its headings, as GitHub makes them: letters, digits and hyphens; a repeated one gets a number.
std::set<std::string> anchors_of(const std::string& markdown) {
    std::istringstream lines(prose_of(markdown));
    std::set<std::string> anchors;
    std::map<std::string, int> seen;
    for (std::string line; std::getline(lines, line);) {
        const std::size_t level = line.find_first_not_of('#');
        if (level == 0 || level == std::string::npos || line[level] != ' ') continue;
        const std::string heading =
            std::regex_replace(line.substr(level + 1), std::regex(R"(\[([^\]]*)\]\([^)]*\))"), "$1");
        std::string anchor;
        for (const unsigned char c : heading) {
            if (std::isalnum(c) != 0 || c == '-' || c == '_') anchor += static_cast<char>(std::tolower(c));
            if (c == ' ') anchor += '-';
        }
        const int earlier = seen[anchor]++;
        anchors.insert(earlier == 0 ? anchor : anchor + "-" + std::to_string(earlier));
    }
    return anchors;
}

TEST(Links, Anchors_AreThoseOfTheHeadings) {
    EXPECT_THAT(anchors_of("# The `name`, a test\n```\n# not this\n```\n## Twice\n## Twice\n### [E57](#e57) and PTX\n"),
                testing::ElementsAre("e57-and-ptx", "the-name-a-test", "twice", "twice-1"));
}

TEST(Links, Targets_AreThoseOutsideCode) {
    EXPECT_THAT(link_targets("[a](b.md) ![c\nd](e.png#f) `[g](h)`\n```\n[i](j)\n```\n<img src=\"k.png\" width=\"9\">"),
                testing::ElementsAre("b.md", "e.png#f", "k.png"));
}

TEST(Links, RelativeLinks_LeadToFilesAndHeadings) {
    for (const fs::path& page : linked_pages()) {
        for (const std::string& target : link_targets(content_of(page))) {
            if (target.find(':') != std::string::npos) continue;  // a web address
            const std::size_t hash = std::min(target.find('#'), target.size());
            const fs::path file = hash == 0 ? page : page.parent_path() / target.substr(0, hash);
            EXPECT_TRUE(fs::exists(file)) << fs::relative(page, tree) << " links to " << target;
            if (hash == target.size() || file.extension() != ".md" || !fs::exists(file)) continue;
            EXPECT_THAT(anchors_of(content_of(file)), testing::Contains(target.substr(hash + 1)))
                << fs::relative(page, tree) << " links to " << target;
        }
    }
}

TEST(Links, PagesHaveAtMost300Lines) {
    for (const fs::path& page : linked_pages()) {
        const std::string content = content_of(page);
        EXPECT_LE(std::ranges::count(content, '\n'), 300) << fs::relative(page, tree);
    }
}

TEST(Links, TheFirstPageHasAtMost900Words) {
    std::istringstream words(content_of(tree / "README.md"));
    EXPECT_LE(std::distance(std::istream_iterator<std::string>(words), {}), 900);
}

TEST(Links, EveryReadyWorkflow_IsOnItsPage) {
    const std::vector<std::string> targets = link_targets(content_of(tree / "docs/reference/ready-workflows.md"));
    for (const auto& entry : fs::directory_iterator(tree / "workflows"))
        if (entry.path().extension() == ".yaml") {
            EXPECT_THAT(targets, testing::Contains("../../workflows/" + entry.path().filename().string()));
        }
}

}  // namespace
}  // namespace scanmill::test
