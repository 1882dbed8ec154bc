// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/records/recorder.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

std::vector<std::pair<std::string, std::string>> texts_of(const ParameterSet& parameters) {
    std::vector<std::pair<std::string, std::string>> texts;
    for (const auto& [name, value] : parameters.values)
        if (std::string shown = text(value); !shown.empty()) texts.emplace_back(name, std::move(shown));
    return texts;
}

FailureRecord record_of(const Failure& failure) {
    return {std::string(name_of(failure.cause)), failure.number, failure ? failure.whole().what() : ""};
}

std::optional<CostRecord> cost_of(const NodeReport& report) {
    if (report.outcome != Outcome::ok || report.origin != Origin::ran) return std::nullopt;
    return CostRecord{report.effort.seconds, report.effort.cpu_seconds,
                      static_cast<std::int64_t>(report.effort.peak_memory)};
}

/// Empty unless all nodes of the cell ran.
std::vector<CostRecord> cost_of(const RunCell& cell, const std::vector<std::optional<CostRecord>>& nodes) {
    CostRecord sum;
    for (const std::size_t node : cell.nodes) {
        if (!nodes[node]) return {};
        sum.seconds += nodes[node]->seconds;
        sum.cpu_seconds += nodes[node]->cpu_seconds;
        sum.peak_memory = std::max(sum.peak_memory, nodes[node]->peak_memory);
    }
    return {sum};
}

}  // namespace

Recorder::Recorder(std::filesystem::path file, RunStart start, FilterLibrary& library, const RunGraph& graph,
                   OnWarning on_warning, bool measures_costs)
    : library_(library),
      graph_(graph),
      on_warning_(std::move(on_warning)),
      measures_costs_(measures_costs),
      node_costs_(graph.nodes.size()),
      begin_(std::chrono::steady_clock::now()),
      flushed_(begin_) {
    beginning_ = std::async(std::launch::async, [this, file = std::move(file), start = std::move(start)] {
        RunRecords records = RunRecords::append_to(file);
        run_ = records.begin(start);
        records_.emplace(std::move(records));
    });
}

void Recorder::node_ended(const RunNode& node, const NodeReport& report) {
    StepRecord step;
    step.node = graph_.index(node);
    step.workflow = workflow_name(*graph_.plans[node.plan]);
    step.scan = graph_.scan_names[node.scan];
    step.plan_key = node.key;
    step.label = graph_.label(node);
    if (const PlannedStep* planned = graph_.step(node)) {
        step.filter = planned->spec.name;
        step.filter_version = planned->spec.version;
        step.build = library_.build_id(planned->spec.name);
        step.authored = texts_of(planned->parameters);
        step.measures = planned->measures;
    } else {
        step.authored = declared_of(node.leaf);
    }
    step.origin = name_of(report.origin);
    step.why = report.why;
    step.outcome = name_of(report.outcome);
    step.failure = record_of(report.failure);
    step.seconds = report.effort.seconds;
    step.cpu_seconds = report.effort.cpu_seconds;
    step.peak_memory = static_cast<std::int64_t>(report.effort.peak_memory);
    step.threads = report.effort.threads;
    step.attempts = report.attempts;
    step.log = report.effort.log;
    step.resolved = texts_of(report.resolved);
    step.metrics = report.metrics;
    step.properties = report.properties;
    step.warnings = report.warnings;
    node_costs_[step.node] = cost_of(report);
    steps_.push_back(std::move(step));
    flush_when_due();
}

void Recorder::cell_ended(const RunCell& cell, const CellReport& report) {
    CellRecord record;
    record.workflow = graph_.workflow(cell);
    record.scan = graph_.scan_names[cell.scan];
    record.variant = graph_.variant(cell).name;
    record.outcome = name_of(report.outcome);
    record.failure = record_of(report.failure);
    record.seconds = report.seconds;
    record.nodes = cell.nodes;
    record.doubts = report.doubts;
    for (const OutputReport& output : report.outputs)
        record.outputs.push_back({output.file.string(), std::string(name_of(output.kind)),
                                  std::string(name_of(output.outcome)), output.properties, output.sha256,
                                  static_cast<std::int64_t>(output.bytes), output.moved_to.string()});
    record.truth = cell.truth.string();
    if (measures_costs_) record.costs = cost_of(cell, node_costs_);
    cells_.push_back(std::move(record));
    flush_when_due();
}

void Recorder::add_pass(const RunGraph& graph, const RunReport& report) {
    std::vector<std::optional<CostRecord>> nodes;
    for (const NodeReport& node : report.nodes) nodes.push_back(cost_of(node));
    for (const RunCell& cell : graph.cells)
        if (std::vector<CostRecord> costs = cost_of(cell, nodes); !costs.empty())
            costs_.push_back(
                {graph.workflow(cell), graph.scan_names[cell.scan], graph.variant(cell).name, std::move(costs)});
    flush();
}

Recorder::~Recorder() {
    wait_for_begin();
    flush();
}

void Recorder::finish(const RunReport& report) {
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin_;
    const std::string outcome = report.interrupted ? "interrupted" : std::string(name_of(report.outcome()));
    if (!costs_.empty()) flush();
    if (!attempt([&] { records_->end(run_, steps_, cells_, outcome, seconds.count()); }) && records_)
        warn(fmt::format("this run is not recorded to its end: {}", trouble_));
    steps_.clear();
    cells_.clear();
}

void Recorder::flush_when_due() {
    const std::chrono::seconds patience(trouble_.empty() ? 1 : 10);
    if (std::chrono::steady_clock::now() - flushed_ > patience) flush();
}

bool Recorder::flush() {
    flushed_ = std::chrono::steady_clock::now();
    if (!steps_.empty() || !cells_.empty()) {
        if (!attempt([&] { records_->add(run_, steps_, cells_); })) return false;
        steps_.clear();
        cells_.clear();
    }
    if (!costs_.empty() && !attempt([&] { records_->add_costs(run_, costs_); })) return false;
    costs_.clear();
    return true;
}

void Recorder::wait_for_begin() {
    if (!beginning_.valid()) return;
    try {
        beginning_.get();
    } catch (const Error& error) {
        warn(fmt::format("this run is not recorded: {}", error.sentence()));
    }
}

void Recorder::warn(std::string text) const {
    if (on_warning_) on_warning_(std::move(text));
}

template <class Action>
bool Recorder::attempt(Action&& action) {
    wait_for_begin();
    if (!records_) return false;
    try {
        action();
        trouble_.clear();
        return true;
    } catch (const Error& error) {
        trouble_ = error.sentence();
        return false;
    }
}

}  // namespace scanmill
