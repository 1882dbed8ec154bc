// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Runs made by hand: a batch over scans and variants, every cell with a measured step and an output.

#include <string>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/compare/comparison.hpp"
#include "scanmill/gate/gate.hpp"

namespace scanmill::test {

inline RunDetails made_run(std::int64_t id, const std::vector<GateRule>& rules = {}) {
    RunDetails run;
    run.summary.id = id;
    run.summary.started = "2026-01-0" + std::to_string(id % 10) + "T02:00:00Z";
    run.summary.outcome = "ok";
    run.summary.workflow = run.start.workflow = "nightly";
    run.start.file = "jobs/nightly.yaml";
    run.start.arguments = {"scanmill", "batch", "jobs/nightly.yaml", "-o", "out"};
    run.start.version = "0.1.0";
    run.start.machine = "a box";
    run.start.threads = 2;
    run.start.jobs = 1;
    for (const GateRule& rule : rules) run.start.gate.emplace_back(rule.metric, rule.text);
    run.start.repeats = rules.empty() ? 1 : 3;
    return run;
}

/// The cell with its steps `read`, `surface` and `measure-surface`, and the output SCAN-VARIANT.ply.
inline CellRecord& add_cell(RunDetails& run, const std::string& scan, const std::string& variant = "default",
                            double hausdorff = 0.5) {
    const std::size_t node = run.steps.size();
    for (const char* label : {"read", "surface", "measure-surface"}) {
        StepRecord& step = run.steps.emplace_back();
        step.node = run.steps.size() - 1;
        step.label = label;
        step.scan = scan;
        step.origin = Origin::ran;
        step.outcome = Outcome::ok;
        step.plan_key = std::string("key of ") + label;
    }
    StepRecord &surface = run.steps[node + 1], &measure = run.steps[node + 2];
    surface.filter = "sculpt";
    surface.filter_version = 3;
    surface.authored = {{"bin-size", "1 %diag"}};
    surface.metrics = {{{"flips", 12, Unit::count}}, LengthUnit::millimetre};
    surface.properties = {{{"genus", 1, Unit::count}, {"triangles", 100, Unit::count}}, LengthUnit::millimetre};
    measure.filter = "measure";
    measure.metrics = {{{"hausdorff", hausdorff, Unit::length},
                        {"f-score", 0.9, Unit::ratio},
                        {"closed", 1, Unit::boolean},
                        {"diagonal", 200, Unit::length}},
                       LengthUnit::millimetre};
    CellRecord& cell = run.cells.emplace_back();
    cell.workflow = "compare";
    cell.scan = scan;
    cell.variant = variant;
    cell.outcome = Outcome::ok;
    cell.seconds = 1.5;
    cell.nodes = {node, node + 1, node + 2};
    OutputRecord& output = cell.outputs.emplace_back();
    output.file = "/anywhere/out/" + scan.substr(scan.rfind('/') + 1) + "-" + variant + ".ply";
    output.kind = "mesh";
    output.outcome = Outcome::ok;
    output.properties = {{{"genus", 1, Unit::count}, {"triangles", 100, Unit::count}}, LengthUnit::millimetre};
    output.sha256 = "aaaaaaaaaaaa";
    output.bytes = 1000;
    return cell;
}

/// The step of the cell with this label.
inline StepRecord& step_of(RunDetails& run, const CellRecord& cell, const std::string& label) {
    for (const std::size_t node : cell.nodes)
        if (run.steps[node].label == label) return run.steps[node];
    throw Error("the cell has no step {}", label);
}

inline RunDetails run_of_one(std::int64_t id, double hausdorff, const std::vector<GateRule>& rules = {}) {
    RunDetails run = made_run(id, rules);
    add_cell(run, "jobs/scans/a.ply", "default", hausdorff);
    return run;
}

/// On one line, whatever the scan's name.
inline std::string made_command(const RunDetails& run, const CellRecord& cell, const std::string& scan) {
    return "scanmill batch " + run.start.file + " --scan " + scan.substr(0, scan.find('<')) + " --only " + cell.variant;
}

inline Comparison compared(const RunDetails& run, const RunDetails& accepted, std::vector<PastCosts> costs = {}) {
    const Baseline baseline{
        accepted,
        Acceptance{1, accepted.summary.id, accepted.start.workflow, "2026-01-01T08:00:00Z", "Ann", "first", {}, {}, {}},
        "", std::move(costs)};
    return compare(run, &baseline, made_command);
}

/// Passes of so many seconds, as much processor time and 100 MB.
inline std::vector<CostRecord> passes(const std::vector<double>& seconds) {
    std::vector<CostRecord> costs;
    for (const double each : seconds) costs.push_back({each, each, 100'000'000});
    return costs;
}

}  // namespace scanmill::test
