// SPDX-License-Identifier: GPL-3.0-or-later
// `run` and `batch`: from the command line to a graph, and from its run to the report and the exit code.

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <limits>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/error_output.hpp"
#include "output/progress.hpp"
#include "output/run_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/session/session.hpp"

namespace scanmill::runner {

namespace {

struct ExecuteOptions {
    std::string output_folder = "scanmill-out";
    std::optional<unsigned> jobs;  ///< nothing: as the work and the machine allow
    unsigned threads = 0;
    std::uint64_t seed = 0;
    bool dry_run = false, json = false, quiet = false, fail_fast = false;
    CacheOptions cache;
    std::vector<std::string> command_line;
};

struct RunOptions {
    std::string workflow, until;
    LengthUnit unit = LengthUnit::unknown;
    std::vector<std::string> scans, inputs, settings, only, save;
    ExecuteOptions execute;
};

struct BatchOptions {
    std::string file;
    ExecuteOptions execute;
};

constexpr unsigned most_jobs = 1024;

// A signal handler may write only to such a variable.
volatile std::sig_atomic_t interrupt_requested = 0;

void on_interrupt(int signal) {
    interrupt_requested = 1;
    std::signal(signal, SIG_DFL);  // a second signal ends the program at once
}

/// CLI11 itself reads -1 as the largest number and 010 as eight.
template <class Number>
CLI::Validator whole_number() {
    return CLI::Validator(
        [](const std::string& text) -> std::string {
            Number ignored = 0;
            const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), ignored);
            const bool octal = text.size() > 1 && text[0] == '0';
            if (error == std::errc() && end == text.data() + text.size() && !octal) return {};
            return fmt::format("'{}' is not a whole number from 0 to {}", text, std::numeric_limits<Number>::max());
        },
        "");
}

/// Empty when the folder exists or can be made.
std::string folder_error(const std::string& folder) {
    if (folder.empty()) return "the output folder's name is empty";
    std::error_code ignored;
    for (std::filesystem::path part = folder; !part.empty(); part = part.parent_path()) {
        if (std::filesystem::is_directory(part, ignored)) break;
        if (std::filesystem::exists(part, ignored))
            return fmt::format("results cannot be written to '{}': '{}' is a file", folder, part.string());
        if (part == part.parent_path()) break;
    }
    return {};
}

void add_execute_options(CLI::App& command, ExecuteOptions& options) {
    command.add_option("-o,--output", options.output_folder, "The output folder")
        ->capture_default_str()
        ->check(CLI::Validator(folder_error, ""));
    command
        .add_option("-j,--jobs", options.jobs,
                    "Worker processes; a crash in one does not affect the others; 0: run in this process, without time "
                    "limits. Default: the number of cores, fewer for large scans")
        ->check(whole_number<unsigned>())
        ->check(CLI::Range(0u, most_jobs));
    command
        .add_option("--threads", options.threads,
                    "Threads inside a filter; 0: the machine's cores shared among the jobs. Does not change results")
        ->capture_default_str()
        ->check(whole_number<unsigned>());
    command.add_option("--seed", options.seed, "Seed of everything random")
        ->capture_default_str()
        ->check(whole_number<std::uint64_t>());
    CLI::Option* folder = add_cache_options(command, options.cache);
    command.add_flag("--no-cache", options.cache.none, "Compute everything and store nothing")->excludes(folder);
    command
        .add_option("--keep", options.cache.keep,
                    "Which values the cache stores: worth, if recomputing takes more than twice as long as writing; "
                    "always; or never")
        ->capture_default_str()
        ->check(CLI::IsMember({"worth", "always", "never"}));
    command.add_flag("--fail-fast", options.fail_fast, "Start no new step after a failure");
    command.add_flag("--dry-run", options.dry_run,
                     "Print the steps to run with reasons, the cached steps and the output files, and stop");
    command.add_flag("-q,--quiet", options.quiet, "No progress on stderr");
}

/// Nothing with --no-cache, and, after a warning, when there is no folder for the cache.
std::unique_ptr<Cache> cache_for_run(const CacheOptions& options, const Warn& warn) {
    if (options.none) return nullptr;
    try {
        return open_cache(options, warn);
    } catch (const Error& error) {
        warn(fmt::format("{}; results are not cached. {}", error.sentence(), error.hint()));
        return nullptr;
    }
}

/// No worker process starts for a dry run.
std::unique_ptr<Session> open_session(const ExecuteOptions& options, Cache* cache) {
    SessionSettings settings;
    settings.output_folder = options.output_folder;
    settings.jobs = options.jobs;
    settings.threads = options.threads;
    settings.fail_fast = options.fail_fast;
    settings.keep = options.cache.keep == "always"  ? KeepRule::Policy::always
                    : options.cache.keep == "never" ? KeepRule::Policy::never
                                                    : KeepRule::Policy::worth;
    if (!options.dry_run) settings.worker_command = {"/proc/self/exe", "worker"};
    settings.command_line = options.command_line;
    settings.is_cancelled = [] { return interrupt_requested != 0; };
    return std::make_unique<Session>(std::move(settings), cache);
}

