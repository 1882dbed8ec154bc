// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/run_output.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "output/failure_json.hpp"
#include "output/table.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill::runner {

namespace {

std::string shown_path(const std::filesystem::path& file) {
    const std::string relative = std::filesystem::proximate(file).string();
    return relative.starts_with("..") ? file.string() : relative;
}

/// The numbers worth a column, of one cell, in the order of its steps.
Metrics headline(const RunGraph& graph, const RunReport& report, std::size_t cell) {
    Metrics shown, read;
    for (const std::size_t index : graph.cells[cell].nodes) {
        const RunNode& node = graph.nodes[index];
        const NodeReport& done = report.nodes[index];
        const PlannedStep* step = graph.step(node);
        if (!step) {
            if (!node.is_scan) continue;
            for (const Metric& fact : done.properties.values) {  // a list's scans are counted together
                const Metric* before = read.find(fact.name);
                read.set(fact.name, fact.value + (before ? before->value : 0), fact.unit);
                shown.set(fact.name, read.find(fact.name)->value, fact.unit);
            }
            continue;
        }
        for (const MetricSpec& metric : step->spec.metrics)
            if (const Metric* found = done.metrics.find(metric.name); metric.headline && found)
                shown.set(metric.name, found->value, found->unit);
    }
    for (const OutputReport& output : report.cells[cell].outputs)
        if (output.kind == kind_of<TriangleMesh>() && output.outcome == Outcome::done) {
            for (const std::string_view name : {"triangles", "closed", "genus"})
                if (const Metric* fact = output.properties.find(name)) shown.set(name, fact->value, fact->unit);
            break;
        }
    return shown;
}

bool has_several_workflows(const RunGraph& graph) {
    return std::ranges::any_of(
        graph.plans, [&](const auto& plan) { return plan->workflow.file != graph.plans.front()->workflow.file; });
}

bool has_several_variants(const RunGraph& graph) {
    return std::ranges::any_of(graph.plans, [](const auto& plan) { return plan->variants.size() > 1; });
}

Json to_json(const ParameterSet& parameters) {
    Json json = Json::object();
    for (const auto& [name, value] : parameters.values)
        if (const std::string shown = text(value); !shown.empty()) json[name] = shown;
    return json;
}

}  // namespace

std::string graph_text(const RunGraph& graph, const std::vector<NodePrediction>& prediction) {
    std::string text;
    std::size_t cached = 0;
    const bool several_workflows = has_several_workflows(graph);
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        const RunNode& node = graph.nodes[index];
        text +=
            fmt::format("{:>4}. {} {}{}{}\n", index + 1, node.key.substr(0, 8), graph.label(node),
                        node.step ? "" : " " + node.leaf.file.string(), node.leaf.is_streamed ? ", as a stream" : "");
        for (const NodeInput& input : node.inputs)
            text += fmt::format("        {} <- {}{}\n", input.port, input.node + 1,
                                input.from.empty() ? "" : "." + input.from);
        if (!node.unreadable.empty()) text += fmt::format("        {}\n", node.unreadable);
        cached += !prediction[index].will_run;
        text += prediction[index].will_run ? fmt::format("        will run because {}\n", prediction[index].why)
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

std::string graph_json(const RunGraph& graph, const std::vector<NodePrediction>& prediction) {
    Json json{{"scanmill", 1}, {"nodes", Json::array()}, {"cells", Json::array()}};
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        const RunNode& node = graph.nodes[index];
        Json entry{{"key", node.key}, {"step", graph.label(node)}, {"in", Json::array()}};
        if (!node.step) {
            entry["file"] = node.leaf.file.string();
            entry["streamed"] = node.leaf.is_streamed;
        }
        if (!node.unreadable.empty()) entry["unreadable"] = node.unreadable;
        for (const NodeInput& input : node.inputs)
            entry["in"].push_back({{"port", input.port}, {"node", input.node}, {"from", input.from}});
        entry["cached"] = !prediction[index].will_run;
        if (prediction[index].will_run) entry["why"] = prediction[index].why;
        json["nodes"].push_back(std::move(entry));
    }
    for (const RunCell& cell : graph.cells) {
        Json entry{{"scan", graph.scan_names[cell.scan]},
                   {"workflow", graph.workflow(cell)},
                   {"variant", graph.variant(cell).name},
                   {"nodes", cell.nodes},
                   {"outputs", Json::array()}};
        for (const RunOutput& output : cell.outputs) entry["outputs"].push_back(output.file.string());
        json["cells"].push_back(std::move(entry));
    }
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

std::string report_text(const RunGraph& graph, const RunReport& report) {
    std::vector<Metrics> numbers;
    std::vector<std::string> columns;
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell) {
        numbers.push_back(headline(graph, report, cell));
        for (const Metric& metric : numbers.back().values)
            if (std::ranges::find(columns, metric.name) == columns.end()) columns.push_back(metric.name);
    }
    const bool several_workflows = has_several_workflows(graph), several_variants = has_several_variants(graph);
    std::vector<std::string> headers{"scan"};
    if (several_workflows) headers.push_back("workflow");
    if (several_variants) headers.push_back("variant");
    headers.insert(headers.end(), columns.begin(), columns.end());
    headers.insert(headers.end(), {"seconds", "result"});
    Table table(std::move(headers));
    std::size_t failed = 0;
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell) {
        const CellReport& done = report.cells[cell];
        if (done.outcome == Outcome::failed) ++failed;
        std::vector<std::string> row{
            std::filesystem::path(graph.scan_names[graph.cells[cell].scan]).filename().string()};
        if (several_workflows) row.push_back(graph.workflow(graph.cells[cell]));
        if (several_variants) row.push_back(graph.variant(graph.cells[cell]).name);
        for (const std::string& column : columns) {
            const Metric* metric = numbers[cell].find(column);
            row.push_back(metric ? display(*metric) : "-");
        }
        row.push_back(fmt::format("{:.2f}", done.seconds));
        std::string result = done.outcome == Outcome::done ? "" : std::string(name_of(done.outcome));
        for (const OutputReport& output : done.outputs)
            if (output.outcome == Outcome::done) result += (result.empty() ? "" : ", ") + shown_path(output.file);
        row.push_back(result.empty() ? "done" : result);
        table.add(std::move(row));
    }
    std::string text = table.text();
    if (failed > 0) text += fmt::format("{} of {} failed; the reasons are on stderr\n", failed, graph.cells.size());
    return text;
}

