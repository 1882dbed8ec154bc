// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands.hpp"
#include "load.hpp"
#include "scanmill/engine/filter_page.hpp"
#include "text_file.hpp"

namespace scanmill::runner {

namespace {

int docs(const std::string& folder) {
    const FilterLibrary library = open_library();
    std::vector<FilterSpec> specs;
    for (const std::string& name : library.names()) specs.push_back(*library.find(name));
    if (folder.empty()) {
        for (const FilterSpec& spec : specs) fmt::print("{}\n", filter_page(spec));
        return done;
    }
    for (const FilterSpec& spec : specs)
        write_text(std::filesystem::path(folder) / (spec.name + ".md"), filter_page(spec));
    write_text(std::filesystem::path(folder) / "README.md", filter_index(specs));
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
