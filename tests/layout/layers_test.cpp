// SPDX-License-Identifier: GPL-3.0-or-later
// The layers of core, geometry and engine: which folder may include which.
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include "support/folders.hpp"

namespace {

namespace fs = std::filesystem;

/// In each library a folder may include itself and those before it; engine may include all of core. Geometry may
/// include what comes before kinds, and neither core nor engine may include geometry.
const std::vector<std::string> layers{"base",     "io",     "record",  "data",    "geometry", "kinds",
                                      "formats",  "filter", "plugin",  // core
                                      "workflow", "plan",   "gate",    "batch",   "graph",    "cache",
                                      "worker",   "run",    "records", "compare", "session",  "describe"};  // engine
const std::vector<std::string> geometry_layers{"spatial", "fit", "mesh", "tets", "distance", "growing", "patches"};

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

}  // namespace
