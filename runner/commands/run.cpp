// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <filesystem>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/execute.hpp"
#include "commands/load.hpp"
#include "output/error_output.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/plugin/module.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::string workflow, unit, until;
    std::vector<std::string> scans, inputs, settings, only, save;
    ExecuteOptions execute;
};

std::map<std::string, std::vector<std::filesystem::path>> parse_inputs(const std::vector<std::string>& pairs) {
    std::map<std::string, std::vector<std::filesystem::path>> inputs;
    for (const std::string& pair : pairs) {
        const std::size_t equals = pair.find('=');
        if (equals == 0 || equals == std::string::npos || equals + 1 == pair.size())
            throw Error("--in {}: expected NAME=FILE or NAME=FILE,FILE…", pair);
        std::vector<std::filesystem::path>& files = inputs[pair.substr(0, equals)];
        for (std::size_t begin = equals + 1, end; begin <= pair.size(); begin = end + 1) {
            end = std::min(pair.find(',', begin), pair.size());
            files.emplace_back(pair.substr(begin, end - begin));
        }
    }
    return inputs;
}

int run_workflow(const Options& options) {
    const Warn warn = warning_teller();
    const std::unique_ptr<Cache> cache = open_cache(options.execute.cache, warn);
    const std::unique_ptr<Session> session = open_session(options.execute, cache.get());
    FilterLibrary library = open_library();
    const std::string workflow = workflow_file(options.workflow);
    const std::string text = read_workflow_file(workflow);
    if (is_batch(text)) throw Error("'{}' is a batch, not a workflow", workflow).hint("scanmill batch " + workflow);
    const CheckedWorkflow checked = check_workflow(workflow, text, library, parse_settings(options.settings));
    print(checked.diagnostics);
    if (checked.diagnostics.has_errors()) {
        if (options.execute.json) print_files_json({to_json(checked.diagnostics)});
        return bad_request;
    }

    RunRequest request;
    for (const std::string& scan : options.scans) request.scans.emplace_back(scan);
    request.inputs = parse_inputs(options.inputs);
    if (!checked.plan.workflow.inputs.empty())  // `--in` feeds the first input, too
        if (auto first = request.inputs.extract(checked.plan.workflow.inputs.front().name))
            for (const std::filesystem::path& file : first.mapped()) request.scans.emplace_back(file);
    request.output_folder = options.execute.output_folder;
    request.unit = parse_unit(options.unit);
    request.seed = options.execute.seed;
    request.only = options.only;
    request.until = options.until;
    request.save = options.save;
    SessionTask task{workflow_name(checked.plan),
                     workflow,
                     make_graph(checked.plan, library, request,
                                [&](const std::filesystem::path& file) {
                                    return cache ? cache->file_hash(file) : content_hash(file);
                                }),
                     {}};
    return execute(task, false, *session, library, warn, options.execute);
}

}  // namespace

void add_run(CLI::App& app, Action& chosen, std::vector<std::string> command_line) {
    CLI::App* command = app.add_subcommand("run", "Runs a workflow over one scan or many");
    auto options = std::make_shared<Options>();
    options->execute.command_line = std::move(command_line);
    command
        ->add_option("WORKFLOW", options->workflow,
                     "The workflow file, or the name of a shipped one, such as bernardini-1997")
        ->required();
    command->add_option(
        "SCAN", options->scans,
        "Files that feed the workflow's first input: one run each, or all of them one run when that input is a "
        "list");
    command->add_option("--in", options->inputs, "Files for an input: NAME=FILE[,FILE…]")
        ->take_all()
        ->allow_extra_args(false);
    command->add_option("--unit", options->unit, "The scans' unit of length: um, mm, cm, m, in, ft");
    command->add_option("--set", options->settings, "A workflow parameter's value, NAME=VALUE")
        ->take_all()
        ->allow_extra_args(false);
    command->add_option("--only", options->only, "Run only this variant (may be repeated)")
        ->take_all()
        ->allow_extra_args(false);
    command->add_option("--until", options->until, "Stop after this step");
    command->add_option("--save", options->save, "Also write this step's result, STEP or STEP.PORT (may be repeated)")
        ->take_all()
        ->allow_extra_args(false);
    add_execute_options(*command, options->execute);
    command->add_flag("--json", options->execute.json, "Print the report as JSON");
    command->callback([&chosen, options] { chosen = [options] { return run_workflow(*options); }; });
}

}  // namespace scanmill::runner
