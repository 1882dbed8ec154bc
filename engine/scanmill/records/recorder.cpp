// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/records/recorder.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

std::optional<CostRecord> cost_of(const NodeReport& report) {
    if (report.outcome != Outcome::ok || report.origin != Origin::ran) return std::nullopt;
    return CostRecord{report.effort.seconds, report.effort.cpu_seconds, report.effort.peak_memory};
}

/// The costs of the cell, added up over its nodes; empty unless all its nodes ran.
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
    const PlannedStep* planned = graph_.step(node);
    steps_.push_back(step_record(graph_, node, report, planned ? library_.build_id(planned->spec.name) : ""));
    node_costs_[steps_.back().node] = cost_of(report);
    flush_when_due();
}

void Recorder::cell_ended(const RunCell& cell, const CellReport& report) {
    cells_.push_back(cell_record(graph_, cell, report));
    if (measures_costs_) cells_.back().costs = cost_of(cell, node_costs_);
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
        warn(fmt::format("the records of this run are incomplete: {}", trouble_));
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
