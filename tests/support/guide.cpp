// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/guide.hpp"
#include "support/folders.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "support/temporary_folder.hpp"

namespace scanmill::test {

namespace {

constexpr std::string_view anything = "…";

std::vector<std::string> lines_of(const std::string& text) {
    std::vector<std::string> lines;
    std::istringstream stream(text);
    for (std::string line; std::getline(stream, line);) lines.push_back(line);
    return lines;
}

bool line_matches(std::string_view expected, std::string_view printed) {
    const std::size_t gap = expected.find(anything);
    if (gap == std::string_view::npos) return expected == printed;
    if (!printed.starts_with(expected.substr(0, gap))) return false;
    const std::string_view rest = expected.substr(gap + anything.size());
    for (std::size_t at = gap; at <= printed.size(); ++at)
        if (line_matches(rest, printed.substr(at))) return true;
    return false;
}

bool matches_from(const std::vector<std::string>& expected, std::size_t e, const std::vector<std::string>& printed,
                  std::size_t p) {
    if (e == expected.size()) return p == printed.size();
    if (expected[e] == anything) {
        for (std::size_t skip = p; skip <= printed.size(); ++skip)
            if (matches_from(expected, e + 1, printed, skip)) return true;
        return false;
    }
    return p < printed.size() && line_matches(expected[e], printed[p]) && matches_from(expected, e + 1, printed, p + 1);
}

void add_commands(const std::vector<std::string>& block, std::size_t line, Guide& guide) {
    for (const std::string& text : block) {
        if (text.starts_with("$ "))
            guide.commands.push_back({line, text.substr(2), {}});
        else if (!guide.commands.empty())
            guide.commands.back().expected.push_back(text);
        ++line;
    }
}

/// Scans run in parallel, so the order of their messages is not fixed. Returns the messages that the lines
/// begin with, sorted, each with the lines that belong to it.
std::vector<std::string> with_messages_sorted(const std::vector<std::string>& lines) {
    std::vector<std::vector<std::string>> messages;
    std::size_t at = 0;
    for (; at < lines.size(); ++at) {
        const bool begins = lines[at].starts_with("error: ") || lines[at].starts_with("warning: ");
        const bool goes_on = lines[at].starts_with("hint: ") || lines[at].starts_with("  ");
        if (begins)
            messages.push_back({lines[at]});
        else if (goes_on && !messages.empty())
            messages.back().push_back(lines[at]);
        else
            break;
    }
    std::ranges::sort(messages);
    std::vector<std::string> sorted;
    for (const std::vector<std::string>& message : messages)
        sorted.insert(sorted.end(), message.begin(), message.end());
    sorted.insert(sorted.end(), lines.begin() + static_cast<std::ptrdiff_t>(at), lines.end());
    return sorted;
}

}  // namespace

Guide read_guide(const std::filesystem::path& markdown) {
    Guide guide;
    const std::vector<std::string> lines = lines_of(content_of(markdown));
    std::string file;
    bool run = false;
    for (std::size_t at = 0; at < lines.size(); ++at) {
        constexpr std::string_view file_mark = "<!-- file: ", end_mark = " -->";
        if (lines[at].starts_with(file_mark))
            file = lines[at].substr(file_mark.size(), lines[at].size() - file_mark.size() - end_mark.size());
        if (lines[at] == "<!-- run -->") run = true;
        if (!lines[at].starts_with("```")) continue;
        std::vector<std::string> block;
        const std::size_t first = at + 1;
        for (++at; at < lines.size() && lines[at] != "```"; ++at) block.push_back(lines[at]);
        if (run) add_commands(block, first + 1, guide);
        if (!file.empty()) {
            std::string content;
            for (const std::string& line : block) content += line + "\n";
            guide.files.push_back({file, content});
        }
        file.clear();
        run = false;
    }
    return guide;
}

bool matches(const std::vector<std::string>& expected, const std::vector<std::string>& printed) {
    return matches_from(with_messages_sorted(expected), 0, with_messages_sorted(printed), 0);
}

void follow(const Guide& guide, const std::filesystem::path& folder, const std::filesystem::path& home) {
    for (const GuideFile& file : guide.files) {
        std::filesystem::create_directories((folder / file.name).parent_path());
        std::ofstream(folder / file.name, std::ios::binary) << file.content;
    }
    // One shell for all, so that `export` lasts; what a command prints goes to a file of its own.
    const TemporaryFolder outputs;
    std::string script = "cd '" + folder.string() + "'\nexport HOME='" + home.string() + "'\nexport PATH='" +
                         std::filesystem::path(program_file()).parent_path().string() +
                         "':$PATH\nunset SCANMILL_PLUGIN_PATH XDG_CACHE_HOME\n";
    for (std::size_t i = 0; i < guide.commands.size(); ++i)
        script += "{ " + guide.commands[i].text + "\n} >'" + (outputs / std::to_string(i)).string() + "' 2>&1\n";
    const std::filesystem::path file = outputs.write("script", script);
    const int ended = std::system(("sh '" + file.string() + "'").c_str());
    EXPECT_NE(ended, -1);
    for (std::size_t i = 0; i < guide.commands.size(); ++i) {
        const std::string printed = content_of(outputs / std::to_string(i));
        EXPECT_TRUE(matches(guide.commands[i].expected, lines_of(printed)))
            << "line " << guide.commands[i].line << ": " << guide.commands[i].text << "\nprinted:\n"
            << printed;
    }
}

}  // namespace scanmill::test
