// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/run.hpp"

#include <stdlib.h>
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <new>

#include "scanmill/engine/facts.hpp"
#include "scanmill/engine/foresight.hpp"
#include "scanmill/engine/key.hpp"
#include "scanmill/engine/run_memory.hpp"
#include "scanmill/engine/step_runner.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/filter/module.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

/// Of this process until now, all threads together.
double cpu_seconds() {
    rusage used{};
    ::getrusage(RUSAGE_SELF, &used);
    const auto seconds = [](const timeval& time) {
        return static_cast<double>(time.tv_sec) + 1e-6 * static_cast<double>(time.tv_usec);
    };
    return seconds(used.ru_utime) + seconds(used.ru_stime);
}

/// A folder of its own below the system's temporary one, removed with everything in it.
class ScratchFolder {
public:
    ScratchFolder() {
        std::error_code unusable;
        const fs::path parent = fs::temp_directory_path(unusable);
        std::string name = (parent / "scanmill-XXXXXX").string();
        if (unusable || !::mkdtemp(name.data())) {
            const char* told = std::getenv("TMPDIR");
            throw Error("no scratch folder could be made in '{}'", told ? told : "/tmp")
                .hint("set TMPDIR to a folder that can be written to");
        }
        path_ = name;
    }
    ~ScratchFolder() {
        std::error_code ignored;
        fs::remove_all(path_, ignored);
    }
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;
    fs::path folder(std::size_t node) const {
        const fs::path folder = path_ / std::to_string(node);
        fs::create_directory(folder);
        return folder;
    }

private:
    fs::path path_;
};

/// The values of nodes, made when somebody needs them: kept in memory until their last use, mapped from the cache, or
/// computed.
class Executor {
public:
    Executor(const Plan& plan, FilterLibrary& library, const RunGraph& graph, const RunRequest& request,
             const RunSettings& settings, RunObserver& observer)
        : plan_(plan),
          library_(library),
          graph_(graph),
          request_(request),
          settings_(settings),
          observer_(observer),
          memory_(settings.cache, settings.keep),
          foresight_(settings.foresight.empty() ? foresee(plan, graph, settings.cache) : settings.foresight),
          values_(graph.nodes.size()),
          uses_left_(graph.nodes.size(), 0),
          visited_(graph.nodes.size(), false) {
        report_.nodes.resize(graph.nodes.size());
        report_.cells.resize(graph.cells.size());
        for (std::size_t index = 0; index < graph.nodes.size(); ++index)
            if (foresight_[index].will_run)
                for (const NodeInput& input : graph.nodes[index].inputs) ++uses_left_[input.node];
        for (const RunCell& cell : graph.cells)
            for (const RunOutput& output : cell.outputs) ++uses_left_[output.node];
    }

    RunReport run() {
        for (std::size_t cell = 0; cell < graph_.cells.size(); ++cell) {
            if (report_.interrupted) break;
            run_cell(graph_.cells[cell], report_.cells[cell]);
        }
        return std::move(report_);
    }

private:
    void run_cell(const RunCell& cell, CellReport& report) {
        for (const std::size_t node : cell.nodes) {
            if (!visited_[node]) visit(node);
            const NodeReport& done = report_.nodes[node];
            report.seconds += done.seconds;
            if (done.outcome == Outcome::failed && report.error.empty()) report.error = done.error;
        }
        for (const RunOutput& output : cell.outputs) {
            OutputReport written = write_output(cell, output, report);
            release(output.node);
            report.outputs.push_back(std::move(written));
        }
        const auto is_done = [&](std::size_t node) { return report_.nodes[node].outcome == Outcome::done; };
        if (!report.error.empty())
            report.outcome = Outcome::failed;
        else if (std::ranges::all_of(cell.nodes, is_done))
            report.outcome = Outcome::done;
        observer_.cell_ended(cell, report);
    }

    /// Runs the node, or takes over what the cache knows of it.
    void visit(std::size_t index) {
        visited_[index] = true;
        if (foresight_[index].will_run || report_.interrupted)
            run_node(index);
        else
            adopt_node(index);
        if (uses_left_[index] == 0) values_[index] = {};
    }

