// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/run.hpp"

#include <fmt/format.h>

#include <charconv>
#include <csignal>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "commands.hpp"
#include "error_output.hpp"
#include "load.hpp"
#include "printable.hpp"
#include "progress.hpp"
#include "run_output.hpp"
#include "scanmill/filter/error.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::string workflow, unit, until, output_folder = "scanmill-out";
    std::vector<std::string> scans, inputs, settings, only, save;
    unsigned threads = 0;
    std::uint64_t seed = 0;
    bool dry_run = false, json = false, quiet = false;
};

// The one thing a signal handler may touch.
volatile std::sig_atomic_t interrupt_requested = 0;

void on_interrupt(int signal) {
    interrupt_requested = 1;
    std::signal(signal, SIG_DFL);  // a second one ends the program at once
}

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
    FilterLibrary library = open_library();
    const CheckedWorkflow checked = check_workflow(options.workflow, library, parse_settings(options.settings));
    print(checked.diagnostics);
    if (checked.diagnostics.has_errors()) {
        if (options.json) print_files_json({to_json(checked.diagnostics)});
        return bad_request;
    }

    RunRequest request;
    request.scans.assign(options.scans.begin(), options.scans.end());
    request.inputs = parse_inputs(options.inputs);
    request.output_folder = options.output_folder;
    request.unit = parse_unit(options.unit);
    request.seed = options.seed;
    request.only = options.only;
    request.until = options.until;
    request.save = options.save;
    const RunGraph graph = make_graph(checked.plan, library, request);
    if (options.dry_run) {
        fmt::print("{}",
                   options.json ? graph_json(checked.plan, graph) + "\n" : printable(graph_text(checked.plan, graph)));
        return done;
    }

    RunSettings settings;
    settings.threads = options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    settings.seed = options.seed;
    settings.is_cancelled = [] { return interrupt_requested != 0; };
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    Progress progress(checked.plan, graph, options.quiet);
    const RunReport report = run(checked.plan, library, graph, request, settings, progress);
    progress.finish();

    fmt::print("{}", options.json ? report_json(checked.plan, graph, report) + "\n"
                                  : report_text(checked.plan, graph, report));
    if (report.interrupted) {
        fmt::print(stderr, "interrupted; what was written is whole\n");
        return interrupted;
    }
    return report.all_done() ? done : some_failed;
}

/// The command line's own reading takes -1 for the largest number and 010 for eight.
template <class Number>
CLI::Validator whole_number() {
    return CLI::Validator(
        [](const std::string& text) -> std::string {
            Number ignored = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ignored);
            const bool octal = text.size() > 1 && text[0] == '0';
            if (error == std::errc() && end == text.data() + text.size() && !octal) return {};
            return fmt::format("'{}' is no whole number from 0 to {}", text, std::numeric_limits<Number>::max());
        },
        "");
}

/// Empty when results can be put into the folder, which may have to be made.
std::string what_bars_folder(const std::string& folder) {
    if (folder.empty()) return "the output folder's name is empty";
    std::error_code ignored;
    for (std::filesystem::path part = folder; !part.empty(); part = part.parent_path()) {
        if (std::filesystem::is_directory(part, ignored)) break;
        if (std::filesystem::exists(part, ignored))
            return fmt::format("results cannot be put into '{}': '{}' is a file", folder, part.string());
        if (part == part.parent_path()) break;
    }
    return {};
}

}  // namespace

void add_run(CLI::App& app, Action& chosen) {
    CLI::App* command = app.add_subcommand("run", "Runs a workflow over one scan or many");
    auto options = std::make_shared<Options>();
    command->add_option("WORKFLOW", options->workflow, "The workflow file")->required();
    command->add_option(
        "SCAN", options->scans,
        "Files that feed the workflow's first input: one run each, or all of them one run when that input is a "
        "list");
    command->add_option("--in", options->inputs, "Files for the other inputs: NAME=FILE[,FILE…]")
        ->take_all()
        ->allow_extra_args(false);
    command->add_option("--unit", options->unit, "The scans' unit of length: um, mm, cm, m, in, ft");
    command->add_option("-o,--output", options->output_folder, "The output folder")
        ->capture_default_str()
        ->check(CLI::Validator(what_bars_folder, ""));
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
    command
        ->add_option("--threads", options->threads,
                     "Threads inside a filter; 0: as many as the machine has. Results do not depend on it")
        ->capture_default_str()
        ->check(whole_number<unsigned>());
    command->add_option("--seed", options->seed, "Seed of everything random")
        ->capture_default_str()
        ->check(whole_number<std::uint64_t>());
    command->add_flag("--dry-run", options->dry_run, "Print what would be run and written, and stop");
    command->add_flag("--json", options->json, "Print the report as JSON");
    command->add_flag("-q,--quiet", options->quiet, "No progress on stderr");
    command->callback([&chosen, options] { chosen = [options] { return run_workflow(*options); }; });
}

}  // namespace scanmill::runner
