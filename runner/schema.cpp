// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "commands.hpp"
#include "load.hpp"
#include "scanmill/engine/workflow_schema.hpp"
#include "text_file.hpp"

namespace scanmill::runner {

void add_schema(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand(
        "schema", "Prints the JSON Schema of workflow files, for editors: every filter at hand with its parameters");
    auto folder = std::make_shared<std::string>();
    command->add_option("-o,--output", *folder, "Write workflow.schema.json into this folder instead");
    command->callback([&chosen, folder] {
        chosen = [folder] {
            const std::string schema = workflow_schema(open_library());
            if (folder->empty())
                fmt::print("{}", schema);
            else
                write_text(std::filesystem::path(*folder) / "workflow.schema.json", schema);
            return done;
        };
    });
}

}  // namespace scanmill::runner