    void adopt_node(std::size_t index) {
        const RunNode& node = graph_.nodes[index];
        NodeReport& report = report_.nodes[index];
        adopt(*foresight_[index].known, node, report);
        report.origin = Origin::cached;
        report.outcome = Outcome::done;
        if (node.step && !plan_.steps[*node.step].expectations.empty()) {
            // They may be others than when it ran. Where the cache has lost the value, the node runs and asks by
            // itself.
            const PlannedStep& step = plan_.steps[*node.step];
            const std::optional<Value> primary = provide(index, step.spec.outputs.front().name);
            if (report.origin != Origin::cached) return;
            if (primary) attempt(index, report, [&] { require_expectations(step, *primary, report); });
        }
        for (const std::string& warning : report.warnings) observer_.node_warning(node, warning);
        observer_.node_started(node);
        observer_.node_ended(node, report);
    }

    void run_node(std::size_t index) {
        const RunNode& node = graph_.nodes[index];
        std::vector<StepInput> inputs;
        for (const NodeInput& input : node.inputs) {
            std::optional<Value> value = report_.interrupted ? std::nullopt : provide(input.node, input.from);
            if (!value) break;
            inputs.push_back({input.port, std::move(*value)});
        }
        if (!report_.interrupted && inputs.size() == node.inputs.size()) {
            NodeReport& report = report_.nodes[index] = {};
            report.why = foresight_[index].why;
            observer_.node_started(node);
            const auto start = std::chrono::steady_clock::now();
            const double cpu = cpu_seconds();
            attempt(index, report, [&] {
                if (node.step)
                    run_step_node(index, inputs, report);
                else
                    read_leaf_node(index, report);
            });
            report.seconds = seconds_since(start);
            report.cpu_seconds = cpu_seconds() - cpu;
            observer_.node_ended(node, report);
        } else {
            report_.nodes[index].outcome = Outcome::skipped;
        }
        for (const NodeInput& input : node.inputs) release(input.node);
    }

    /// The value: from memory, from the cache or, when that has lost it, made again. Nothing when that is not possible.
    std::optional<Value> provide(std::size_t index, const std::string& port) {
        if (!visited_[index]) visit(index);
        if (report_.nodes[index].outcome != Outcome::done) return std::nullopt;
        if (const Value* value = find(index, port)) return *value;
        const std::optional<StepResult>& known = foresight_[index].known;
        const ResultOutput* output = known ? known->output(port) : nullptr;
        if (std::optional<Value> value = output ? memory_.value(output->content) : std::nullopt) {
            values_[index].push_back({port, *value});
            return value;
        }
        foresight_[index].needed.insert(port);
        foresight_[index].why = "the cache has lost its value";
        for (const NodeInput& input : graph_.nodes[index].inputs) ++uses_left_[input.node];
        run_node(index);
        const Value* value = report_.nodes[index].outcome == Outcome::done ? find(index, port) : nullptr;
        return value ? std::optional<Value>(*value) : std::nullopt;
    }

    /// Turns whatever `work` throws into the node's report.
    template <class Work>
    void attempt(std::size_t index, NodeReport& report, Work&& work) {
        const RunNode& node = graph_.nodes[index];
        const auto fail = [&](Error error) {
            if (node.step) {
                const PlannedStep& step = plan_.steps[*node.step];
                error.add_frame(fmt::format("in step '{}' ({}:{}:{})", step.label, plan_.workflow.file,
                                            step.position.line, step.position.column));
            }
            if (node.step || node.file != graph_.scan_names[node.scan])
                error.add_frame(fmt::format("on scan '{}'", graph_.scan_names[node.scan]));
            report.outcome = Outcome::failed;
            report.error = error.what();
        };
        try {
            work();
            report.outcome = Outcome::done;
        } catch (const Cancelled&) {
            report_.interrupted = true;
        } catch (const Error& error) {
            fail(error);
        } catch (const std::bad_alloc&) {
            fail(Error("the machine's memory did not suffice")
                     .hint("thin the scan first, or use a machine with more memory"));
        } catch (const std::exception& error) {
            fail(Error("an unexpected error: {}", error.what()));
        }
    }

