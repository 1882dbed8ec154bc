// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/reproduce.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "scanmill/base/text.hpp"
#include "scanmill/compare/utf8.hpp"

namespace scanmill::runner {

namespace {

/// Whether the text has control characters or invalid UTF-8, which a terminal or a text file cannot contain.
bool is_unprintable(const std::string& text) {
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t length = character_length(std::string_view(text).substr(at));
        if (length == 0 || is_control(text[at])) return true;
        at += length;
    }
    return false;
}

/// Options of `run` that take a value and affect results.
constexpr std::array<std::string_view, 6> deciding{"--in", "--set", "--unit", "--invalid", "--until", "--save"};

/// The options in `deciding` of the recorded command line, each with its value, and the flag `--picture`.
std::string deciding_options(const std::vector<std::string>& arguments) {
    std::string options;
    for (std::size_t i = 0; i < arguments.size(); ++i) {
        const std::string name = arguments[i].substr(0, arguments[i].find('='));
        if (arguments[i] == "--") break;
        if (name == "--picture") options += " --picture";
        if (std::ranges::find(deciding, name) == deciding.end()) continue;
        options += " " + quoted_word(arguments[i]);
        if (name == arguments[i] && i + 1 < arguments.size()) options += " " + quoted_word(arguments[++i]);
    }
    return options;
}

/// The recorded arguments of a run over a list of scans, without the options for variants and for the output folder.
std::string same_arguments(const std::vector<std::string>& arguments) {
    constexpr std::array<std::string_view, 3> dropped{"-o", "--output", "--only"};
    std::string words;
    for (std::size_t i = 2; i < arguments.size(); ++i) {
        const std::string name = arguments[i].substr(0, arguments[i].find('='));
        if (std::ranges::find(dropped, name) == dropped.end())
            words += " " + quoted_word(arguments[i]);
        else if (name == arguments[i])
            ++i;
    }
    return words;
}

}  // namespace

std::string quoted_word(const std::string& text) {
    if (!is_unprintable(text)) {
        const std::size_t dashes = std::min(text.find_first_not_of('-'), text.size());
        const std::string word =
            shell_word(text.substr(dashes));  // shell_word() alone would quote the dashes of an option
        return word == text.substr(dashes) ? text : shell_word(text);
    }
    std::string word = "$'";
    for (std::string_view rest = text; !rest.empty();) {
        const std::size_t length = character_length(rest);
        const char c = rest.front();
        if (c == '\n')
            word += "\\n";
        else if (length == 0 || is_control(c))
            word += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
        else
            word.append(c == '\'' || c == '\\' ? "\\" : "").append(rest.substr(0, length));
        rest.remove_prefix(std::max<std::size_t>(1, length));
    }
    return word + "'";
}

std::string reproducing_command(const RunDetails& run, const CellRecord& cell, const std::string& scan) {
    const bool is_batch = run.start.arguments.size() > 1 && run.start.arguments[1] == "batch";
    const bool takes_one_scan = cell.scan != cell.workflow;  // otherwise it takes a list of scans or none
    const bool has_several_workflows =
        std::ranges::any_of(run.cells, [&](const CellRecord& other) { return other.workflow != cell.workflow; });
    std::string command = is_batch ? "scanmill batch " : "scanmill run ";
    if (is_batch) {
        command += quoted_word(run.start.file);
        if (takes_one_scan) command += " --scan " + quoted_word(scan);
        if (has_several_workflows) command += " --workflow " + quoted_word(cell.workflow);
        if (run.start.seed != 0) command += fmt::format(" --seed {}", run.start.seed);
    } else if (takes_one_scan) {
        command += quoted_word(run.start.file) + " " + quoted_word(cell.scan);
        command += deciding_options(run.start.arguments);
        if (run.start.seed != 0) command += fmt::format(" --seed {}", run.start.seed);
    } else {
        command.pop_back();
        command += same_arguments(run.start.arguments);
    }
    return command + " --only " + quoted_word(cell.variant) + " -o reproduced";
}

}  // namespace scanmill::runner
