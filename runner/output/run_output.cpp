// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/run_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "output/error_output.hpp"
#include "output/run_table.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::runner {

namespace {

/// The scan, workflow and variant of a cell.
Json cell_json(const RunGraph& graph, const RunCell& cell) {
    return {{"scan", graph.scan_names[cell.scan]},
            {"workflow", graph.workflow(cell)},
            {"variant", graph.variant(cell).name}};
}

/// Adds the option that helps to the text of the failure.
void add_option(FailureRecord& record, const Failure& failure) {
    if (failure) record.error = with_option(failure.whole()).what();
}

StepRecord shown_step(const RunGraph& graph, const RunNode& node, const NodeReport& report) {
    StepRecord step = step_record(graph, node, report, "");
    add_option(step.failure, report.failure);
    return step;
}

CellRecord shown_cell(const RunGraph& graph, const RunCell& cell, const CellReport& report) {
    CellRecord record = cell_record(graph, cell, report);
    add_option(record.failure, report.failure);
    return record;
}

}  // namespace

std::string graph_text(const RunGraph& graph, const std::vector<NodePrediction>& predictions) {
    std::string text;
    std::size_t cached = 0;
    const bool several_workflows = has_several_workflows(graph);
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        const RunNode& node = graph.nodes[index];
        text += fmt::format("{:>4}. {} {}{}{}\n", index + 1, node.key.substr(0, 8), graph.label(node),
                            node.step ? "" : " " + node.leaf.name(), node.leaf.is_streamed ? ", as a stream" : "");
        for (const NodeInput& input : node.inputs)
            text += fmt::format("        {} <- {}{}\n", input.port, input.node + 1,
                                input.from.empty() ? "" : "." + input.from);
        for (const ParameterFile& file : node.parameter_files)
            text += fmt::format("        reads {}\n", shown_path(file.path));
        if (!node.unreadable.empty()) text += fmt::format("        {}\n", node.unreadable);
        cached += !predictions[index].will_run;
        text += predictions[index].will_run ? fmt::format("        will run because {}\n", predictions[index].why)
                                            : "        cached\n";
    }
    for (const RunCell& cell : graph.cells)
        for (const RunOutput& output : cell.outputs)
            text += fmt::format("{} [{}{}] -> {}\n", graph.scan_names[cell.scan],
                                several_workflows ? graph.workflow(cell) + ": " : "", graph.variant(cell).name,
                                shown_path(output.file));
    return text + fmt::format("{} to compute, {} cached, {}\n", graph.nodes.size() - cached, cached,
                              count_text(graph.cells.size(), "cell", "cells"));
}

Json graph_json(const RunGraph& graph, const std::vector<NodePrediction>& predictions) {
    Json json{{"scanmill", 1}, {"nodes", Json::array()}, {"cells", Json::array()}};
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        const RunNode& node = graph.nodes[index];
        Json entry{{"key", node.key}, {"step", graph.label(node)}, {"in", Json::array()}};
        if (!node.step) {
            entry["file"] = node.leaf.name();
            entry["streamed"] = node.leaf.is_streamed;
        }
        for (const ParameterFile& file : node.parameter_files)
            entry["parameter-files"].push_back(shown_path(file.path));
        if (!node.unreadable.empty()) entry["unreadable"] = node.unreadable;
        for (const NodeInput& input : node.inputs)
            entry["in"].push_back({{"port", input.port}, {"node", input.node}, {"from", input.from}});
        entry["cached"] = !predictions[index].will_run;
        if (predictions[index].will_run) entry["why"] = predictions[index].why;
        json["nodes"].push_back(std::move(entry));
    }
    for (const RunCell& cell : graph.cells) {
        Json entry = cell_json(graph, cell);
        entry["nodes"] = cell.nodes;
        entry["outputs"] = Json::array();
        for (const RunOutput& output : cell.outputs) entry["outputs"].push_back(output.file.string());
        json["cells"].push_back(std::move(entry));
    }
    return json;
}