    void read_leaf_node(std::size_t index, NodeReport& report) {
        const RunNode& node = graph_.nodes[index];
        const auto on_warning = [&](std::string text) {
            observer_.node_warning(node, text);
            report.warnings.push_back(std::move(text));
        };
        const auto start = std::chrono::steady_clock::now();
        Value value = read_leaf(node.file, plan_.workflow.inputs[node.input], request_.unit, on_warning);
        require_unchanged(node, node.file, node.content);
        if (const auto* points = std::get_if<std::shared_ptr<const PointCloud>>(&value))
            report.facts.set("points", static_cast<double>((*points)->size()), Unit::count);
        else if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value))
            report.facts.set("points", static_cast<double>((*mesh)->positions.size()), Unit::count);
        values_[index].push_back({"", std::move(value)});
        remember(index, node.key, seconds_since(start), report);
    }

    void run_step_node(std::size_t index, const std::vector<StepInput>& inputs, NodeReport& report) {
        const RunNode& node = graph_.nodes[index];
        const PlannedStep& step = plan_.steps[*node.step];
        ContextOptions options;
        options.threads = settings_.threads;
        options.seed = settings_.seed;
        options.scratch = scratch_.folder(index);
        options.is_cancelled = settings_.is_cancelled;
        options.on_progress = [&](double fraction) { observer_.node_progress(node, fraction); };
        options.on_warning = [&](std::string_view text) { observer_.node_warning(node, text); };
        std::string run_key;
        auto start = std::chrono::steady_clock::now();
        const Recall recall = [&](const ParameterSet& resolved, NodeReport& of) -> std::optional<Outputs> {
            if (!uses_cache(node)) return std::nullopt;
            run_key = run_key_of(node, step, resolved);
            std::optional<Outputs> known = recalled(index, run_key, of);
            start = std::chrono::steady_clock::now();
            return known;
        };
        const auto filter = [&]() -> const FilterDeclaration& { return library_.load(step.spec.name); };
        const Outputs outputs = run_step(step, filter, inputs, std::move(options), recall, report);
        const double seconds = seconds_since(start);
        for (const ParameterFile& file : node.parameter_files) require_unchanged(node, file.path, file.content);
        for (const auto& [port, value] : outputs) values_[index].push_back({port, value});
        if (settings_.is_cancelled && settings_.is_cancelled()) report_.interrupted = true;
        if (report.origin == Origin::ran) remember(index, run_key, seconds, report);
        if (!step.expectations.empty())
            require_expectations(step, *find(index, step.spec.outputs.front().name), report);
    }

    bool uses_cache(const RunNode& node) const { return settings_.cache && !node.is_uncacheable; }

    /// The key knows a file as it was when the run was planned; what it holds now must not be kept under that key.
    void require_unchanged(const RunNode& node, const fs::path& file, const std::string& content) const {
        if (uses_cache(node) && content_hash(file) != content)
            throw Error("'{}' changed while the run was going on", file.string()).hint("run it again");
    }

    /// Filter, parameters as it gets them, and the content of its inputs: whatever else changed makes no difference.
    std::string run_key_of(const RunNode& node, const PlannedStep& step, const ParameterSet& resolved) const {
        KeyBuilder key;
        key.field("code", node.code);
        for (const auto& [name, value] : resolved.values)
            if (step.spec.parameter(name)->type != ParameterType::path)
                key.field("parameter " + name, canonical_text(value));
        for (const NodeInput& input : node.inputs)
            key.field("port " + input.port, foresight_[input.node].known->output(input.from)->content);
        return key.key();
    }

    /// What the cache knows under the run key, if all values that are needed were kept.
    std::optional<Outputs> recalled(std::size_t index, const std::string& run_key, NodeReport& report) {
        const RunNode& node = graph_.nodes[index];
        std::optional<StepResult> result = memory_.result(run_key);
        if (!result) return std::nullopt;
        Outputs outputs;
        for (const std::string& port : foresight_[index].needed) {
            const ResultOutput* output = result->output(port);
            std::optional<Value> value = output ? memory_.value(output->content) : std::nullopt;
            if (!value) return std::nullopt;
            outputs.set(port, std::move(*value));
        }
        memory_.connect(node.key, run_key);
        adopt(*result, node, report);
        report.origin = Origin::same_inputs;
        for (const std::string& warning : report.warnings) observer_.node_warning(node, warning);
        foresight_[index].known = std::move(result);
        return outputs;
    }

    /// Hands the node's result to the cache, and its values where that is worth it.
    void remember(std::size_t index, const std::string& run_key, double seconds, const NodeReport& report) {
        const RunNode& node = graph_.nodes[index];
        if (!uses_cache(node)) return;
        double cost = seconds;
        for (const NodeInput& input : node.inputs) cost += memory_.cost_of(input.node);
        StepResult result;
        for (const auto& [name, value] : report.resolved.values)
            if (!std::holds_alternative<std::monostate>(value) && !names_files(node, name))
                result.resolved.emplace_back(name, written(value));
        result.metrics = report.metrics;
        result.facts = report.facts;
        // Equal files of other names share the result: what is said of reading begins with the name.
        const std::string prefix = said_of(node);
        for (const std::string& warning : report.warnings)
            result.warnings.push_back(warning.starts_with(prefix) ? warning.substr(prefix.size()) : warning);
        result.seconds = seconds;
        result.outputs = memory_.keep_values(index, values_[index], cost);
        memory_.keep_result(node.key, run_key, result);
        foresight_[index].known = std::move(result);
    }

    /// The report of a node that did not run.
    void adopt(const StepResult& result, const RunNode& node, NodeReport& report) const {
        report.metrics = result.metrics;
        report.facts = result.facts;
        report.warnings.clear();
        for (const std::string& warning : result.warnings) report.warnings.push_back(said_of(node) + warning);
        if (!node.step) return;
        const PlannedStep& step = plan_.steps[*node.step];
        report.resolved = {};
        for (const auto& [name, value] : step.parameters.values)
            if (names_files(node, name)) report.resolved.values.emplace_back(name, value);
        for (const auto& [name, text] : result.resolved)
            report.resolved.values.emplace_back(name, parse(*step.spec.parameter(name), text));
    }

    bool names_files(const RunNode& node, const std::string& parameter) const {
        return plan_.steps[*node.step].spec.parameter(parameter)->type == ParameterType::path;
    }
    static std::string said_of(const RunNode& node) { return node.step ? "" : "'" + node.file.string() + "': "; }

    OutputReport write_output(const RunCell& cell, const RunOutput& output, CellReport& report) {
        OutputReport written;
        written.file = output.file;
        const auto start = std::chrono::steady_clock::now();
        try {
            if (const auto earlier = written_.find(output.file); earlier != written_.end()) return earlier->second;
            const std::optional<Value> provided = provide(output.node, output.port);
            if (!provided) {
                // Something may have failed only now, when a value was made again.
                for (const std::size_t node : cell.nodes)
                    if (report.error.empty()) report.error = report_.nodes[node].error;
                return written;
            }
            const Value& value = *provided;
            written.kind = kind_of(value);
            std::error_code trouble;
            fs::create_directories(output.file.parent_path(), trouble);
            if (trouble)
                throw Error("the folder '{}' cannot be made: {}", output.file.parent_path().string(),
                            trouble.message());
            WriteOptions options;
            options.on_warning = [&](std::string text) { written.warnings.push_back(std::move(text)); };
            write_file(output.file, value, options);
            written.outcome = Outcome::done;
            written.facts = facts_of(value);
            written_[output.file] = written;
        } catch (const std::exception& error) {
            written.outcome = Outcome::failed;
            if (report.error.empty())
                report.error = fmt::format("{}\n  on scan '{}'", error.what(), graph_.scan_names[cell.scan]);
        }
        report.seconds += seconds_since(start);
        observer_.output_written(cell, written);
        return written;
    }

    /// nullptr when it is not in memory.
    const Value* find(std::size_t node, const std::string& port) const {
        const auto found = std::ranges::find(values_[node], port, &StepInput::port);
        return found == values_[node].end() ? nullptr : &found->value;
    }

    void release(std::size_t node) {
        if (uses_left_[node] > 0) --uses_left_[node];
        if (uses_left_[node] == 0) values_[node] = {};
    }

    const Plan& plan_;
    FilterLibrary& library_;
    const RunGraph& graph_;
    const RunRequest& request_;
    const RunSettings& settings_;
    RunObserver& observer_;
    ScratchFolder scratch_;
    RunReport report_;
    RunMemory memory_;
    std::vector<NodeForesight> foresight_;
    std::vector<std::vector<StepInput>> values_;  // by node: its outputs, while somebody still needs them
    std::vector<std::size_t> uses_left_;
    std::vector<bool> visited_;
    std::map<fs::path, OutputReport> written_;
};

}  // namespace

std::string_view name_of(Outcome outcome) {
    switch (outcome) {
        case Outcome::done: return "done";
        case Outcome::failed: return "failed";
        case Outcome::skipped: return "skipped";
    }
    return "";
}

std::string_view name_of(Origin origin) {
    switch (origin) {
        case Origin::ran: return "ran";
        case Origin::cached: return "cached";
        case Origin::same_inputs: return "same inputs";
    }
    return "";
}

bool RunReport::all_done() const {
    return std::ranges::all_of(cells, [](const CellReport& cell) { return cell.outcome == Outcome::done; });
}

RunReport run(const Plan& plan, FilterLibrary& library, const RunGraph& graph, const RunRequest& request,
              const RunSettings& settings, RunObserver& observer) {
    return Executor(plan, library, graph, request, settings, observer).run();
}

}  // namespace scanmill
