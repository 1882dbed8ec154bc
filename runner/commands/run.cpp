// SPDX-License-Identifier: GPL-3.0-or-later
// The commands `run` and `batch`: make a graph from the command line, run it, and print the report.

#include <fmt/format.h>
#include <sys/prctl.h>

#include <algorithm>
#include <charconv>
#include <csignal>
#include <iostream>
#include <iterator>
#include <limits>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "export/status.hpp"
#include "output/comparison_text.hpp"
#include "output/error_output.hpp"
#include "output/page_file.hpp"
#include "output/progress.hpp"
#include "output/reproduce.hpp"
#include "output/run_output.hpp"
#include "output/run_table.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/batch/choice.hpp"
#include "scanmill/batch/objects.hpp"
#include "scanmill/compare/formats.hpp"
#include "scanmill/compare/recorded.hpp"
#include "scanmill/session/chunks.hpp"
#include "scanmill/session/session.hpp"
#include "scanmill/session/shard.hpp"
#include "scanmill/workflow/ready.hpp"

namespace scanmill::runner {

namespace {

struct ExecuteOptions {
    SessionSettings session;
    CacheOptions cache;
    std::uint64_t seed = 0;
    bool no_cache = false, strict = false, dry_run = false, json = false, has_events = false, quiet = false,
         is_wide = false, stops_with_parent = false;
    std::filesystem::path html;  ///< batches only
};

struct RunOptions {
    std::string workflow;
    std::vector<std::string> scans, inputs, settings;
    bool has_picture = false;
    RunRequest request;
    ExecuteOptions execute;
};

struct BatchOptions {
    std::string file, shard;
    std::filesystem::path cells;
    bool is_status = false;
    BatchChoice choice;
    ExecuteOptions execute;
};

// A signal handler may only write to a variable of this type.
volatile std::sig_atomic_t interrupt_requested = 0;

void on_interrupt(int signal) {
    interrupt_requested = 1;
    // A second signal ends the program at once. A second SIGHUP does not, because a closing terminal sends it twice:
    // directly and through its shell.
    if (signal != SIGHUP) std::signal(signal, SIG_DFL);
}

/// A signal stops the run in an orderly way. A signal that is ignored, such as SIGHUP under nohup, stays ignored.
void handle_interrupts() {
    for (const int signal : {SIGINT, SIGTERM, SIGHUP})
        if (std::signal(signal, on_interrupt) == SIG_IGN) std::signal(signal, SIG_IGN);
}

/// A check for whole numbers, because CLI11 itself reads -1 as the largest number and 010 as eight.
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

/// Explains why the folder cannot be used; empty if it exists or can be made.
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

/// The file of a workflow or batch, and its text.
struct Source {
    std::string file, text;
};

/// "-" is the text on standard input. It has no file; relative paths count from the working folder, and `noun` is its
/// name, as if that were its file.
Source source_of(const std::string& file_or_name, const char* noun) {
    if (file_or_name == "-")
        return {noun, std::string(std::istreambuf_iterator<char>(std::cin), std::istreambuf_iterator<char>())};
    const std::string file = workflow_file(file_or_name, print_warning);
    return {file, read_workflow_file(file)};
}

void add_execute_options(CLI::App& command, ExecuteOptions& options) {
    options.session.output_folder = "scanmill-out";
    command.add_option("-o,--output", options.session.output_folder, "The output folder")
        ->capture_default_str()
        ->check(CLI::Validator(folder_error, ""));
    command
        .add_option(
            "-j,--jobs", options.session.jobs,
            "Number of worker processes; a crash in one does not affect the others. 0: run in this process, without "
            "time limits. Default: the number of cores, fewer for large scans")
        ->check(whole_number<unsigned>())
        ->check(CLI::Range(0u, most_jobs));
    command
        .add_option(
            "--threads", options.session.threads,
            "Number of threads in a filter; 0: the cores are divided among the jobs. Results do not depend on it")
        ->capture_default_str()
        ->check(whole_number<unsigned>());
    command.add_option("--seed", options.seed, "Seed of all random numbers")
        ->capture_default_str()
        ->check(whole_number<std::uint64_t>());
    CLI::Option* folder = add_cache_options(command, options.cache);
    command.add_flag("--no-cache", options.no_cache, "Compute everything and store nothing")->excludes(folder);
    const auto keep = [&](const std::string& policy) {
        options.session.keep = policy == "always"  ? KeepRule::Policy::always
                               : policy == "never" ? KeepRule::Policy::never
                                                   : KeepRule::Policy::worth;
    };
    command
        .add_option_function<std::string>(
            "--keep", keep,
            "Which values the cache stores. worth: those that take more than twice as long to recompute as to write; "
            "always: all; never: none")
        ->default_str("worth")
        ->check(CLI::IsMember({"worth", "always", "never"}));
    command.add_flag("--fail-fast", options.session.fail_fast, "Start no new step after a failure");
    command.add_flag("--strict", options.strict, "Exit with 1 if a result is doubtful");
    command.add_flag("--dry-run", options.dry_run,
                     "Print the steps to run with reasons, the cached steps and the output files, then stop");
    command.add_flag("-q,--quiet", options.quiet, "Print no progress on stderr");
    command.add_flag("--stop-with-parent", options.stops_with_parent,
                     "Stop as after Ctrl-C when the program ends that started this one");
    command.add_flag("--wide", options.is_wide,
                     "Print every headline metric of every step and every file, however wide the table gets");
}

/// Opens the cache. Returns nullptr with --no-cache, and with a warning if the cache folder cannot be opened.
std::unique_ptr<Cache> cache_for(const ExecuteOptions& options, const Warn& warn) {
    if (options.no_cache) return nullptr;
    try {
        return open_cache(options.cache, warn);
    } catch (const Error& error) {
        warn(fmt::format("{}; results are not cached. {}", error.sentence(), with_option(error).hint()));
        return nullptr;
    }
}

/// The settings of the session. For a dry run, no worker process starts.
SessionSettings settings_for(const ExecuteOptions& options) {
    SessionSettings settings = options.session;
    if (!options.dry_run) settings.worker_command = {"/proc/self/exe", "worker"};
    settings.is_cancelled = [] { return interrupt_requested != 0; };
    return settings;
}

/// Prints errors and warnings on stderr. With `json` also prints them as JSON on stdout, if there are errors. Returns
/// true if there are no errors.
bool report(const std::vector<Diagnostics>& all, bool json) {
    Json files = Json::array();
    for (const Diagnostics& diagnostics : all) {
        print(diagnostics);
        files.push_back(to_json(diagnostics));
    }
    if (std::ranges::none_of(all, &Diagnostics::has_errors)) return true;
    if (json) print_files_json(std::move(files));
    return false;
}

/// The session of a command. Its first worker process starts before the workflow is read.
class Execution {
public:
    explicit Execution(const ExecuteOptions& options)
        : options_(options),
          cache_(cache_for(options, warn_)),
          session_(settings_for(options), cache_.get()) {
        if (options.stops_with_parent) ::prctl(PR_SET_PDEATHSIG, SIGTERM);  // ends at once while no step runs yet
    }

