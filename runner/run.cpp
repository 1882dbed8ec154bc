// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/run.hpp"

#include <fmt/format.h>

#include <charconv>
#include <csignal>
#include <filesystem>
#include <limits>
#include <nlohmann/json.hpp>
#include <thread>

#include "cache_options.hpp"
#include "commands.hpp"
#include "error_output.hpp"
#include "load.hpp"
#include "machine.hpp"
#include "printable.hpp"
#include "progress.hpp"
#include "run_output.hpp"
#include "scanmill/engine/observers.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/filter/module.hpp"
#include "scanmill/records/reasons.hpp"
#include "scanmill/records/recorder.hpp"

namespace scanmill::runner {

namespace {

struct Options {
    std::string workflow, unit, until, output_folder = "scanmill-out";
    std::vector<std::string> scans, inputs, settings, only, save;
    unsigned threads = 0;
    std::uint64_t seed = 0;
    bool dry_run = false, json = false, quiet = false;
    CacheOptions cache;
    std::vector<std::string> command_line;
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

void warn(const std::string& text) { fmt::print(stderr, "warning: {}\n", printable(text)); }

/// Nothing, after a warning, where they cannot be opened: results count more than records of them.
std::optional<RunRecords> open_records(const std::filesystem::path& folder) {
    try {
        std::error_code trouble;
        std::filesystem::create_directories(folder, trouble);
        return RunRecords::append_to(folder / records_file);
    } catch (const Error& error) {
        warn(fmt::format("this run is not recorded: {}", error.sentence()));
        return std::nullopt;
    }
}

/// What changed since the last run into the same folder; without records of one nothing is known.
void explain_from_records(std::vector<NodeForesight>& foresight, const Plan& plan, FilterLibrary& library,
                          const RunGraph& graph, const RunRequest& request) {
    const std::filesystem::path file = request.output_folder / records_file;
    std::error_code absent;
    if (!std::filesystem::exists(file, absent)) return;
    try {
        explain(foresight, plan, library, graph, request.seed, RunRecords::read(file));
    } catch (const Error& error) {
        warn(fmt::format("what changed since the last run is not known: {}", error.sentence()));
    }
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
    const std::unique_ptr<Cache> cache = open_cache(options.cache);
    const RunGraph graph = make_graph(checked.plan, library, request, [&](const std::filesystem::path& file) {
        return cache ? cache->file_hash(file) : content_hash(file);
    });
    std::vector<NodeForesight> foresight = foresee(checked.plan, graph, cache.get());
    if (cache) explain_from_records(foresight, checked.plan, library, graph, request);
    if (options.dry_run) {
        fmt::print("{}", options.json ? graph_json(checked.plan, graph, foresight) + "\n"
                                      : printable(graph_text(checked.plan, graph, foresight)));
        return done;
    }

    RunSettings settings;
    settings.threads = options.threads > 0 ? options.threads : std::max(1u, std::thread::hardware_concurrency());
    settings.seed = options.seed;
    settings.cache = cache.get();
    settings.foresight = std::move(foresight);
    settings.keep = keep_policy(options.cache);
    settings.is_cancelled = [] { return interrupt_requested != 0; };
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    Progress progress(checked.plan, graph, options.quiet);
    std::optional<RunRecords> records = open_records(request.output_folder);
    std::optional<Recorder> recorder;
    std::vector<RunObserver*> observing{&progress};
    if (records) {
        const RunStart start{workflow_name(checked.plan),
                             options.workflow,
                             options.command_line,
                             options.seed,
                             settings.threads,
                             SCANMILL_VERSION,
                             machine_text()};
        recorder.emplace(*records, start, checked.plan, library, graph, warn);
        observing.push_back(&*recorder);
    }
    Observers observers(observing);
    const RunReport report = run(checked.plan, library, graph, request, settings, observers);
    progress.finish();
    if (recorder) recorder->finish(report);
    if (cache) cache->evict();

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

void add_run(CLI::App& app, Action& chosen, std::vector<std::string> command_line) {
    CLI::App* command = app.add_subcommand("run", "Runs a workflow over one scan or many");
    auto options = std::make_shared<Options>();
    options->command_line = std::move(command_line);
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
    add_cache_options(*command, options->cache, true);
    command->add_flag("--dry-run", options->dry_run,
                      "Print what would be run and why, what is cached, and what would be written, and stop");
    command->add_flag("--json", options->json, "Print the report as JSON");
    command->add_flag("-q,--quiet", options->quiet, "No progress on stderr");
    command->callback([&chosen, options] { chosen = [options] { return run_workflow(*options); }; });
}

}  // namespace scanmill::runner
