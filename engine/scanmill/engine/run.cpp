// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/run.hpp"

#include <stdlib.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <new>

#include "scanmill/engine/facts.hpp"
#include "scanmill/engine/step_runner.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/formats/files.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

double seconds_since(std::chrono::steady_clock::time_point start) {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
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
          values_(graph.nodes.size()),
          uses_left_(graph.nodes.size(), 0),
          visited_(graph.nodes.size(), false) {
        report_.nodes.resize(graph.nodes.size());
        report_.cells.resize(graph.cells.size());
        for (const RunNode& node : graph.nodes)
            for (const NodeInput& input : node.inputs) ++uses_left_[input.node];
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
            if (!visited_[node]) run_node(node);
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

    void run_node(std::size_t index) {
        visited_[index] = true;
        const RunNode& node = graph_.nodes[index];
        NodeReport& report = report_.nodes[index];
        const auto needs = [&](const NodeInput& input) { return report_.nodes[input.node].outcome == Outcome::done; };
        if (!report_.interrupted && std::ranges::all_of(node.inputs, needs)) {
            observer_.node_started(node);
            const auto start = std::chrono::steady_clock::now();
            attempt(index, report);
            report.seconds = seconds_since(start);
            observer_.node_ended(node, report);
        }
        for (const NodeInput& input : node.inputs) release(input.node);
        if (uses_left_[index] == 0) values_[index] = {};
    }

    /// Runs the node and turns whatever it throws into a report.
    void attempt(std::size_t index, NodeReport& report) {
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
            if (node.step)
                run_step_node(index, report);
            else
                read_leaf_node(index, report);
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
        Value value = read_leaf(node.file, plan_.workflow.inputs[node.input], request_.unit, on_warning);
        if (const auto* points = std::get_if<std::shared_ptr<const PointCloud>>(&value))
            report.facts.set("points", static_cast<double>((*points)->size()), Unit::count);
        else if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(&value))
            report.facts.set("points", static_cast<double>((*mesh)->positions.size()), Unit::count);
        values_[index].push_back({"", std::move(value)});
    }

    void run_step_node(std::size_t index, NodeReport& report) {
        const RunNode& node = graph_.nodes[index];
        const PlannedStep& step = plan_.steps[*node.step];
        std::vector<StepInput> inputs;
        for (const NodeInput& input : node.inputs) inputs.push_back({input.port, value_of(input.node, input.from)});
        ContextOptions options;
        options.threads = settings_.threads;
        options.seed = settings_.seed;
        options.scratch = scratch_.folder(index);
        options.is_cancelled = settings_.is_cancelled;
        options.on_progress = [&](double fraction) { observer_.node_progress(node, fraction); };
        options.on_warning = [&](std::string_view text) { observer_.node_warning(node, text); };
        const Outputs outputs = run_step(step, library_.load(step.spec.name), inputs, std::move(options), report);
        for (const auto& [port, value] : outputs) values_[index].push_back({port, value});
        if (settings_.is_cancelled && settings_.is_cancelled()) report_.interrupted = true;
    }

    OutputReport write_output(const RunCell& cell, const RunOutput& output, CellReport& report) {
        OutputReport written;
        written.file = output.file;
        if (report_.nodes[output.node].outcome != Outcome::done) return written;
        const Value value = value_of(output.node, output.port);
        written.kind = kind_of(value);
        const auto start = std::chrono::steady_clock::now();
        try {
            if (const auto earlier = written_.find(output.file); earlier != written_.end()) return earlier->second;
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

    const Value& value_of(std::size_t node, const std::string& port) const {
        const auto found = std::ranges::find(values_[node], port, &StepInput::port);
        return found->value;
    }

    void release(std::size_t node) {
        if (--uses_left_[node] == 0) values_[node] = {};
    }

    const Plan& plan_;
    FilterLibrary& library_;
    const RunGraph& graph_;
    const RunRequest& request_;
    const RunSettings& settings_;
    RunObserver& observer_;
    ScratchFolder scratch_;
    RunReport report_;
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

bool RunReport::all_done() const {
    return std::ranges::all_of(cells, [](const CellReport& cell) { return cell.outcome == Outcome::done; });
}

RunReport run(const Plan& plan, FilterLibrary& library, const RunGraph& graph, const RunRequest& request,
              const RunSettings& settings, RunObserver& observer) {
    return Executor(plan, library, graph, request, settings, observer).run();
}

}  // namespace scanmill
