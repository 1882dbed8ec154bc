// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Guides in docs/ that are run word by word: files that a reader is asked to write, commands that he is asked to type,
/// and what they print.
///
/// A fenced block after the line `<!-- file: NAME -->` is a file's content; one after `<!-- run -->` holds commands,
/// each after `$ `, followed by what it prints on stdout and stderr. There, a line `…` alone matches any lines,
/// and `…` within a line for anything. Other blocks are for the eye. Commands of one guide run in one shell, in one
/// folder.

#include <filesystem>
#include <string>
#include <vector>

namespace scanmill::test {

struct GuideCommand {
    std::size_t line;  ///< line in the guide
    std::string text;
    std::vector<std::string> expected;
};

struct GuideFile {
    std::string name, content;
};

struct Guide {
    std::vector<GuideFile> files;
    std::vector<GuideCommand> commands;
};

Guide read_guide(const std::filesystem::path& markdown);

/// Whether what was printed is what the guide shows.
bool matches(const std::vector<std::string>& expected, const std::vector<std::string>& printed);

/// Writes the files below `folder` and runs the commands there, each an expectation of the test. The built program is
/// `scanmill` there, and `home` the reader's home folder.
void follow(const Guide& guide, const std::filesystem::path& folder, const std::filesystem::path& home);

}  // namespace scanmill::test
