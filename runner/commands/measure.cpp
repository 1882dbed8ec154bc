// SPDX-License-Identifier: GPL-3.0-or-later
// The command `measure`: makes a workflow of one step and runs it like any other workflow.

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/error_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/batch/batch.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/run/run.hpp"
#include "scanmill/session/session.hpp"

namespace scanmill::runner {

namespace {

constexpr const char* metrics_file = "metrics.json";

struct Options {
    std::string mesh, truth, filter;
    LengthUnit unit = LengthUnit::unknown, truth_unit = LengthUnit::unknown;
    InvalidRows invalid = InvalidRows::by_format;
    std::vector<std::string> settings;
    bool certify = false, json = false;
    unsigned threads = 0;
    std::uint64_t seed = 0;
};

const FilterSpec& measuring_filter(const FilterLibrary& library, const std::string& wanted) {
    const std::vector<std::string> names = measuring_filters(library);
    if (names.empty()) throw Error("no installed filter measures results");
    if (wanted.empty() && names.size() > 1)
        throw Error("{} measure results; expected --filter NAME", enumerated(names));
    if (!wanted.empty() && std::ranges::find(names, wanted) == names.end())
        throw Error("'{}' is not a filter that measures results; expected {}{}", wanted, enumerated(names),
                    did_you_mean(wanted, names));
    return *library.find(wanted.empty() ? names.front() : wanted);
}

/// A workflow that reads the value and the truth, measures, and writes the numbers.
Workflow measuring_workflow(const FilterSpec& spec, const Settings& settings) {
    Workflow workflow;
    workflow.name = spec.name;
    StepSyntax step;
    step.filter = spec.name;
    for (const std::string& name : {spec.measures->value, spec.measures->truth}) {
        const PortSpec& port = *spec.input(name);
        WorkflowInput& input = workflow.inputs.emplace_back();
        input.name = name;
        input.kind = port.kind;
        input.also = port.also;
        step.in.push_back({name, {}, {{name, {}}}});
    }
    for (const auto& [name, value] : settings) {
        if (value.sweep) throw Error("--set {}: a sweep is allowed in workflows only; give one value", name);
        step.parameters.push_back({name, {}, value});
    }
    workflow.steps.push_back({std::move(step)});
    workflow.outputs.push_back({metrics_file, {}, {spec.name, {}}});
    return workflow;
}

/// The unit of the truth. --unit also applies to a truth that declares no unit.
LengthUnit unit_of_truth(const Options& options) {
    if (options.truth_unit != LengthUnit::unknown || options.unit == LengthUnit::unknown) return options.truth_unit;
    try {
        const std::optional<Frame> frame = frame_of(read_file(options.truth).value);
        return frame && frame->unit == LengthUnit::unknown ? options.unit : LengthUnit::unknown;
    } catch (const Error&) {
        return LengthUnit::unknown;  // the run reports this error
    }
}

RunGraph graph_of(const FilterSpec& spec, const Options& options, FilterLibrary& library,
                  const std::filesystem::path& folder) {
    std::vector<std::string> settings = options.settings;
    if (options.certify) settings.emplace_back("certify=true");
    Diagnostics diagnostics("");
    const Plan plan = make_plan(measuring_workflow(spec, parse_settings(settings)), library, {}, diagnostics);
    if (diagnostics.has_errors()) throw Error("--set: {}", diagnostics.sorted().front().message);
    RunRequest request;
    ScanFile& mesh = request.scans.emplace_back(options.mesh);
    mesh.unit = options.unit;
    ScanFile& truth = mesh.inputs[spec.measures->truth].emplace_back(options.truth);
    truth.unit = unit_of_truth(options);
    truth.invalid = options.invalid;
    request.output_folder = folder;
    request.seed = options.seed;
    return make_graph(plan, library, request);
}

std::string report_text(const Metrics& metrics) {
    Table table({"metric", "value"});
    for (const Metric& metric : metrics.values) table.add({metric.name, display(metric, metrics.unit)});
    return table.text();
}

nlohmann::ordered_json report_json(const Options& options, const Metrics& metrics,
                                   const std::vector<std::string>& warnings) {
    nlohmann::ordered_json json;
    kind_of<Metrics>().info().to_json(&metrics, json);
    json["mesh"] = options.mesh;
    json["truth"] = options.truth;
    json["warnings"] = warnings;
    return json;
}

int measure(const Options& options) {
    FilterLibrary library = open_library();
    ScratchFolder scratch;
    const std::filesystem::path folder = scratch.folder("measure");
    const RunGraph graph = graph_of(measuring_filter(library, options.filter), options, library, folder);
    InProcessWorker worker(library, nullptr, KeepRule::Policy::never, {});
    RunSettings running;
    running.threads = options.threads > 0 ? options.threads : usable_cores();
    const RunReport report = run(library, graph, worker, running);
    std::vector<std::string> warnings;
    for (const NodeReport& node : report.nodes)
        warnings.insert(warnings.end(), node.warnings.begin(), node.warnings.end());
    for (const std::string& warning : warnings) print_warning(warning);
    if (report.outcome() >= Outcome::failed) {
        print(report.cells.front().failure.whole(), options.json);
        return report.has_fault() ? our_fault : some_failed;
    }
    const auto metrics = read_file(folder / metrics_file).value.get<Metrics>();
    if (options.json)
        print_json(report_json(options, *metrics, warnings));
    else
        fmt::print("{}", report_text(*metrics));
    return done;
}

}  // namespace

void add_measure(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<Options>(
        app, chosen, "measure", "Measures the distance of a mesh from the truth, and the quality of the mesh", measure);
    command.add_option("MESH", options.mesh, "The mesh to measure")->required();
    command.add_option("TRUTH", options.truth, "The correct shape: a mesh, or points")->required();
    add_unit_option(command, "--unit", options.unit, "The unit of MESH, and of TRUTH if TRUTH declares none");
    add_unit_option(command, "--truth-unit", options.truth_unit,
                    "The unit of TRUTH; TRUTH is converted to the unit of MESH");
    add_invalid_option(
        command, options.invalid,
        "How to treat points of TRUTH with a NaN, infinite or too distant coordinate: drop or refuse. "
        "Default: drop in formats that write NaN for a ray without a return (PCD, PTX), refuse in others");
    command.add_option("--filter", options.filter, "The filter that measures, if several are installed");
    command.add_flag("--certify", options.certify, "Bound the Hausdorff distance from below and above; takes longer");
    command.add_option("--set", options.settings,
                       "A filter parameter's value, NAME=VALUE; `scanmill show measure` lists the parameters");
    command.add_option("--threads", options.threads, "Number of threads; 0: all cores. Results do not depend on it")
        ->capture_default_str();
    command.add_option("--seed", options.seed, "Seed of the samples")->capture_default_str();
    command.add_flag("--json", options.json, "Print the metrics as JSON");
}

}  // namespace scanmill::runner
