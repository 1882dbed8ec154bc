// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/event_stream.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>

#include "output/failure_json.hpp"

namespace scanmill::runner {

Json EventStream::event(const char* name) const {
    const std::chrono::duration<double> since = std::chrono::steady_clock::now() - begin_;
    return {{"event", name}, {"at", since.count()}};
}

Json EventStream::step_event(const char* name, const RunNode& node) const {
    Json json = event(name);
    json["node"] = graph_.index(node);
    json["scan"] = graph_.scan_names[node.scan];
    json["workflow"] = workflow_name(*graph_.plans[node.plan]);
    json["step"] = graph_.label(node);
    return json;
}

void EventStream::say(const Json& event) {
    const std::scoped_lock one_at_a_time(mutex_);
    const std::string line = event.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
    has_failed_ = std::fwrite(line.data(), 1, line.size(), stdout) < line.size() || has_failed_;
    has_failed_ = std::fflush(stdout) != 0 || has_failed_;
}

void EventStream::begin(const std::string& name, unsigned jobs, unsigned threads, std::int64_t run) {
    Json json{{"scanmill", 1}};
    json.update(event("run-started"));
    json["name"] = name;
    if (run > 0) json["run"] = run;
    json["jobs"] = jobs;
    json["threads"] = threads;
    json["steps"] = graph_.nodes.size();
    json["cells"] = graph_.cells.size();
    say(json);
}

void EventStream::node_started(const RunNode& node, std::size_t worker) {
    Json json = step_event("step-started", node);
    json["worker"] = worker;
    say(json);
}

void EventStream::node_progress(const RunNode& node, double fraction) {
    const int percent = static_cast<int>(100 * fraction);
    {
        const std::scoped_lock one_at_a_time(mutex_);
        int& last = percents_[graph_.index(node)];
        if (percent <= last) return;
        last = percent;
    }
    Json json = step_event("step-progress", node);
    json["percent"] = percent;
    say(json);
}

void EventStream::node_warning(const RunNode& node, std::string_view text) {
    Json json = step_event("warning", node);
    json["text"] = text;
    say(json);
}

void EventStream::node_ended(const RunNode& node, const NodeReport& report) {
    Json json = step_event("step-ended", node);
    json["outcome"] = name_of(report.outcome);
    json["origin"] = name_of(report.origin);
    if (!report.why.empty()) json["why"] = report.why;
    json["seconds"] = report.effort.seconds;
    json["cpu-seconds"] = report.effort.cpu_seconds;
    json["peak-memory"] = report.effort.peak_memory;
    if (!report.metrics.values.empty()) json["metrics"] = metrics_json(report.metrics);
    if (report.failure) add_failure(json, report.failure);
    if (!report.effort.log.empty()) json["log"] = report.effort.log;
    say(json);
}

void EventStream::output_written(const RunCell& cell, const OutputReport& report) {
    Json json = event("output-written");
    json["scan"] = graph_.scan_names[cell.scan];
    json["file"] = report.file.string();
    json["outcome"] = name_of(report.outcome);
    json["properties"] = metrics_json(report.properties);
    if (!report.warnings.empty()) json["warnings"] = report.warnings;
    say(json);
}

void EventStream::cell_ended(const RunCell& cell, const CellReport& report) {
    Json json = event("cell-ended");
    json["cell"] = graph_.index(cell);
    json["scan"] = graph_.scan_names[cell.scan];
    json["workflow"] = graph_.workflow(cell);
    json["variant"] = graph_.variant(cell).name;
    json["outcome"] = name_of(report.outcome);
    json["seconds"] = report.seconds;
    if (report.failure) add_failure(json, report.failure);
    say(json);
}

void EventStream::end(const RunReport& report) {
    Json json = event("run-ended");
    json["interrupted"] = report.interrupted;
    for (const Outcome outcome : {Outcome::done, Outcome::failed, Outcome::skipped})
        json[std::string(name_of(outcome))] = std::ranges::count(report.cells, outcome, &CellReport::outcome);
    say(json);
}

}  // namespace scanmill::runner