/// Prints the prediction, with --dry-run, or runs the graph and prints the report. With `streams_events`, --json prints
/// one event per line during the run. Returns the exit code.
int execute(const SessionTask& task, bool streams_events, Session& session, FilterLibrary& library, const Warn& warn,
            const ExecuteOptions& options) {
    const RunGraph& graph = task.graph;
    session.on_warning(warn);
    std::vector<NodePrediction> predictions = session.predict(graph, library);
    if (options.dry_run) {
        if (options.json)
            print_json(graph_json(graph, predictions));
        else
            fmt::print("{}", printable(graph_text(graph, predictions)));
        return done;
    }

    std::signal(SIGPIPE, SIG_IGN);  // a closed output does not end the run
    std::signal(SIGINT, on_interrupt);
    std::signal(SIGTERM, on_interrupt);
    Progress progress(graph, predictions, std::max(1u, session.jobs(graph)), options.quiet);
    session.on_warning([&](std::string text) { progress.print_beside([&] { warn(std::move(text)); }); });
    std::optional<EventStream> events;
    std::vector<RunObserver*> observers{&progress};
    if (options.json && streams_events) observers.push_back(&events.emplace(graph));
    const RunReport report = session.run(task, library, std::move(predictions), observers, [&](const RunStarted& run) {
        if (events) events->begin(task.name, run.jobs, run.threads, run.run);
    });
    progress.finish();
    session.on_warning(warn);

    if (events) {
        events->end(report);
        if (events->has_failed()) {
            print_stderr("error: not all events could be written\n");
            return our_fault;
        }
    } else if (options.json) {
        print_json(report_json(graph, report));
    } else {
        fmt::print("{}", report_text(graph, report));
    }
    if (report.interrupted) {
        print_stderr("interrupted; all files written so far are complete\n");
        return interrupted;
    }
    return report.all_done() ? done : some_failed;
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

int run_workflow(const RunOptions& options) {
    const Warn warn = warning_printer();
    const std::unique_ptr<Cache> cache = cache_for_run(options.execute.cache, warn);
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
    request.unit = options.unit;
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

RunRequest request_for(const Batch& batch, const BatchPart& part, const ExecuteOptions& options) {
    RunRequest request;
    for (const std::size_t index : part.scans) {
        const BatchScan& scan = batch.scans[index];
        ScanFile file(scan.file);
        file.unit = scan.unit;
        file.frame = scan.frame;
        file.pose = scan.pose;
        request.scans.push_back(std::move(file));
        for (const std::filesystem::path& other : {scan.truth, scan.pose_file})
            if (!other.empty()) request.protected_files.push_back(other);
    }
    request.protected_files.emplace_back(batch.file);
    request.output_folder = options.output_folder;
    request.seed = options.seed;
    return request;
}

int run_batch(const BatchOptions& options) {
    const std::string text = read_workflow_file(options.file);
    if (!is_batch(text))
        throw Error("'{}' is not a batch: it has no key `batch`", options.file)
            .hint("a workflow is run by: scanmill run WORKFLOW SCAN…");
    const Warn warn = warning_printer();
    const std::unique_ptr<Cache> cache = cache_for_run(options.execute.cache, warn);
    const std::unique_ptr<Session> session = open_session(options.execute, cache.get());
    FilterLibrary library = open_library();
    CheckedBatch checked = check_batch(text, options.file, library);
    nlohmann::ordered_json found = nlohmann::ordered_json::array();
    for (const Diagnostics& diagnostics : checked.diagnostics) {
        print(diagnostics);
        found.push_back(to_json(diagnostics));
    }
    if (checked.has_errors()) {
        if (options.execute.json) print_files_json(std::move(found));
        return bad_request;
    }

    std::vector<GraphPart> parts;
    for (const BatchPart& part : checked.parts)
        parts.push_back({part.plan, request_for(checked.batch, part, options.execute)});
    const auto hash = [&](const std::filesystem::path& file) {
        return cache ? cache->file_hash(file) : content_hash(file);
    };
    SessionTask task{checked.batch.name, options.file, make_graph(parts, library, hash), checked.batch.limits};
    return execute(task, true, *session, library, warn, options.execute);
}

}  // namespace

void add_run_and_batch(CLI::App& app, Action& chosen, const std::vector<std::string>& command_line) {
    auto [run, options] =
        add_command<RunOptions>(app, chosen, "run", "Runs a workflow over one scan or many", run_workflow);
    run.add_option("WORKFLOW", options.workflow,
                   "The workflow file, or the name of a shipped one, such as bernardini-1997")
        ->required();
    run.add_option("SCAN", options.scans,
                   "Files for the workflow's first input: one run each, or one run for all if that input is a list");
    const auto add_list = [&run = run](const char* name, std::vector<std::string>& values, const char* help) {
        run.add_option(name, values, help)->take_all()->allow_extra_args(false);
    };
    add_list("--in", options.inputs, "Files for an input: NAME=FILE[,FILE…]");
    add_unit_option(run, "--unit", options.unit, "The scans' unit of length");
    add_list("--set", options.settings, "A workflow parameter's value, NAME=VALUE");
    add_list("--only", options.only, "Run only this variant (may be repeated)");
    run.add_option("--until", options.until, "Stop after this step");
    add_list("--save", options.save, "Also write this step's result, STEP or STEP.PORT (may be repeated)");
    add_execute_options(run, options.execute);
    run.add_flag("--json", options.execute.json, "Print the report as JSON");

    auto [batch, batch_options] = add_command<BatchOptions>(
        app, chosen, "batch", "Runs workflows over a library of scans, as a batch file describes", run_batch);
    batch.add_option("FILE", batch_options.file, "The batch file")->required();
    add_execute_options(batch, batch_options.execute);
    batch.add_flag("--json", batch_options.execute.json, "Print events as JSON, one per line");
    options.execute.command_line = batch_options.execute.command_line = command_line;
}

}  // namespace scanmill::runner