Json report_json(const RunGraph& graph, const RunReport& report) {
    RunDocument document{workflow_name(*graph.plans.front()), report.interrupted, {}, {}};
    for (std::size_t index = 0; index < graph.nodes.size(); ++index)
        document.steps.push_back(shown_step(graph, graph.nodes[index], report.nodes[index]));
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell)
        document.cells.push_back(shown_cell(graph, graph.cells[cell], report.cells[cell]));
    Json json{{"scanmill", 1}};
    json.update(json_of(document));
    return json;
}

std::vector<std::string> EventStream::variants_of(const RunNode& node) const {
    std::vector<std::string> variants;
    if (has_several_variants_)
        for (const std::size_t cell : names_.cells(graph_.index(node), node.scan))
            variants.push_back(graph_.variant(graph_.cells[cell]).name);
    return variants;
}

StepName EventStream::name_of_step(const RunNode& node) const {
    return {graph_.index(node), graph_.scan_names[node.scan], workflow_name(*graph_.plans[node.plan]),
            graph_.label(node), variants_of(node)};
}

void EventStream::print(const char* name, const Json& members) {
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin_;
    Json event{{"event", name}, {"at", since.count()}};
    event.update(members);
    const std::string line = text_of(event) + "\n";
    const std::scoped_lock one_at_a_time(mutex_);
    has_failed_ = std::fwrite(line.data(), 1, line.size(), stdout) < line.size() || has_failed_;
    has_failed_ = std::fflush(stdout) != 0 || has_failed_;
}

void EventStream::begin(const std::string& name, unsigned jobs, unsigned threads, std::int64_t run) {
    print("run-started",
          json_of(RunStartedEvent{1, name, run, jobs, threads, graph_.nodes.size(), graph_.cells.size()}));
}

void EventStream::node_started(const RunNode& node, std::size_t worker) {
    print("step-started", json_of(StepStartedEvent{name_of_step(node), worker}));
}

void EventStream::node_progress(const RunNode& node, double fraction) {
    const int percent = static_cast<int>(100 * fraction);
    {
        const std::scoped_lock one_at_a_time(mutex_);
        int& last = percents_[graph_.index(node)];
        if (percent <= last) return;
        last = percent;
    }
    print("step-progress", json_of(StepProgressEvent{name_of_step(node), percent}));
}

void EventStream::node_warning(const RunNode& node, std::string_view text) {
    print("warning", json_of(WarningEvent{name_of_step(node), std::string(text)}));
}

void EventStream::node_ended(const RunNode& node, const NodeReport& report) {
    print("step-ended", json_of(StepEndedEvent{variants_of(node), shown_step(graph_, node, report)}));
}

void EventStream::output_written(const RunCell& cell, const OutputReport& report) {
    const auto output = std::ranges::find(cell.outputs, report.file, &RunOutput::file);
    print("output-written", json_of(OutputWrittenEvent{graph_.scan_names[cell.scan], output_record(*output, report)}));
}

void EventStream::cell_ended(const RunCell& cell, const CellReport& report) {
    print("cell-ended", json_of(CellEndedEvent{graph_.index(cell), shown_cell(graph_, cell, report)}));
}

void EventStream::pass_started(unsigned pass, unsigned passes) {
    print("pass-started", json_of(PassStartedEvent{pass, passes}));
}

void EventStream::judged(const VerdictEvent& verdict) { print("verdict", json_of(verdict)); }

void EventStream::end(const RunReport& report) {
    const auto count = [&](Outcome outcome) {
        return static_cast<std::size_t>(std::ranges::count(report.cells, outcome, &CellReport::outcome));
    };
    print("run-ended", json_of(RunEndedEvent{report.interrupted, count(Outcome::ok), count(Outcome::doubtful),
                                             count(Outcome::failed), count(Outcome::skipped)}));
}

}  // namespace scanmill::runner