    FilterLibrary& library() { return library_; }
    std::string hash(const std::filesystem::path& file) const {
        return cache_ ? cache_->file_hash(file) : content_hash(file);
    }
    /// With --dry-run, prints the prediction. Otherwise runs the graph and prints the report. For a batch, --json
    /// prints one event per line during the run, and then the verdict of the batch's gate. Returns the exit code.
    int run(const SessionTask& task, bool is_batch);

private:
    /// The comparison of the recorded run with the accepted one. Empty if there is neither a gate nor an accepted run.
    /// If the comparison fails, it is empty, the error is printed on stderr, and `code` is raised. Records the verdict
    /// of a gate.
    std::optional<Comparison> judge(const SessionTask& task, std::int64_t run, int& code) const;
    void record_verdict(const Comparison& comparison) const;
    /// Whether the run is recorded to its end. Records on a full disk are incomplete; shards cannot be merged then.
    bool is_end_recorded(std::int64_t run) const;

    const ExecuteOptions& options_;
    Warn warn_ = warning_printer();
    std::unique_ptr<Cache> cache_;
    Session session_;
    FilterLibrary library_ = open_library();
};

std::optional<Comparison> Execution::judge(const SessionTask& task, std::int64_t run, int& code) const {
    try {
        if (run == 0 && task.gate.rules.empty()) return std::nullopt;
        if (run == 0) throw Error("the gate was not judged, because the run is not recorded");
        std::optional<Comparison> comparison =
            verdict_of_batch(options_.session.output_folder, run, reproducing_command);
        if (comparison) code = std::max(code, exit_code_of(*comparison, options_.strict));
        if (comparison && !comparison->gate.rules.empty()) record_verdict(*comparison);
        return comparison;
    } catch (const Error& error) {
        print(error, false);
        code = std::max<int>(code, some_failed);
        return std::nullopt;
    }
}

bool Execution::is_end_recorded(std::int64_t run) const {
    if (run == 0) return false;
    try {
        return RunRecords::read(options_.session.output_folder / records_file).summary(run).outcome.has_value();
    } catch (const Error&) {
        return false;
    }
}

void Execution::record_verdict(const Comparison& comparison) const {
    try {
        records_to_change(options_.session.output_folder)
            .add_verdict(comparison.run.id, comparison.count(Verdict::regressed));
    } catch (const Error& error) {
        print_warning(fmt::format("the verdict is not recorded: {}", error.sentence()));
    }
}

int Execution::run(const SessionTask& task, bool is_batch) {
    const RunGraph& graph = task.graph;
    session_.on_warning(warn_);
    std::vector<NodePrediction> predictions = session_.predict(graph, library_);
    if (options_.dry_run) {
        if (options_.json)
            print_json(graph_json(graph, predictions));
        else
            fmt::print("{}", printable(graph_text(graph, predictions)));
        const auto is_readable = [](const RunNode& node) { return node.unreadable.empty(); };
        return std::ranges::all_of(graph.nodes, is_readable) ? done : some_failed;
    }

    std::signal(SIGPIPE, SIG_IGN);  // a closed stdout does not end the run
    handle_interrupts();
    const unsigned jobs = session_.jobs(graph);
    Progress progress(graph, predictions, std::max(1u, jobs), options_.quiet, cache_ ? 1 : task.gate.repeats);
    session_.on_warning([&](std::string text) { progress.print_beside([&] { warn_(std::move(text)); }); });
    std::optional<EventStream> events;
    std::vector<RunObserver*> observers{&progress};
    if (options_.has_events || (options_.json && is_batch)) observers.push_back(&events.emplace(graph));
    std::int64_t number = 0;
    const RunReport report =
        session_.run(task, jobs, library_, std::move(predictions), observers, [&](const RunStarted& run) {
            number = run.run;
            if (events) events->begin(task.name, run.jobs, run.threads, run.run);
        });
    progress.finish();
    session_.on_warning(warn_);
    int code = report.outcome() < (options_.strict ? Outcome::doubtful : Outcome::failed) ? done
               : report.has_fault() && task.shard.empty()                                 ? our_fault
                                                                                          : some_failed;
    if (!task.shard.empty() && (report.has_machine_failure() || !is_end_recorded(number))) code = machine_failed;
    std::optional<Comparison> comparison;
    if (is_batch && !report.interrupted && task.shard.empty()) {  // shards are judged together
        // Known doubts do not count, so the comparison decides whether a doubtful result is an error.
        if (options_.strict && report.outcome() == Outcome::doubtful) code = done;
        comparison = judge(task, number, code);
        if (options_.strict && report.outcome() == Outcome::doubtful && !comparison)
            code = std::max<int>(code, some_failed);
    }

    if (events) {
        if (comparison) events->judged(verdict_event(*comparison));
        events->end(report);
        if (events->has_failed()) {
            print_stderr("error: not all events could be written\n");
            return our_fault;
        }
    } else if (options_.json) {
        print_json(report_json(graph, report));
    } else {
        fmt::print("{}", run_table(graph, report, options_.is_wide ? TableExtent::everything : TableExtent::result,
                                   stdout_width()));
        if (comparison) fmt::print("{}", verdict_text(*comparison, options_.session.output_folder));
    }
    if (!options_.html.empty() && !report.interrupted && number != 0) {
        try {
            write_page_file(options_.html, {options_.session.output_folder, number}, std::nullopt,
                            options_.session.jobs);
        } catch (const Error& error) {
            print(error, false);
            code = std::max<int>(code, some_failed);
        }
    }
    if (report.interrupted) {
        print_stderr("interrupted; all files written so far are complete\n");
        return interrupted;
    }
    return code;
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

/// The path without links, `.` and `..`.
std::filesystem::path resolved(const std::filesystem::path& file) {
    std::error_code ignored;  // a file that cannot be found is reported when it is read
    const std::filesystem::path path = std::filesystem::weakly_canonical(file, ignored);
    return path.has_filename() ? path : path.parent_path();
}

/// Throws Error if two of the paths lead to one file or folder.
void require_distinct(const std::vector<std::string>& scans) {
    std::map<std::filesystem::path, std::string> given;
    for (const std::string& scan : scans)
        if (const auto [earlier, is_new] = given.emplace(resolved(scan), scan); !is_new)
            throw Error("the scan '{}' is given twice{}", scan,
                        earlier->second == scan ? "" : fmt::format(", also as '{}'", earlier->second))
                .hint("give each scan once");
}

/// Adds the files that `--in` gives for the first input. Throws Error if one of them is a scan already.
void add_scans(std::vector<ScanFile>& scans, const std::string& input,
               const std::vector<std::filesystem::path>& files) {
    std::set<std::filesystem::path> given;
    for (const ScanFile& scan : scans) given.insert(resolved(scan.path));
    for (const std::filesystem::path& file : files) {
        if (!given.insert(resolved(file)).second)
            throw Error("the scan '{}' is given twice: `--in {}=…` repeats it", file.string(), input)
                .hint("scans of the first input need no --in; give each file once");
        scans.emplace_back(file);
    }
}

/// `refusal`: why the object must not be read; empty if it may be read.
ScanFile scan_file(const ObjectFolder& object, const Refusal& refusal) {
    ScanFile file(object.folder);
    for (const std::filesystem::path& path : object.views) {
        file.views.emplace_back(path);
        file.views.back().refusal = refusal;
    }
    return file;
}

int run_workflow(const RunOptions& options) {
    Execution execution(options.execute);
    const auto [workflow, text] = source_of(options.workflow, "workflow");
    if (is_batch(text))
        throw Error("'{}' is a batch, not a workflow", workflow).hint("scanmill batch " + options.workflow);
    Settings settings = parse_settings(options.settings);
    CheckedWorkflow checked = check_workflow(workflow, text, execution.library(), settings, options.has_picture);
    if (!report({checked.diagnostics}, options.execute.json || options.execute.has_events)) return bad_request;

    require_distinct(options.scans);
    RunRequest request = options.request;
    std::vector<ObjectFolder> objects;
    for (const std::string& scan : options.scans)
        if (std::error_code ignored; takes_views(checked.plan.workflow) && std::filesystem::is_directory(scan, ignored))
            objects.push_back(object_in(scan, print_warning));
        else
            request.scans.emplace_back(scan);
    request.inputs = parse_inputs(options.inputs);
    if (!checked.plan.workflow.inputs.empty())  // `--in` feeds the first input too
        if (auto first = request.inputs.extract(checked.plan.workflow.inputs.front().name))
            add_scans(request.scans, first.key(), first.mapped());
    request.output_folder = options.execute.session.output_folder;
    request.seed = options.execute.seed;
    if (!objects.empty() && !request.scans.empty())
        throw Error("'{}' is a folder and '{}' is a file; a folder is an object, and files are the views of one object",
                    objects.front().folder.string(), request.scans.front().path.string())
            .hint("name only folders, or only files");
    const auto plan = std::make_shared<const Plan>(std::move(checked.plan));
    std::vector<GraphPart> parts;
    if (objects.empty()) parts.push_back({plan, request});
    const bool finds_poses = takes_poses(plan->workflow) && !settings.contains(poses_parameter);
    for (const ObjectFolder& object : objects) {
        const ObjectPoses poses = finds_poses ? poses_beside(object) : ObjectPoses();
        if (!poses.idle.empty()) print_warning(poses.idle);
        GraphPart& part = parts.emplace_back(GraphPart{plan, request});
        part.request.scans = {scan_file(object, poses.refusal)};
        if (poses.file.empty()) continue;
        settings.insert_or_assign(poses_parameter, text_setting(poses.file.string(), {}));
        part.plan = std::make_shared<const Plan>(
            check_workflow(workflow, text, execution.library(), settings, options.has_picture).plan);
    }
    const auto hash = [&](const std::filesystem::path& file) { return execution.hash(file); };
    RunGraph graph = make_graph(parts, execution.library(), hash);
    return execution.run({workflow_name(*plan), workflow, std::move(graph), {}}, false);
}

/// The scan with the files that it declares for the plan's other inputs.
ScanFile scan_file(const BatchScan& scan, const Plan& plan, const Refusal& refusal) {
    ScanFile file(scan.file);
    file.unit = scan.unit;
    file.frame = scan.frame;
    file.pose = scan.pose;
    file.refusal = refusal;
    file.invalid = scan.invalid;
    for (const std::filesystem::path& path : scan.views) {
        ScanFile view(path);
        view.unit = scan.unit;
        view.frame = scan.frame;
        view.refusal = refusal;
        view.invalid = scan.invalid;
        file.views.push_back(std::move(view));
    }
    for (const WorkflowInput& input : plan.workflow.inputs) {
        const auto own = scan.inputs.find(input.name);
        if (own == scan.inputs.end()) continue;
        for (const std::filesystem::path& path : own->second.files) {
            ScanFile& other = file.inputs[input.name].emplace_back(path);
            other.unit = own->second.unit;
            other.frame = own->second.frame;
        }
    }
    return file;
}

RunRequest request_for(const CheckedBatch& checked, const BatchPart& part, const ExecuteOptions& options) {
    RunRequest request;
    for (const std::size_t index : part.scans)
        request.scans.push_back(scan_file(checked.batch.scans[index], *part.plan, checked.refusal(part, index)));
    request.only = part.only;
    request.output_folder = options.session.output_folder;
    request.seed = options.seed;
    return request;
}

/// All files that the batch names, including those that no workflow reads.
std::vector<std::filesystem::path> files_of(const Batch& batch) {
    std::vector<std::filesystem::path> files{batch.file};
    for (const BatchScan& scan : batch.scans) {
        if (!scan.is_object()) files.push_back(scan.file);
        files.insert(files.end(), scan.views.begin(), scan.views.end());
        if (!scan.poses_file.empty()) files.push_back(scan.poses_file);
        if (!scan.pose_file.empty()) files.push_back(scan.pose_file);
        files.insert(files.end(), scan.truth.files.begin(), scan.truth.files.end());
        for (const auto& [name, input] : scan.inputs) files.insert(files.end(), input.files.begin(), input.files.end());
    }
    return files;
}

int run_batch(const BatchOptions& options) {
    if (options.is_status) return print_status(options.file, options.execute.json);
    const auto [batch_file, text] = source_of(options.file, "batch");
    if (!is_batch(text))
        throw Error("'{}' is not a batch: it has no key `batch`", batch_file)
            .hint("a workflow is run by: scanmill run WORKFLOW SCAN…");
    Execution execution(options.execute);
    CheckedBatch checked = check_batch(text, batch_file, execution.library());
    if (!report(checked.diagnostics, options.execute.json)) return bad_request;
    const std::string key = key_of_cells(checked);
    const CellPlaces places(checked);
    std::string shard = options.shard;
    if (!options.cells.empty()) {
        const ChunkFile chunk = read_chunk(options.cells);
        if (chunk.key_of_cells != key)
            throw Error("the batch has changed since '{}' was written", options.cells.string())
                .hint("export the batch again");
        choose(checked, chunk.units);
        shard = chunk.shard;
    } else if (!shard.empty()) {
        choose(checked, Shard::parse(shard));
    } else {
        choose(checked, options.choice);
    }
    std::vector<GraphPart> parts;
    for (const BatchPart& part : checked.parts)
        parts.push_back({part.plan, request_for(checked, part, options.execute)});
    if (!parts.empty()) parts.front().request.protected_files = files_of(checked.batch);
    const auto hash = [&](const std::filesystem::path& file) { return execution.hash(file); };
    RunGraph graph = make_graph(parts, execution.library(), hash);
    SessionTask task{checked.batch.name, batch_file, std::move(graph), checked.batch.limits};
    // A partial run gets its own name, because the batch's other cells must not count as missing.
    if (!options.choice.is_all()) task.name += ", in part";
    if (!shard.empty()) {
        task.shard = shard;
        task.key_of_cells = key;
        places.set(task.graph);
    }
    if (checked.batch.gate) task.gate = *checked.batch.gate;
    return execution.run(task, true);
}

}  // namespace

void add_run_and_batch(CLI::App& app, Action& chosen, const std::vector<std::string>& command_line) {
    auto [run, options] =
        add_command<RunOptions>(app, chosen, "run", "Runs a workflow over one scan or many", run_workflow);
    run.add_option("WORKFLOW", options.workflow,
                   "The workflow file, or the name of a ready one, such as bernardini-1997; `-` reads standard input")
        ->required();
    run.add_option("SCAN", options.scans,
                   "Files for the workflow's first input: one run each, or one run for all if that input is a list. "
                   "For a list also folders: one run each, over the views in the folder");
    const auto add_list = [&run = run](const char* name, std::vector<std::string>& values, const char* help) {
        run.add_option(name, values, help)->take_all()->allow_extra_args(false);
    };
    add_list("--in", options.inputs, "Files for an input: NAME=FILE[,FILE…]");
    add_unit_option(run, "--unit", options.request.unit, "The scans' unit of length");
    add_invalid_option(
        run, options.request.invalid,
        "How to treat points with a NaN, infinite or too distant coordinate: drop or refuse. Default: the workflow's "
        "rule; without one, drop in formats that write NaN for a ray without a return (PCD, PTX), refuse in others");
    add_list("--set", options.settings, "A workflow parameter's value, NAME=VALUE");
    add_list("--only", options.request.only, "Run only this variant (may be repeated)");
    run.add_option("--until", options.request.until, "Stop after this step");
    add_list("--save", options.request.save, "Also write this step's result, STEP or STEP.PORT (may be repeated)");
    run.add_flag("--picture", options.has_picture,
                 "Also write a picture (PNG) of the last surface among the outputs, beside it");
    add_execute_options(run, options.execute);
    CLI::Option* run_json = run.add_flag("--json", options.execute.json, "Print the report as JSON");
    run.add_flag("--events", options.execute.has_events,
                 "Print events as JSON, one per line, as `scanmill batch --json` does")
        ->excludes(run_json);

    auto [batch, batch_options] = add_command<BatchOptions>(
        app, chosen, "batch", "Runs workflows over a library of scans, as a batch file describes", run_batch);
    batch
        .add_option("FILE", batch_options.file,
                    "The batch file, or the name of a ready one, such as nightly; `-` reads standard input")
        ->required();
    const auto add_choice = [&batch = batch](const char* name, std::vector<std::string>& values, const char* help) {
        batch.add_option(name, values, help)->take_all()->allow_extra_args(false);
    };
    add_choice("--scan", batch_options.choice.scans,
               "Run only this scan, a path from the batch's folder (may be repeated)");
    add_choice("--workflow", batch_options.choice.workflows, "Run only the workflow of this name (may be repeated)");
    add_choice("--only", batch_options.choice.variants, "Run only this variant (may be repeated)");
    CLI::Option* shard = batch.add_option(
        "--shard", batch_options.shard,
        "Run only a part of the cells, I/N as 3/7: machines run one each, with an output folder each, and "
        "`scanmill runs merge` makes one run of them");
    CLI::Option* cells = batch.add_option("--cells", batch_options.cells,
                                          "Run only the cells of this chunk, a file that `scanmill export` writes");
    CLI::Option* status = batch.add_flag("--status", batch_options.is_status,
                                         "Print which chunks are done, running and failed; FILE is the folder that "
                                         "`scanmill export` wrote");
    cells->excludes(shard);
    for (const char* other : {"--scan", "--workflow", "--only"})
        for (CLI::Option* part : {shard, cells, status}) part->excludes(other);
    add_execute_options(batch, batch_options.execute);
    batch.add_option("--html", batch_options.execute.html,
                     "Write the report as one HTML file after the run, as `scanmill report DIR --html` does");
    batch.add_flag("--json", batch_options.execute.json, "Print events as JSON, one per line")->excludes("--html");
    for (CLI::Option* part : {shard, cells, status}) part->excludes("--html");
    options.execute.session.command_line = batch_options.execute.session.command_line = command_line;
}

}  // namespace scanmill::runner
