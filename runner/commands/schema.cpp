// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands/commands.hpp"
#include "commands/load.hpp"
#include "output/text_file.hpp"
#include "scanmill/describe/batch_schema.hpp"
#include "scanmill/describe/workflow_schema.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::string kind = "workflow", folder;
};

int schema(const Options& options) {
    const FilterLibrary library = open_library();
    if (options.folder.empty()) {
        fmt::print("{}", options.kind == "batch" ? batch_schema() : workflow_schema(library));
        return done;
    }
    const std::filesystem::path folder(options.folder);
    write_text(folder / "workflow.schema.json", workflow_schema(library));
    write_text(folder / "batch.schema.json", batch_schema());
    return done;
}

}  // namespace

void add_schema(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand(
        "schema",
        "Prints the JSON Schema of workflow or batch files, for editors: every filter at hand with its parameters");
    auto options = std::make_shared<Options>();
    CLI::Option* kind = command->add_option("KIND", options->kind, "Which to print: workflow (the default) or batch")
                            ->check(CLI::IsMember({"workflow", "batch"}));
    command
        ->add_option("-o,--output", options->folder,
                     "Write both, workflow.schema.json and batch.schema.json, into this folder instead")
        ->excludes(kind);
    command->callback([&chosen, options] { chosen = [options] { return schema(*options); }; });
}

}  // namespace scanmill::runner
