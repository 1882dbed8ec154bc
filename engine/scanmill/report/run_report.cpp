// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/report/run_report.hpp"

namespace scanmill {

static Texts texts_of(const ParameterSet& parameters) {
    Texts texts;
    for (const auto& [name, value] : parameters.values)
        if (std::string shown = text(value); !shown.empty()) texts.emplace_back(name, std::move(shown));
    return texts;
}

/// "in [99 %, 100 %]", "< 0.1 mm" or "2".
static std::string limits_text(const PlannedExpectation& expectation) {
    const std::string_view limits = std::string_view(expectation.text).substr(expectation.name.size());
    return std::string(limits.substr(limits.find_first_not_of(": ")));
}

FailureRecord record_of(const Failure& failure) {
    return {failure.cause, failure.number, failure ? failure.whole().what() : "", is_of_machine(failure)};
}

StepRecord step_record(const RunGraph& graph, const RunNode& node, const NodeReport& report, std::string build) {
    StepRecord step;
    step.node = graph.index(node);
    step.workflow = workflow_name(*graph.plans[node.plan]);
    step.label = graph.label(node);
    step.scan = graph.scan_names[node.scan];
    step.plan_key = node.key;
    if (const PlannedStep* planned = graph.step(node)) {
        step.filter = planned->spec.name;
        step.filter_version = planned->spec.version;
        step.build = std::move(build);
        step.authored = texts_of(planned->parameters);
        for (const NodeInput& input : node.inputs) step.inputs.push_back({input.port, input.node, input.from});
        for (const PlannedExpectation& expectation : planned->expectations)
            step.expected.emplace_back(expectation.name, limits_text(expectation));
    } else {
        step.file = node.leaf.name();
        step.authored = declared_of(node.leaf);
    }
    step.origin = report.origin;
    step.why = report.why;
    step.outcome = report.outcome;
    step.failure = record_of(report.failure);
    step.effort = report.effort;
    step.attempts = report.attempts;
    step.resolved = texts_of(report.resolved);
    step.metrics = report.metrics;
    step.properties = report.properties;
    step.warnings = report.warnings;
    return step;
}

OutputRecord output_record(const RunOutput& output, const OutputReport& report) {
    return {report.file.string(),
            std::string(name_of(report.kind)),
            report.outcome,
            report.properties,
            report.sha256,
            report.bytes,
            report.moved_to.string(),
            report.not_moved,
            report.warnings,
            report.evidence.string(),
            output.node,
            output.port};
}

CellRecord cell_record(const RunGraph& graph, const RunCell& cell, const CellReport& report) {
    CellRecord record;
    record.scan = graph.scan_names[cell.scan];
    record.workflow = graph.workflow(cell);
    record.variant = graph.variant(cell).name;
    record.outcome = report.outcome;
    record.failure = record_of(report.failure);
    record.seconds = report.seconds;
    record.nodes = cell.nodes;
    record.doubts = report.doubts;
    record.place = cell.place;
    for (std::size_t output = 0; output < report.outputs.size(); ++output)
        record.outputs.push_back(output_record(cell.outputs[output], report.outputs[output]));
    return record;
}

}  // namespace scanmill
