// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "commands/commands.hpp"
#include "commands/load.hpp"
#include "output/text_file.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/describe/filter_page.hpp"

namespace scanmill::runner {

namespace {

/// Throws Error for a file that somebody else wrote, and for what is no file.
void require_replaceable(const std::filesystem::path& file) {
    std::error_code absent;
    if (!std::filesystem::exists(file, absent)) return;
    std::string text;
    if (std::ifstream stream(file); std::filesystem::is_regular_file(file, absent))
        text.assign(std::istreambuf_iterator<char>(stream), {});
    if (!is_filter_page(text))
        throw Error("'{}' is there and was not written by scanmill docs", file.string())
            .hint("choose another folder, or move it away");
}

int docs(const std::string& folder) {
    const FilterLibrary library = open_library();
    std::vector<FilterSpec> specs;
    for (const std::string& name : library.names()) specs.push_back(*library.find(name));
    if (folder.empty()) {
        for (const FilterSpec& spec : specs) fmt::print("{}\n", filter_page(spec, library));
        return done;
    }
    std::vector<std::pair<std::filesystem::path, std::string>> pages;
    for (const FilterSpec& spec : specs)
        pages.emplace_back(std::filesystem::path(folder) / (spec.name + ".md"), filter_page(spec, library));
    pages.emplace_back(std::filesystem::path(folder) / "README.md", filter_index(specs));
    for (const auto& [file, page] : pages) require_replaceable(file);
    for (const auto& [file, page] : pages) write_text(file, page);
    return done;
}

}  // namespace

void add_docs(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand("docs", "Prints a page about every filter at hand, in Markdown");
    auto folder = std::make_shared<std::string>();
    command->add_option("-o,--output", *folder, "Write a file for each filter into this folder instead");
    command->callback([&chosen, folder] { chosen = [folder] { return docs(*folder); }; });
}

}  // namespace scanmill::runner
