// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands.hpp"
#include "error_output.hpp"
#include "execute.hpp"
#include "load.hpp"
#include "printable.hpp"
#include "scanmill/engine/facts.hpp"
#include "scanmill/engine/step_runner.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/filter/suggestion.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/formats/metrics_json.hpp"
#include "stderr_text.hpp"
#include "table.hpp"

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

std::vector<StepInput> read_inputs(const Options& options, const std::function<void(std::string)>& warn) {
    ReadOptions reading;
    reading.on_warning = warn;
    reading.unit = parse_unit(options.unit);
    const Value mesh = read_mesh(options.mesh, reading);
    if (!options.truth_unit.empty()) reading.unit = parse_unit(options.truth_unit);
    return {{"mesh", mesh}, {"truth", read_file(options.truth, reading).value}};
}

std::string unit_text(const Metric& metric, LengthUnit unit) {
    const std::string length(unit == LengthUnit::unknown ? "u" : symbol(unit));
    switch (metric.unit) {
        case Unit::length: return " " + length;
        case Unit::area: return " " + length + "²";
        case Unit::volume: return " " + length + "³";
        default: return "";
    }
}

std::string report_text(const Metrics& metrics) {
    Table table({"metric", "value"});
    for (const Metric& metric : metrics.values)
        table.add({metric.name, display(metric) + unit_text(metric, metrics.unit)});
    return table.text();
}

std::string report_json(const Options& options, const Metrics& metrics, const std::vector<std::string>& warnings) {
    const bool is_known = metrics.unit != LengthUnit::unknown;
    const nlohmann::ordered_json json{{"scanmill", 1},
                                      {"mesh", options.mesh},
                                      {"truth", options.truth},
                                      {"unit", is_known ? nlohmann::ordered_json(symbol(metrics.unit)) : nullptr},
                                      {"metrics", metrics_json(metrics)},
                                      {"warnings", warnings}};
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
    std::vector<std::string> warnings;
    const auto warn = [&](std::string text) {
        tell("warning: {}\n", printable(text));
        warnings.push_back(std::move(text));
    };
    ContextOptions running;
    running.threads = options.threads > 0 ? options.threads : cores();
    running.seed = options.seed;
    running.on_warning = [&](std::string_view text) { warn(std::string(text)); };
    try {
        NodeReport report;
        const Outputs outputs = run_step(
            step, [&]() -> const FilterDeclaration& { return library.load(std::string(filter)); },
            read_inputs(options, warn), std::move(running),
            [](const ParameterSet&, NodeReport&) { return std::nullopt; }, report);
        const auto& metrics = *std::get<std::shared_ptr<const Metrics>>(*outputs.find(spec->outputs.front().name));
        fmt::print("{}", options.json ? report_json(options, metrics, warnings) : report_text(metrics));
    } catch (const Error& error) {
        print(error, options.json);
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
                        "The unit of length of files that declare none: um, mm, cm, m, in, ft");
    command->add_option("--truth-unit", options->truth_unit, "The same for TRUTH, where it differs");
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
