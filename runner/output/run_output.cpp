// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/run_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <map>
#include <set>

#include "output/error_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/compare/tables.hpp"
#include "scanmill/graph/output_files.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::runner {

namespace {

std::string shown_path(const std::filesystem::path& file) {
    const std::string relative = std::filesystem::proximate(file).string();
    return relative.starts_with("..") ? file.string() : relative;
}

/// A number in the row of a cell. The steps of a cell may have different units of lengths.
struct ShownMetric {
    Metric metric;
    LengthUnit lengths = LengthUnit::unknown;
};
using ShownMetrics = std::vector<ShownMetric>;

const ShownMetric* find(const ShownMetrics& metrics, const std::string& name) {
    const auto found = std::ranges::find_if(metrics, [&](const ShownMetric& one) { return one.metric.name == name; });
    return found == metrics.end() ? nullptr : &*found;
}

/// Replaces an earlier metric of the same name.
void set(ShownMetrics& metrics, const Metric& metric, LengthUnit lengths) {
    const auto found =
        std::ranges::find_if(metrics, [&](const ShownMetric& one) { return one.metric.name == metric.name; });
    if (found == metrics.end())
        metrics.push_back({metric, lengths});
    else
        *found = {metric, lengths};
}

/// The metrics of a cell that get a column in the report, in the order of the cell's steps.
ShownMetrics headline(const RunGraph& graph, const RunReport& report, std::size_t cell) {
    ShownMetrics shown;
    Metrics read;
    for (const std::size_t index : graph.cells[cell].nodes) {
        const RunNode& node = graph.nodes[index];
        const NodeReport& done = report.nodes[index];
        const PlannedStep* step = graph.step(node);
        if (!step) {
            if (!node.is_scan) continue;
            for (const Metric& property : done.properties.values) {  // the counts of a list's scans are added up
                const Metric* before = read.find(property.name);
                read.set(property.name, property.value + (before ? before->value : 0), property.unit);
                set(shown, *read.find(property.name), done.properties.unit);
            }
            continue;
        }
        for (const MetricSpec& metric : step->spec.metrics)
            if (const Metric* found = done.metrics.find(metric.name); metric.headline && found)
                set(shown, *found, done.metrics.unit);
    }
    for (const OutputReport& output : report.cells[cell].outputs)
        if (output.kind == kind_of<TriangleMesh>() && (output.outcome == Outcome::ok || !output.evidence.empty())) {
            for (const std::string_view name : {"triangles", "closed", "genus"})
                if (const Metric* property = output.properties.find(name))
                    set(shown, *property, output.properties.unit);
            break;
        }
    return shown;
}

/// A column of metrics. A unit that all values of the column share is written in its header, any other in the cells.
struct MetricColumn {
    std::string name, header;
    bool has_several_units = false;

