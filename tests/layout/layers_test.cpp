// SPDX-License-Identifier: GPL-3.0-or-later
// The layers of core, geometry and engine: which folder may include which, and that core and engine name neither
// filters nor options.
#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <filesystem>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "scanmill/kinds/kind.hpp"
#include "support/folders.hpp"
#include "support/temporary_folder.hpp"

namespace {

namespace fs = std::filesystem;

/// In each library a folder may include itself and those before it; engine may include all of core. Geometry may
/// include what comes before kinds, and neither core nor engine may include geometry.
const std::vector<std::string> layers{"base",     "io",     "record",  "data",    "geometry", "kinds",   "formats",
                                      "filter",   "plugin",  // core
                                      "workflow", "plan",   "gate",    "batch",   "graph",    "cache",   "worker",
                                      "run",      "report", "records", "compare", "session",  "describe"};  // engine
const std::vector<std::string> geometry_layers{"spatial",  "fit",     "mesh",         "tets",
                                               "distance", "growing", "registration", "patches"};

struct Include {
    std::string file;  ///< relative to core/, geometry/ or engine/: "scanmill/io/atomic_file.cpp"
    std::string target;  ///< "scanmill/base/error.hpp"
};

std::vector<Include> all_includes() {
    std::vector<Include> includes;
    const std::regex pattern("^\\s*#\\s*include\\s*[\"<](scanmill/[^\">]+)[\">]");
    for (const char* library : {"core", "geometry", "engine"}) {
        const fs::path root = fs::path(scanmill::test::source_folder()) / library;
        for (const auto& entry : fs::recursive_directory_iterator(root / "scanmill")) {
            if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
            std::ifstream stream(entry.path());
            for (std::string line; std::getline(stream, line);)
                if (std::smatch match; std::regex_search(line, match, pattern))
                    includes.push_back({fs::relative(entry.path(), root).string(), match[1]});
        }
    }
    return includes;
}

std::string folder_of(const std::string& file) {
    const std::string folder = file.substr(0, file.rfind('/'));
    return folder.ends_with("/detail") ? folder.substr(0, folder.size() - std::string("/detail").size()) : folder;
}

/// The part of a path: part_of("scanmill/data/topology.hpp", 2) is "mesh".
std::string part_of(const std::string& path, std::size_t index) {
    std::size_t begin = 0;
    for (; index > 0; --index) begin = path.find('/', begin) + 1;
    return path.substr(begin, path.find('/', begin) - begin);
}

std::ptrdiff_t rank_in(const std::vector<std::string>& order, const std::string& folder) {
    const auto found = std::find(order.begin(), order.end(), folder);
    return found == order.end() ? -1 : found - order.begin();
}

TEST(Layers, EveryFolderIsInTheList) {
    for (const Include& include : all_includes())
        EXPECT_GE(rank_in(layers, part_of(include.file, 1)), 0) << include.file << " is in a folder without a layer";
}

TEST(Layers, NoFileIncludesAHigherLayer) {
    const std::vector<Include> includes = all_includes();
    ASSERT_GT(includes.size(), 400u);
    for (const Include& include : includes) {
        const std::string from = part_of(include.file, 1), to = part_of(include.target, 1);
        EXPECT_LE(rank_in(layers, to), rank_in(layers, from)) << include.file << " includes " << include.target;
        if (to != "geometry") continue;
        EXPECT_EQ(from, "geometry") << include.file << " includes " << include.target;
        EXPECT_LE(rank_in(geometry_layers, part_of(include.target, 2)),
                  rank_in(geometry_layers, part_of(include.file, 2)))
            << include.file << " includes " << include.target;
    }
}

TEST(Layers, NoCycleBetweenFolders) {
    std::map<std::string, std::set<std::string>> reachable;
    for (const Include& include : all_includes())
        if (folder_of(include.file) != folder_of(include.target))
            reachable[folder_of(include.file)].insert(folder_of(include.target));
    for (bool grew = true; grew;) {
        grew = false;
        for (auto& [folder, targets] : reachable)
            for (const std::string& target : std::set<std::string>(targets))
                if (const auto next = reachable.find(target); next != reachable.end())
                    for (const std::string& further : std::set<std::string>(next->second))
                        grew |= targets.insert(further).second;
    }
    for (const auto& [folder, targets] : reachable)
        EXPECT_FALSE(targets.contains(folder)) << folder << " includes itself through other folders";
}

TEST(Layers, PrivateHeadersStayInTheirFolder) {
    for (const Include& include : all_includes()) {
        if (include.target.find("/detail/") == std::string::npos) continue;
        EXPECT_EQ(folder_of(include.file), folder_of(include.target))
            << include.file << " includes the private " << include.target;
        const bool is_public = include.file.ends_with(".hpp") && include.file.find("/detail/") == std::string::npos;
        EXPECT_FALSE(is_public) << "the installed " << include.file << " includes the private " << include.target;
    }
}

/// A string literal, and the code before it on its line.
struct Literal {
    std::string place;  ///< "engine/scanmill/batch/batch.cpp:7"
    std::string before, text;
};

/// All string literals of a source, without those of includes and comments; escapes stay as they are written.
std::vector<Literal> literals_in(const std::string& file, const std::string& source) {
    std::vector<Literal> literals;
    std::size_t line = 1, line_begin = 0;
    const auto skip_to = [&](std::size_t& at, std::size_t end) {
        for (end = std::min(end, source.size()); at < end; ++at)
            if (source[at] == '\n') {
                ++line;
                line_begin = at + 1;
            }
    };
    for (std::size_t at = 0; at < source.size();) {
        if (source.compare(at, 2, "//") == 0 || source[at] == '#') {
            skip_to(at, source.find('\n', at));
        } else if (source.compare(at, 3, "R\"(") == 0) {
            const std::size_t end = source.find(")\"", at);
            literals.push_back({file + ":" + std::to_string(line), source.substr(line_begin, at - line_begin),
                                source.substr(at + 3, end - at - 3)});
            skip_to(at, end + 2);
        } else if (source[at] == '"' || (source[at] == '\'' && (at == 0 || !std::isalnum(source[at - 1])))) {
            std::size_t end = at + 1;
            while (source[end] != source[at]) end += source[end] == '\\' ? 2 : 1;
            if (source[at] == '"')
                literals.push_back({file + ":" + std::to_string(line), source.substr(line_begin, at - line_begin),
                                    source.substr(at + 1, end - at - 1)});
            at = end + 1;
        } else {
            skip_to(at, at + 1);
        }
    }
    return literals;
}

std::vector<Literal> literals_of_core_and_engine() {
    std::vector<Literal> all;
    for (const char* library : {"core", "engine"})
        for (const auto& entry :
             fs::recursive_directory_iterator(fs::path(scanmill::test::source_folder()) / library / "scanmill")) {
            if (entry.path().extension() != ".hpp" && entry.path().extension() != ".cpp") continue;
            const std::string file = fs::relative(entry.path(), scanmill::test::source_folder()).string();
            const std::vector<Literal> literals = literals_in(file, scanmill::test::content_of(entry.path()));
            all.insert(all.end(), literals.begin(), literals.end());
        }
    return all;
}

/// Kinds and keys of a batch, which may have the names of filters.
std::set<std::string> words_of_the_grammar() {
    std::set<std::string> words;
    for (const scanmill::Kind kind : scanmill::all_kinds()) words.insert(std::string(name_of(kind)));
    const fs::path schema = fs::path(scanmill::test::source_folder()) / "schemas/batch.schema.json";
    const auto properties = nlohmann::json::parse(scanmill::test::content_of(schema))["properties"];
    for (const auto& [key, value] : properties.items()) words.insert(key);
    return words;
}

TEST(Layers, CoreAndEngineNameNoFilter) {
    const std::set<std::string> words = words_of_the_grammar();
    ASSERT_TRUE(words.contains("measure") && words.contains("features"));
    std::string unmistakable, all, hyphenated;
    for (const auto& entry : fs::directory_iterator(fs::path(scanmill::test::source_folder()) / "filters")) {
        if (!entry.is_directory()) continue;
        std::string name = entry.path().filename().string();
        std::replace(name.begin(), name.end(), '_', '-');
        all += (all.empty() ? "" : "|") + name;
        if (!words.contains(name)) unmistakable += (unmistakable.empty() ? "" : "|") + name;
        if (name.find('-') != std::string::npos) hyphenated += (hyphenated.empty() ? "" : "|") + name;
    }
    const std::regex is_name("(" + unmistakable + ")"),
        has_hyphenated("(^|[^a-z0-9-])(" + hyphenated + ")($|[^a-z0-9-])"),
        quotes_name("['`](- )?(" + unmistakable + ")['`:]"), is_any_name("(" + all + ")"),
        looks_up("((find|load|build_id|module_file) *\\(|(filter|name) *==) *$");
    const std::vector<Literal> literals = literals_of_core_and_engine();
    ASSERT_GT(literals.size(), 3000u);
    for (const Literal& literal : literals) {
        const bool names_filter =
            std::regex_match(literal.text, is_name) || std::regex_search(literal.text, has_hyphenated) ||
            std::regex_search(literal.text, quotes_name) ||
            (std::regex_match(literal.text, is_any_name) && std::regex_search(literal.before, looks_up));
        EXPECT_FALSE(names_filter) << literal.place << ": \"" << literal.text << "\"";
    }
}

TEST(Layers, CoreAndEngineNameNoOption) {
    const std::regex option("(^|[ `'(\\[])--[a-z]|^-o");
    for (const Literal& literal : literals_of_core_and_engine())
        EXPECT_FALSE(std::regex_search(literal.text, option)) << literal.place << ": \"" << literal.text << "\"";
}

}  // namespace
