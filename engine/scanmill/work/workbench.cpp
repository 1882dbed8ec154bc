// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/workbench.hpp"

#include <limits.h>

#include <new>
#include <optional>

#include "scanmill/engine/byte_size.hpp"
#include "scanmill/engine/facts.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/work/file_description.hpp"
#include "scanmill/work/memory_limit.hpp"
#include "scanmill/work/resource_use.hpp"
#include "scanmill/work/sha256.hpp"
#include "scanmill/work/unchanged_file.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

/// Thrown when an input is neither here nor in the cache; the report names it.
struct InputLost {};

/// Thrown by what asks for expectations.
struct Unmet {
    Error error;
};

fs::path emptied(const fs::path& folder) {
    std::error_code ignored;
    fs::remove_all(folder, ignored);
    fs::create_directories(folder);
    return folder;
}

Error out_of_memory(u64 limit, u64 peak) {
    const std::string reached =
        fmt::format("{} were resident at most, mapped files counted, when more was asked for", byte_size_text(peak));
    if (limit == 0)
        return Error("the machine's memory did not suffice: {}", reached)
            .hint("thin the scan first, or use a machine with more memory");
    return Error("the memory did not suffice: the limit is {}; {}", byte_size_text(limit), reached)
        .hint("raise the limit, or thin the scan first");
}

}  // namespace

Workbench::Workbench(FilterLibrary& library, Cache* cache, KeepRule::Policy policy, fs::path scratch)
    : library_(library),
      cache_(cache),
      rule_(policy),
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
        if (const auto* asking = std::get_if<ExpectWork>(&job.work)) expect(job, *asking, report);
        if (const auto* writing = std::get_if<WriteWork>(&job.work)) write(job, *writing, report);
        report.outcome = Outcome::done;
    } catch (const Cancelled&) {
    } catch (const InputLost&) {
    } catch (const Unmet& unmet) {
        fail(Cause::expectation, unmet.error);
    } catch (const Error& error) {
        fail(is_write ? Cause::output : Cause::refused, error);
    } catch (const std::bad_alloc&) {
        fail(Cause::memory, out_of_memory(job.memory_limit, use.until_now().peak_memory));
    } catch (const std::exception& error) {
        fail(Cause::exception, Error("an unexpected error: {}", error.what()));
    } catch (...) {
        fail(Cause::exception, Error("something was thrown that is no error and says nothing of itself"));
    }
    std::error_code gone;
    if (fs::current_path(gone) != folder_) fs::current_path(folder_, gone);  // relative paths count from there
    report.node.effort = use.until_now();
    report.node.effort.threads = job.threads;
    report.node.outcome = report.outcome;
    if (is_write && report.outcome == Outcome::failed) report.output.outcome = Outcome::failed;
    return report;
}

void Workbench::run(const Job& job, const StepWork& work, const JobListener& listener, JobReport& report) {
    const std::shared_ptr<const PointStream> scan = stream_for(work, job.threads);
    std::vector<StepInput> inputs;
    if (!scan)
        for (const JobInput& input : work.inputs)
            if (std::optional<Value> value = fetch(input, report)) inputs.push_back({input.port, std::move(*value)});
    if (!report.lost.empty()) throw InputLost{};

    const PlannedStep& step = *work.step;
    ContextOptions options;
    options.threads = job.threads;
    options.seed = job.seed;
    options.scratch = emptied(scratch_ / "step");
    options.is_cancelled = listener.is_cancelled;
    options.on_progress = listener.on_progress;
    options.on_warning = listener.on_warning;
    std::string run_key;
    auto start = std::chrono::steady_clock::now();
    const Recall recall = [&](const ParameterSet& resolved, NodeReport&) -> std::optional<Outputs> {
        if (!uses_cache(work.memory)) return std::nullopt;
        run_key = work_key(step, work.memory.code, resolved, work.inputs);
        std::optional<Outputs> known = recalled(work, run_key, listener, report);
        start = std::chrono::steady_clock::now();
        return known;
    };
    const auto filter = [&]() -> const FilterDeclaration& {
        if (library_.build_id(step.spec.name) != work.build)
            throw Error("the filter {} was built again while the run was going on", step.spec.name)
                .hint("run it again");
        return library_.load(step.spec.name);
    };
    const Outputs outputs = [&] {
        if (!scan) return run_step(step, filter, inputs, std::move(options), recall, report.node);
        try {
            return run_step(step, filter, *scan, std::move(options), recall, report.node);
        } catch (const Cancelled&) {
            throw;
        } catch (...) {
            scans_.require_unchanged(work.inputs.front().node);  // if it changed, that is why
            throw;
        }
    }();
    const double seconds = seconds_since(start);
    if (scan) scans_.require_unchanged(work.inputs.front().node);
    if (uses_cache(work.memory))
        for (const ParameterFile& file : work.parameter_files) require_unchanged(file.path, file.content);
    std::vector<StepInput>& values = values_[job.node] = {};
    for (const auto& [port, value] : outputs) values.push_back({port, value});
    if (listener.is_cancelled && listener.is_cancelled()) throw Cancelled{};
    if (report.node.origin == Origin::ran) remember(job, work.memory, run_key, "", seconds, report);
    if (step.expectations.empty()) return;
    const std::string& primary = step.spec.outputs.front().name;
    check_expectations(step, *find(job.node, primary), {job.node, primary}, report.node);
}

void Workbench::expect(const Job&, const ExpectWork& work, JobReport& report) {
    const std::optional<Value> primary = fetch(work.primary, report);
    if (!primary) throw InputLost{};
    report.node.metrics = work.metrics;
    check_expectations(*work.step, *primary, {work.primary.node, work.primary.from}, report.node);
}

void Workbench::check_expectations(const PlannedStep& step, const Value& primary, const Place& place,
                                   NodeReport& report) {
    try {
        require_expectations(step, primary, report);
    } catch (const Error& error) {
        throw Unmet{error};
    }
    facts_[place] = report.facts;
}

void Workbench::write(const Job&, const WriteWork& work, JobReport& report) {
    OutputReport& written = report.output;
    written.file = work.file;
    const std::optional<Value> value = fetch(work.value, report);
    if (!value) throw InputLost{};
    written.kind = kind_of(*value);
    std::error_code trouble;
    fs::create_directories(work.file.parent_path(), trouble);
    if (trouble) throw Error("the folder '{}' cannot be made: {}", work.file.parent_path().string(), trouble.message());
    WriteOptions options;
    options.on_warning = [&](std::string text) { written.warnings.push_back(std::move(text)); };
    Sha256 hash;
    options.on_bytes = [&](std::string_view bytes) { hash.add(bytes); };
    write_file(work.file, *value, options);
    const auto known = facts_.find({work.value.node, work.value.from});
    written.facts = known != facts_.end() ? known->second : facts_of(*value);
    constexpr std::size_t longest_name = NAME_MAX;
    if (description_of(work.file).filename().native().size() <= longest_name)
        write_description(work.file, hash.text(), work.made_how, *value, written.facts);
    else
        options.on_warning(fmt::format("'{}' has no description: its name would be too long", work.file.string()));
    written.outcome = Outcome::done;
}

}  // namespace scanmill
