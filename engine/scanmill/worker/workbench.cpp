// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/workbench.hpp"

#include <limits.h>
#include <algorithm>
#include <new>
#include <optional>

#include "scanmill/base/error.hpp"
#include "scanmill/cache/value_file.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/plan/step_parameters.hpp"
#include "scanmill/worker/counted_warnings.hpp"
#include "scanmill/worker/file_description.hpp"
#include "scanmill/worker/resources.hpp"
#include "scanmill/workflow/sizes.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// Thrown if an input is neither stored nor readable from a file. JobReport::lost contains the input.
struct InputLost {};

/// Thrown if a job fails for a cause other than Cause::refused.
struct JobFailure {
    Cause cause;
    Error error;
};

void check_expectations(const PlannedStep& step, const Value& primary, NodeReport& report) {
    try {
        require_expectations(step, primary, report);
    } catch (const Error& error) {
        throw JobFailure{Cause::expectation, error};
    }
}

fs::path emptied(const fs::path& folder) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    fs::create_directories(folder);
    return folder;
}

Error out_of_memory(u64 limit, u64 peak) {
    const std::string used =
        fmt::format("the largest resident size was {}, including mapped files", byte_size_text(peak));
    if (limit == 0)
        return Error("the machine is out of memory: {}", used)
            .hint("thin the scan first, or use a machine with more memory")
            .remedy(Remedy::add_memory);
    return Error("memory limit exceeded: the limit is {}; {}", byte_size_text(limit), used)
        .hint("raise the limit, or thin the scan first");
}

}  // namespace

Workbench::Workbench(FilterLibrary& library, Cache* cache, KeepRule::Policy policy, RunValues& values, fs::path scratch)
    : library_(library),
      cache_(cache),
      rule_(policy),
      values_(values),
      scratch_(std::move(scratch)),
      folder_(fs::current_path()) {}

JobReport Workbench::perform(const Job& job, const JobListener& listener) {
    JobReport report;
    report.node.attempts = 1;
    const ResourceUse use;
    const auto fail = [&](Cause cause, Error error) {
        report.outcome = Outcome::failed;
        report.node.failure = failure_of(job, cause, std::move(error));
    };
    const bool is_write = std::holds_alternative<WriteWork>(job.work);
    try {
        const MemoryLimit limit(job.memory_limit, job.threads);
        if (const auto* reading = std::get_if<ReadWork>(&job.work)) read(job, *reading, listener, report);
        if (const auto* step = std::get_if<StepWork>(&job.work)) run(job, *step, listener, report);
        if (const auto* expecting = std::get_if<ExpectWork>(&job.work)) {
            report.node.metrics = expecting->metrics;
            check_expectations(*expecting->step, fetch(expecting->primary, report), report.node);
        }
        if (const auto* writing = std::get_if<WriteWork>(&job.work)) write(*writing, report);
        report.outcome = Outcome::ok;
    } catch (const Cancelled&) {
    } catch (const InputLost&) {
    } catch (const JobFailure& failure) {
        fail(failure.cause, failure.error);
    } catch (const Error& error) {
        fail(is_write ? Cause::output : Cause::refused, error);
    } catch (const BrokenDeclaration& error) {
        fail(Cause::fault, Error("an error of the program: {}", error.what()));
    } catch (const std::bad_alloc&) {
        fail(Cause::memory, out_of_memory(job.memory_limit, use.until_now().peak_memory));
    } catch (const std::exception& error) {
        fail(Cause::exception, Error("an unexpected error: {}", error.what()));
    } catch (...) {
        fail(Cause::exception, Error("an unexpected error: something other than a std::exception was thrown"));
    }
    std::error_code gone;
    if (fs::current_path(gone) != folder_) fs::current_path(folder_, gone);  // relative paths count from folder_
    report.node.effort = use.until_now();
    report.node.effort.threads = job.threads;
    report.node.outcome = report.outcome;
    if (is_write && report.outcome == Outcome::failed) {
        report.output.outcome = Outcome::failed;
        report.output.sha256.clear();
        report.output.bytes = 0;
    }
    return report;
}

