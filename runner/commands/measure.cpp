// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <new>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/error_output.hpp"
#include "output/terminal.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/plan/step_parameters.hpp"
#include "scanmill/session/session.hpp"
#include "scanmill/worker/step_runner.hpp"

namespace scanmill::runner {

namespace {

const std::string filter = "measure";

struct Options {
    std::string mesh, truth;
    LengthUnit unit = LengthUnit::unknown, truth_unit = LengthUnit::unknown;
    InvalidRows invalid = InvalidRows::by_format;
    std::vector<std::string> settings;
    bool certify = false, json = false;
    unsigned threads = 0;
    std::uint64_t seed = 0;
};

/// The filter's defaults, overridden by --set.
ParameterSet parameters_of(const FilterSpec& spec, const std::vector<std::string>& pairs) {
    StepSyntax step;
    step.filter = spec.name;
    for (const auto& [name, value] : parse_settings(pairs)) {
        if (value.sweep) throw Error("--set {}: a sweep is for workflows; give one value", name);
        step.parameters.push_back({name, {}, value});
    }
    ExpandedStep expanded{&step, {}, {}};
    for (const NamedExpression& parameter : step.parameters) {
        const WrittenValue& written = parameter.value.values.front();
        expanded.arguments.push_back({&parameter, &written, written.literal, {}});
    }
    Diagnostics diagnostics("");
    ParameterSet set = step_parameters(expanded, spec, {"", {}, diagnostics, nullptr});
    if (diagnostics.has_errors()) throw Error("--set: {}", diagnostics.sorted().front().message);
    return set;
}

/// The truth in the mesh's unit. Throws Error if only one of the two declares a unit: a wrong guess would be a wrong
/// score.
std::vector<StepInput> read_inputs(const Options& options, const Warn& warn) {
    ReadOptions reading;
    reading.on_warning = warn;
    reading.unit = options.unit;
    const Value mesh = read_mesh(options.mesh, reading);
    reading.unit = options.truth_unit;
    const LoadedFile loaded = read_file(options.truth, reading);
    Value truth = loaded.value;
    if (truth.find<PointCloud>())
        truth =
            std::make_shared<const PointCloud>(accepted_points(loaded, options.truth, reading, options.invalid).result);
    else if (!truth.find<TriangleMesh>())
        throw Error("'{}': the truth is a mesh or points; the file contains {}", options.truth, truth.kind().name());
    if (Frame frame = *frame_of(truth); frame.unit == LengthUnit::unknown) {
        frame.unit = options.unit;  // --unit is also that of a truth that declares none
        truth = reframed(truth, frame);
    }
    for (const Value* value : std::initializer_list<const Value*>{&mesh, &truth})
        require_supported_range(bounding_box(positions_of(*value).span()));
    const LengthUnit here = frame_of(mesh)->unit, there = frame_of(truth)->unit;
    if (here == there) return {{"mesh", mesh}, {"truth", truth}};
    if (here == LengthUnit::unknown)
        throw Error("'{}' declares no unit, '{}' is in {}; they cannot be compared", options.mesh, options.truth,
                    symbol(there))
            .hint("name its unit: --unit mm");
    if (there == LengthUnit::unknown)
        throw Error("'{}' is in {}, '{}' declares no unit; they cannot be compared", options.mesh, symbol(here),
                    options.truth)
            .hint("name its unit: --truth-unit mm");
    truth = in_unit(truth, here);
    return {{"mesh", mesh}, {"truth", truth}};
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
    const FilterSpec& spec = find_filter(library, filter);
    std::vector<std::string> settings = options.settings;
    if (options.certify) settings.emplace_back("certify=true");
    PlannedStep step;
    step.label = filter;
    step.spec = spec;
    step.parameters = parameters_of(spec, settings);
    std::vector<std::string> warnings;
    const auto warn = [&](std::string text) {
        print_warning(text);
        warnings.push_back(std::move(text));
    };
    ContextOptions running;
    running.threads = options.threads > 0 ? options.threads : usable_cores();
    running.seed = options.seed;
    running.on_warning = [&](std::string_view text) { warn(std::string(text)); };
    try {
        NodeReport report;
        const Outputs outputs = run_step(
            step, [&]() -> const FilterDeclaration& { return library.load(filter); }, read_inputs(options, warn),
            std::move(running), [](const ParameterSet&, NodeReport&) { return std::nullopt; }, report);
        const auto& metrics = *outputs.find(spec.outputs.front().name)->get<Metrics>();
        if (options.json)
            print_json(report_json(options, metrics, warnings));
        else
            fmt::print("{}", report_text(metrics));
    } catch (const Error& error) {
        print(error, options.json);
        return some_failed;
    } catch (const std::bad_alloc&) {
        print(Error("memory ran out").hint("measure with fewer samples (--set samples=100000), or smaller meshes"),
              options.json);
        return some_failed;
    }
    return done;
}

}  // namespace

void add_measure(CLI::App& app, Action& chosen) {
    auto [command, options] = add_command<Options>(
        app, chosen, "measure", "Measures the distance of a mesh from the truth, and the quality of the mesh", measure);
    command.add_option("MESH", options.mesh, "The mesh to measure")->required();
    command.add_option("TRUTH", options.truth, "The correct shape: a mesh, or points")->required();
    add_unit_option(command, "--unit", options.unit, "The unit of MESH, and of TRUTH if that declares none");
    add_unit_option(command, "--truth-unit", options.truth_unit,
                    "The unit of TRUTH, which is converted to that of MESH");
    add_invalid_option(command, options.invalid,
                       "Points of TRUTH with a NaN, infinite or too distant coordinate: drop or refuse. Default: drop "
                       "where the format writes NaN for a ray without a return (PCD, PTX), else refuse");
    command.add_flag("--certify", options.certify, "Bound the Hausdorff distance from below and above; takes longer");
    command.add_option("--set", options.settings,
                       "NAME=VALUE: a parameter of the filter, as `scanmill show measure` lists them");
    command.add_option("--threads", options.threads, "0: all cores. Does not change results")->capture_default_str();
    command.add_option("--seed", options.seed, "Seed of the samples")->capture_default_str();
    command.add_flag("--json", options.json, "Print JSON");
}

}  // namespace scanmill::runner