    std::string cell(const ShownMetric* value) const {
        if (!value) return "-";
        return has_several_units ? display(value->metric, value->lengths) : display(value->metric);
    }
};

MetricColumn metric_column(const std::string& name, const std::vector<ShownMetrics>& cells) {
    std::set<std::string> units;
    bool is_declared = false;
    for (const ShownMetrics& metrics : cells)
        if (const ShownMetric* value = find(metrics, name)) {
            units.insert(length_unit_text(value->metric, value->lengths));
            is_declared = is_declared || value->lengths != LengthUnit::unknown;
        }
    const std::string unit = units.size() == 1 && is_declared ? *units.begin() : "";
    return {name, unit.empty() ? name : fmt::format("{} ({})", name, unit), units.size() > 1};
}

std::vector<MetricColumn> metric_columns(const std::vector<ShownMetrics>& cells) {
    std::vector<MetricColumn> columns;
    for (const ShownMetrics& metrics : cells)
        for (const ShownMetric& shown : metrics)
            if (std::ranges::find(columns, shown.metric.name, &MetricColumn::name) == columns.end())
                columns.push_back(metric_column(shown.metric.name, cells));
    return columns;
}

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

/// The file that could not be read, if the cell failed because of it. All cells of this scan that need the file fail
/// for the same reason.
std::optional<std::size_t> unreadable_file(const RunGraph& graph, const CellReport& report) {
    const bool is_file = report.failed_node && !graph.nodes[*report.failed_node].step;
    return is_file ? report.failed_node : std::nullopt;
}

/// The first cell of every row, and the number of cells that share the row. Cells of one scan that failed because of
/// one file share a row.
std::map<std::size_t, std::size_t> cells_by_row(const RunGraph& graph, const RunReport& report) {
    std::map<std::size_t, std::size_t> rows;
    std::map<std::pair<std::size_t, std::size_t>, std::size_t> row_of;  // row by file and scan
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell) {
        const std::optional<std::size_t> file = unreadable_file(graph, report.cells[cell]);
        const std::size_t row =
            file ? row_of.emplace(std::pair(*file, graph.cells[cell].scan), cell).first->second : cell;
        ++rows[row];
    }
    return rows;
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

std::string report_text(const RunGraph& graph, const RunReport& report, std::optional<std::size_t> width) {
    std::vector<ShownMetrics> numbers;
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell) numbers.push_back(headline(graph, report, cell));
    const std::vector<MetricColumn> columns = metric_columns(numbers);
    const bool several_workflows = has_several_workflows(graph), several_variants = has_several_variants(graph);
    std::vector<std::string> headers{"scan"};
    if (several_workflows) headers.push_back("workflow");
    if (several_variants) headers.push_back("variant");
    for (const MetricColumn& column : columns) headers.push_back(column.header);
    headers.insert(headers.end(), {"seconds", "outcome", "files"});
    Table table(std::move(headers));
    table.may_cut("scan");
    table.may_cut("files");
    std::size_t doubtful = 0, failed = 0;
    std::set<std::size_t> unreadable;          // nodes that read a file
    std::set<std::filesystem::path> evidence, moved_to, not_moved;  // variants may share a file
    for (const CellReport& done : report.cells) {
        doubtful += done.outcome == Outcome::doubtful;
        failed += done.outcome == Outcome::failed;
        if (const std::optional<std::size_t> file = unreadable_file(graph, done)) unreadable.insert(*file);
        for (const OutputReport& output : done.outputs) {
            if (!output.evidence.empty()) evidence.insert(output.evidence);
            if (!output.moved_to.empty()) moved_to.insert(output.moved_to);
            if (!output.not_moved.empty()) not_moved.insert(output.file);
        }
    }
    const std::map<std::size_t, std::size_t> rows = cells_by_row(graph, report);
    for (const auto& [cell, count] : rows) {
        const CellReport& done = report.cells[cell];
        std::vector<std::string> row{
            std::filesystem::path(graph.scan_names[graph.cells[cell].scan]).filename().string()};
        if (several_workflows) row.push_back(count > 1 ? "-" : graph.workflow(graph.cells[cell]));
        if (several_variants) row.push_back(count > 1 ? "-" : graph.variant(graph.cells[cell]).name);
        for (const MetricColumn& column : columns) row.push_back(column.cell(find(numbers[cell], column.name)));
        row.push_back(fmt::format("{:.2f}", done.seconds));
        row.emplace_back(name_of(done.outcome));
        std::string files;
        for (const OutputReport& output : done.outputs)
            if (output.outcome == Outcome::ok) files += (files.empty() ? "" : ", ") + shown_path(output.file);
        row.push_back(files.empty() ? "-" : files);
        table.add(std::move(row));
    }
    std::string text = table.text(width);
    if (doubtful > 0)
        text += fmt::format("{} of {} doubtful; the reasons are on stderr\n", doubtful, graph.cells.size());
    const std::string broken =
        rows.size() < graph.cells.size()
            ? fmt::format(" ({} could not be read)", count_text(unreadable.size(), "file", "files"))
            : "";
    if (failed > 0)
        text += fmt::format("{} of {} failed{}; the reasons are on stderr\n", failed, graph.cells.size(), broken);
    if (!evidence.empty())
        text +=
            fmt::format("{} written to '{}'\n", count_text(evidence.size(), "failed result was", "failed results were"),
                        shown_path(failed_folder(graph.output_folder)));
    if (!moved_to.empty())
        text += fmt::format("{} moved to *.previous, because the cells failed now\n",
                            count_text(moved_to.size(), "file of an earlier run was", "files of an earlier run were"));
    if (!not_moved.empty())
        text += fmt::format("{} could not be moved, although the cells failed now; see stderr\n",
                            count_text(not_moved.size(), "file of an earlier run", "files of an earlier run"));
    return text;
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
    print("output-written", json_of(OutputWrittenEvent{graph_.scan_names[cell.scan], output_record(report)}));
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