std::string report_json(const RunGraph& graph, const RunReport& report) {
    Json json{{"scanmill", 1},
              {"workflow", workflow_name(*graph.plans.front())},
              {"interrupted", report.interrupted},
              {"steps", Json::array()},
              {"cells", Json::array()}};
    for (std::size_t index = 0; index < graph.nodes.size(); ++index) {
        const RunNode& node = graph.nodes[index];
        const NodeReport& done = report.nodes[index];
        Json entry{{"key", node.key},
                   {"step", graph.label(node)},
                   {"outcome", name_of(done.outcome)},
                   {"origin", name_of(done.origin)},
                   {"seconds", done.effort.seconds}};
        if (!done.why.empty() && done.origin == Origin::ran) entry["why"] = done.why;
        if (done.effort.peak_memory > 0) entry["peak-memory"] = done.effort.peak_memory;
        if (node.step)
            entry["filter"] = graph.step(node)->spec.name;
        else
            entry["file"] = node.leaf.file.string();
        if (!done.resolved.values.empty()) entry["parameters"] = to_json(done.resolved);
        if (!done.metrics.values.empty()) entry["metrics"] = metrics_json(done.metrics);
        if (!done.properties.values.empty()) entry["properties"] = metrics_json(done.properties);
        if (!done.warnings.empty()) entry["warnings"] = done.warnings;
        if (done.failure) add_failure(entry, done.failure);
        if (!done.effort.log.empty()) entry["log"] = done.effort.log;
        json["steps"].push_back(std::move(entry));
    }
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell) {
        const CellReport& done = report.cells[cell];
        Json entry{{"scan", graph.scan_names[graph.cells[cell].scan]},
                   {"workflow", graph.workflow(graph.cells[cell])},
                   {"variant", graph.variant(graph.cells[cell]).name},
                   {"outcome", name_of(done.outcome)},
                   {"seconds", done.seconds},
                   {"steps", graph.cells[cell].nodes},
                   {"outputs", Json::array()}};
        if (done.failure) add_failure(entry, done.failure);
        for (const OutputReport& output : done.outputs) {
            Json file{{"file", output.file.string()},
                      {"outcome", name_of(output.outcome)},
                      {"kind", name_of(output.kind)},
                      {"properties", metrics_json(output.properties)}};
            if (!output.warnings.empty()) file["warnings"] = output.warnings;
            entry["outputs"].push_back(std::move(file));
        }
        json["cells"].push_back(std::move(entry));
    }
    return json.dump(2, ' ', false, Json::error_handler_t::replace);
}

}  // namespace scanmill::runner
