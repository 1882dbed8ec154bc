// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <new>
#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/execute.hpp"
#include "commands/load.hpp"
#include "output/error_output.hpp"
#include "output/printable.hpp"
#include "output/stderr_text.hpp"
#include "output/table.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/worker/step_runner.hpp"

namespace scanmill::runner {

namespace {

constexpr std::string_view filter = "measure";

struct Options {
    std::string mesh, truth, unit, truth_unit;
    std::vector<std::string> settings;
    bool certify = false, json = false;
    unsigned threads = 0;
    std::uint64_t seed = 0;
};

/// The filter's defaults, but for what is given.
ParameterSet parameters_of(const FilterSpec& spec, const std::vector<std::string>& pairs) {
    const Settings settings = parse_settings(pairs);
    for (const auto& [name, value] : settings) {
        std::vector<std::string> names;
        for (const ParameterSpec& parameter : spec.parameters) names.push_back(parameter.name);
        if (!spec.parameter(name))
            throw Error("{} has no parameter '{}'; it has {}{}", spec.name, name, enumerated(names),
                        did_you_mean(name, names));
        if (value.sweep) throw Error("--set {}: a sweep is for workflows; give one value", name);
    }
    ParameterSet set;
    for (const ParameterSpec& parameter : spec.parameters) {
        const auto given = settings.find(parameter.name);
        try {
            set.values.emplace_back(parameter.name, given == settings.end()
                                                        ? parameter.default_value
                                                        : parse(parameter, given->second.values.front().literal));
        } catch (const Error& error) {
            throw Error("--set {}: {}", parameter.name, error.sentence());
        }
    }
    return set;
}

/// The truth in the mesh's unit, where both are known.
std::vector<StepInput> read_inputs(const Options& options, LengthUnit unit, LengthUnit truth_unit,
                                   const std::function<void(std::string)>& warn) {
    ReadOptions reading;
    reading.on_warning = warn;
    reading.unit = unit;
    const Value mesh = read_mesh(options.mesh, reading);
    reading.unit = truth_unit;
    Value truth = read_file(options.truth, reading).value;
    if (!truth.find<TriangleMesh>() && !truth.find<PointCloud>())
        throw Error("'{}': the truth is a mesh or points; the file contains {}", options.truth, truth.kind().name());
    if (Frame frame = *frame_of(truth); frame.unit == LengthUnit::unknown) {
        frame.unit = unit;  // --unit is for files that do not declare theirs
        truth = reframed(truth, frame);
    }
    for (const Value* value : std::initializer_list<const Value*>{&mesh, &truth})
        require_supported_range(bounding_box(positions_of(*value).span()));
    const LengthUnit here = frame_of(mesh)->unit, there = frame_of(truth)->unit;
    if (here != there && here != LengthUnit::unknown && there != LengthUnit::unknown) truth = in_unit(truth, here);
    return {{"mesh", mesh}, {"truth", truth}};
}

std::string report_text(const Metrics& metrics) {
    Table table({"metric", "value"});
    for (const Metric& metric : metrics.values) table.add({metric.name, display(metric, metrics.unit)});
    return table.text();
}

std::string report_json(const Options& options, const Metrics& metrics, const std::vector<std::string>& warnings) {
    nlohmann::ordered_json json;
    kind_of<Metrics>().info().to_json(&metrics, json);
    json["mesh"] = options.mesh;
    json["truth"] = options.truth;
    json["warnings"] = warnings;
    return json.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace) + "\n";
}

int measure(Options options) {
    FilterLibrary library = open_library();
    const FilterSpec* spec = library.find(filter);
    if (!spec) throw Error("the filter '{}' is not installed", filter).hint("scanmill list");
    if (options.certify) options.settings.emplace_back("certify=true");
    PlannedStep step;
    step.label = filter;
    step.spec = *spec;
    step.parameters = parameters_of(*spec, options.settings);
    const LengthUnit unit = parse_unit(options.unit), truth_unit = parse_unit(options.truth_unit);
    std::vector<std::string> warnings;
    const auto warn = [&](std::string text) {
        tell("warning: {}\n", printable(text));
        warnings.push_back(std::move(text));
    };
    ContextOptions running;
    running.threads = options.threads > 0 ? options.threads : usable_cores();
    running.seed = options.seed;
    running.on_warning = [&](std::string_view text) { warn(std::string(text)); };
    try {
        NodeReport report;
        const Outputs outputs = run_step(
            step, [&]() -> const FilterDeclaration& { return library.load(std::string(filter)); },
            read_inputs(options, unit, truth_unit, warn), std::move(running),
            [](const ParameterSet&, NodeReport&) { return std::nullopt; }, report);
        const auto& metrics = *outputs.find(spec->outputs.front().name)->get<Metrics>();
        fmt::print("{}", options.json ? report_json(options, metrics, warnings) : report_text(metrics));
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
    CLI::App* command =
        app.add_subcommand("measure", "Tells how far a mesh is from the truth, and how good a mesh it is");
    auto options = std::make_shared<Options>();
    command->add_option("MESH", options->mesh, "The mesh to measure")->required();
    command->add_option("TRUTH", options->truth, "What it should be: a mesh, or points")->required();
    command->add_option("--unit", options->unit,
                        "The files' unit of length, whatever they declare: um, mm, cm, m, in, ft");
    command->add_option("--truth-unit", options->truth_unit,
                        "The same of TRUTH, where it differs: it is converted to that of MESH");
    command->add_flag("--certify", options->certify, "Bound the Hausdorff distance from below and above; takes longer");
    command->add_option("--set", options->settings,
                        "NAME=VALUE: a parameter of the filter, as `scanmill show measure` lists them");
    command->add_option("--threads", options->threads, "0: all cores. Results do not depend on it")
        ->capture_default_str();
    command->add_option("--seed", options->seed, "Seed of the samples")->capture_default_str();
    command->add_flag("--json", options->json, "Print JSON");
    command->callback([&chosen, options] { chosen = [options] { return measure(*options); }; });
}

}  // namespace scanmill::runner