void Workbench::run(const Job& job, const StepWork& work, const JobListener& listener, JobReport& report) {
    const std::shared_ptr<const PointStream> scan = stream_for(work, job.threads);
    std::vector<StepInput> inputs;
    if (!scan)
        for (const JobInput& input : work.inputs) inputs.push_back({input.port, fetch(input, report)});

    const PlannedStep& step = *work.step;
    ContextOptions options;
    options.threads = job.threads;
    options.seed = job.seed;
    options.scratch = emptied(scratch_ / "step");
    options.is_cancelled = listener.is_cancelled;
    options.on_progress = listener.on_progress;
    CountedWarnings warnings;
    options.on_warning = [&](std::string_view text) { warnings.add(std::string(text)); };
    const auto report_warnings = [&] {
        if (report.node.origin != Origin::ran) return;
        report.node.warnings = warnings.sentences();
        for (const std::string& warning : report.node.warnings) listener.on_warning(warning);
    };
    std::string run_key;
    auto start = std::chrono::steady_clock::now();
    const Recall recall = [&](const ParameterSet& resolved, NodeReport&) -> std::optional<Outputs> {
        if (!uses_cache(work.caching)) return std::nullopt;
        run_key = work_key(step, work.caching.code, resolved, work.inputs);
        std::optional<Outputs> outputs = recalled(work, run_key, listener, report);
        start = std::chrono::steady_clock::now();
        return outputs;
    };
    const auto filter = [&]() -> const FilterDeclaration& {
        if (library_.build_id(step.spec.name) != work.build)
            throw Error("the filter {} was built again during the run", step.spec.name).hint("run it again");
        if (listener.on_loading) listener.on_loading(library_.module_file(step.spec.name).string());
        const FilterDeclaration& declaration = library_.load(step.spec.name);
        if (listener.on_loading) listener.on_loading({});
        return declaration;
    };
    const Outputs outputs = [&] {
        try {
            return scan ? run_step(step, filter, *scan, std::move(options), recall, report.node)
                        : run_step(step, filter, inputs, std::move(options), recall, report.node);
        } catch (const Cancelled&) {
            throw;
        } catch (...) {
            report_warnings();
            if (scan && scan_->check) scan_->check->require();  // if the file changed, report that instead
            throw;
        }
    }();
    const double seconds = seconds_since(start);
    report_warnings();
    if (scan && scan_->check) scan_->check->require();
    if (uses_cache(work.caching))
        for (const ParameterFile& file : work.parameter_files) require_unchanged(file.path, file.content);
    if (listener.is_cancelled && listener.is_cancelled()) throw Cancelled{};
    if (report.node.origin == Origin::ran)
        store(job, work.caching, run_key, outputs, report.node.warnings, seconds, report);
    if (!step.expectations.empty())
        check_expectations(step, *outputs.find(step.spec.outputs.front().name), report.node);
}

void Workbench::write(const WriteWork& work, JobReport& report) {
    OutputReport& written = report.output;
    written.file = work.file;
    const Value value = fetch(work.value, report);
    written.kind = kind_of(value);
    std::error_code trouble;
    fs::create_directories(work.file.parent_path(), trouble);
    if (trouble)
        throw Error::of_writing(
            fmt::format("the folder '{}' cannot be made: {}", work.file.parent_path().string(), trouble.message()),
            trouble.value());
    WriteOptions options;
    CountedWarnings warnings;
    options.on_warning = [&](const std::string& text) { warnings.add(text); };
    options.added_columns = {work.added_columns.begin(), work.added_columns.end()};
    Vec3 shift = Vec3::Zero();
    options.on_shift = [&](const Vec3& used) { shift = used; };
    options.on_opened = [&](std::string sentence) {
        if (work.must_be_closed) throw Error("expected closed: true; {}", sentence).hint("write PLY");
        written.doubts.push_back(std::move(sentence));
    };
    Sha256 hash;
    options.on_bytes = [&](std::string_view bytes) {
        hash.add(bytes);
        written.bytes += bytes.size();
    };
    write_file(work.file, value, options);
    written.sha256 = hash.text();
    written.properties = work.properties.values.empty() ? properties_of(value) : work.properties;
    if (!written.doubts.empty()) written.properties.set("closed", 0, Unit::boolean);
    constexpr std::size_t longest_name = NAME_MAX;
    if (description_of(work.file).filename().native().size() <= longest_name) try {
            write_description(work.file, written.sha256, work.made_how, value, written.properties, shift);
        } catch (const Error&) {
            // A description of an earlier run must not stay beside this file.
            fs::remove(work.file, trouble);
            fs::remove(description_of(work.file), trouble);
            written.sha256.clear();
            written.bytes = 0;
            throw;
        }
    else
        options.on_warning(fmt::format("'{}' has no description: its name would be too long", work.file.string()));
    written.warnings = warnings.sentences();
    written.outcome = Outcome::ok;
}

// Inputs: files that are read or opened, and values.

namespace {

/// Used when a file is read again, because its warnings were reported the first time.
void ignore_warning(std::string) {}

void add_stray_points(const RobustBox& box, Metrics& properties) {
    if (!box.stray.empty()) properties.set("stray-points", static_cast<double>(box.stray.size()), Unit::count);
}

}  // namespace

void Workbench::read(const Job& job, const ReadWork& work, const JobListener& listener, JobReport& report) {
    CountedWarnings warnings;
    const auto on_warning = [&](const std::string& text) { warnings.add(text); };
    const auto report_warnings = [&] {
        report.node.warnings = warnings_about(work.leaf.name(), warnings.sentences());
        for (const std::string& warning : report.node.warnings) listener.on_warning(warning);
    };
    if (work.leaf.is_streamed && read_as_stream(job, work, listener, warnings, report_warnings, report)) return;
    report.was_read_whole = work.leaf.is_streamed;
    const auto start = std::chrono::steady_clock::now();
    std::optional<UnchangedWhileRead> check;
    if (uses_cache(work.caching)) check.emplace(work.leaf.file, work.leaf.content, job.threads > 1);
    std::size_t dropped = 0;
    Value value = [&] {
        try {
            return read_leaf(work.leaf, on_warning, &dropped);
        } catch (...) {
            report_warnings();
            throw;
        }
    }();
    report_warnings();
    if (check) check->require();
    if (is_geometric(value.kind()))
        report.node.properties.set("points", static_cast<double>(positions_of(value).size()), Unit::count);
    if (dropped > 0) report.node.properties.set("dropped-points", static_cast<double>(dropped), Unit::count);
    if (const PointCloud* cloud = value.find<PointCloud>())
        add_stray_points(robust_box(cloud->positions.span()), report.node.properties);
    store(job, work.caching, work.caching.plan_key, Outputs().set("", std::move(value)), warnings.sentences(),
          seconds_since(start), report);
}

/// Opens the scan as a stream. Stores in the cache the same result that loading the scan whole would give. Returns
/// false if the file must be loaded whole.
bool Workbench::read_as_stream(const Job& job, const ReadWork& work, const JobListener& listener,
                               CountedWarnings& warnings, const std::function<void()>& report_warnings,
                               JobReport& report) {
    const auto start = std::chrono::steady_clock::now();
    const JobCaching& caching = work.caching;
    std::optional<StepResult> cached = uses_cache(caching) ? cache_->step(caching.plan_key) : std::nullopt;
    if (cached && !cached->output("")) cached.reset();
    StreamedContent content;
    const bool is_hashed = uses_cache(caching) && !cached;
    const auto check_cancelled = [&] {
        if (listener.is_cancelled && listener.is_cancelled()) throw Cancelled{};
    };
    const auto on_positions = [&](std::span<const Vec3> positions) {
        check_cancelled();
        if (is_hashed) content.add_world(positions);
    };
    const auto on_warning = [&](const std::string& text) { warnings.add(text); };
    const auto scan = open(job.node, work.leaf, job.threads, uses_cache(caching), on_warning, on_positions);
    if (!scan) return false;
    report_warnings();
    report.node.properties.set("points", static_cast<double>(scan->size()), Unit::count);
    add_stray_points(scan->robust_box(), report.node.properties);
    std::vector<ResultOutput> outputs;
    if (cached) {
        outputs = cached->outputs;
    } else if (is_hashed) {
        const ValueName name = content.of(*scan, job.threads, check_cancelled);
        outputs = {{"", kind_of<PointCloud>(), name.content, name.bytes}};
    }
    if (scan_->check) scan_->check->require();
    report.result.outputs = std::move(outputs);
    add_kept(report);
    store(job, caching, caching.plan_key, {}, warnings.sentences(), seconds_since(start), report);
    return true;
}

std::shared_ptr<const PointStream> Workbench::open(std::size_t node, const LeafSource& leaf, unsigned threads,
                                                   bool is_checked, const OnWarning& on_warning,
                                                   const OnWorldPositions& on_positions) {
    scan_.reset();
    std::optional<UnchangedWhileRead> check;
    if (is_checked) check.emplace(leaf.file, leaf.content, threads > 1);
    auto stream = open_leaf(leaf, threads, on_warning, on_positions);
    if (stream) scan_ = OpenScan{node, stream, std::move(check)};
    return stream;
}

std::shared_ptr<const PointStream> Workbench::stream_for(const StepWork& work, unsigned threads) {
    if (!can_stream(*work.step, work.inputs.size())) return nullptr;
    const JobInput& input = work.inputs.front();
    if (!input.leaf || !input.leaf->is_streamed) return nullptr;
    if (scan_ && scan_->node == input.node) return scan_->stream;
    if (values_.contains({input.node, input.from})) return nullptr;  // the file was loaded whole
    return open(input.node, *input.leaf, threads, cache_ != nullptr, ignore_warning);
}

Value Workbench::fetch(const JobInput& input, JobReport& report) const {
    std::optional<Value> value = values_.find({input.node, input.from});
    if (!value && cache_ && !input.content.empty()) value = cache_->value(input.content);
    if (!value && input.leaf) {
        value = read_leaf(*input.leaf, ignore_warning);
        if (cache_) require_unchanged(input.leaf->file, input.leaf->content);
    }
    if (!value) {
        report.lost.emplace_back(input.node, input.from);
        throw InputLost{};
    }
    return *value;
}

std::vector<std::string> warnings_about(const std::filesystem::path& file, std::vector<std::string> warnings) {
    for (std::string& warning : warnings) warning.insert(0, "'" + file.string() + "': ");
    return warnings;
}

// Storing results and values, and finding them in the cache.

/// Adds the output ports whose values the cache has to JobReport::kept.
void Workbench::add_kept(JobReport& report) const {
    for (const ResultOutput& output : report.result.outputs)
        if (cache_->has_value(output.content, output.bytes)) report.kept.push_back(output.port);
}

/// The needed outputs of the result that is stored under the run key; nothing if the cache lacks one of them. Outputs
/// are needed by other tasks and by expectations.
std::optional<Outputs> Workbench::recalled(const StepWork& work, const std::string& run_key,
                                           const JobListener& listener, JobReport& report) const {
    std::optional<StepResult> result = cache_->step(run_key);
    if (!result) return std::nullopt;
    Outputs outputs;
    std::vector<std::string> needed = work.caching.needed;
    if (!work.step->expectations.empty()) needed.push_back(work.step->spec.outputs.front().name);
    for (const std::string& port : needed) {
        if (outputs.find(port)) continue;
        const ResultOutput* output = result->output(port);
        std::optional<Value> value = output ? cache_->value(output->content) : std::nullopt;
        if (!value) return std::nullopt;
        outputs.set(port, std::move(*value));
    }
    cache_->keep_run_key(work.caching.plan_key, run_key);
    adopt(*result, work.step.get(), report.node);
    report.node.origin = Origin::same_inputs;
    for (const std::string& warning : report.node.warnings) listener.on_warning(warning);
    report.result = std::move(*result);
    add_kept(report);
    return outputs;
}

/// Stores the result in the cache. Stores values that KeepRule selects, and values that other tasks need.
void Workbench::store(const Job& job, const JobCaching& caching, const std::string& run_key, const Outputs& outputs,
                      std::vector<std::string> warnings, double seconds, JobReport& report) {
    store_values(job, caching, outputs, caching.inputs_cost + seconds, report);
    if (!uses_cache(caching)) return;
    StepResult& result = report.result;
    const auto* work = std::get_if<StepWork>(&job.work);
    for (const auto& [name, value] : report.node.resolved.values)
        if (!std::holds_alternative<std::monostate>(value) && !names_files(work->step->spec, name))
            result.resolved.values.emplace_back(name, value);
    result.metrics = report.node.metrics;
    result.properties = report.node.properties;
    result.warnings = std::move(warnings);
    result.doubts = report.node.doubts;
    result.seconds = seconds;
    if (work) result.filter = work->step->spec.name;
    result.workflow = caching.workflow;
    if (cache_->keep_step(run_key, result)) cache_->keep_run_key(caching.plan_key, run_key);
}

void Workbench::store_values(const Job& job, const JobCaching& caching, const Outputs& outputs, double cost,
                             JobReport& report) {
    const auto* work = std::get_if<StepWork>(&job.work);
    for (const auto& [port, value] : outputs) {
        const bool is_needed = std::ranges::find(caching.needed, port) != caching.needed.end();
        if (!is_needed && !uses_cache(caching)) continue;
        const EncodedValue encoded(value);
        bool is_kept = false;
        if (uses_cache(caching)) {
            // Outputs with PortSpec::by_name are rarely used, so they are stored only if they are needed.
            const PortSpec* output = work ? work->step->spec.output(port) : nullptr;
            const bool is_used = !output || !output->by_name || is_needed;
            is_kept = cache_->value(encoded.content()).has_value();
            if (!is_kept && is_used && rule_.is_worth(cost, encoded.size())) {
                const auto start = std::chrono::steady_clock::now();
                is_kept = cache_->keep_value(encoded);
                if (is_kept) rule_.wrote(encoded.size(), seconds_since(start));
            }
            if (is_kept) report.kept.push_back(port);
            report.result.outputs.push_back({port, kind_of(value), encoded.content(), encoded.size()});
        }
        if (!is_needed || (is_kept && !values_.are_in_memory())) continue;
        try {
            values_.put({job.node, port}, encoded);
        } catch (const Error& error) {
            if (work) throw JobFailure{Cause::output, error};
            // Ignored for a file that was read, because it can be read again.
        }
    }
}

void adopt(const StepResult& result, const PlannedStep* step, NodeReport& report) {
    report.metrics = result.metrics;
    report.properties = result.properties;
    report.doubts = result.doubts;
    report.warnings = result.warnings;
    if (!step) return;
    report.resolved = {};
    for (const auto& [name, value] : step->parameters.values)
        if (names_files(step->spec, name)) report.resolved.values.emplace_back(name, value);
    for (const auto& parameter : result.resolved.values) report.resolved.values.push_back(parameter);
}

}  // namespace scanmill
