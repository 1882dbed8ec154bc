// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/load.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/describe/filter_page.hpp"

namespace scanmill::runner {

namespace {

void print_ports(std::string_view title, const std::vector<PortSpec>& ports) {
    if (ports.empty()) return;
    fmt::print("\n{}\n", title);
    for (const PortSpec& port : ports)
        fmt::print("  {} ({}{}{})\n      {}\n", port.name, kinds_text(port), port.list ? ", any number" : "",
                   port.optional ? ", optional" : "", port.help);
}

void print_parameter(const ParameterSpec& parameter) {
    const std::string value = text(parameter.default_value);
    fmt::print("  {}{}\n      {}\n      {}\n", parameter.name,
               parameter.required ? " (required)"
               : value.empty()    ? ""
                                  : " = " + value,
               parameter.help, "Takes " + expectation(parameter) + ".");
    for (const Choice& choice : parameter.choices) fmt::print("      {}: {}\n", choice.name, choice.help);
}

void print_text(const FilterSpec& spec) {
    fmt::print("{} (version {})\n  {}\n  Source: {}\n", spec.name, spec.version, spec.summary, spec.source);
    if (!spec.ties.empty()) fmt::print("  Ties: {}\n", spec.ties);
    if (!spec.not_finite.empty()) fmt::print("  NaN and infinity: {}\n", spec.not_finite);
    if (spec.streams) fmt::print("  Large scans: {}\n", stream_text(spec));
    print_ports("Takes", spec.inputs);
    print_ports("Gives (the first is what the step's name alone means)", spec.outputs);
    if (!spec.parameters.empty()) fmt::print("\nParameters\n");
    for (const ParameterSpec& parameter : spec.parameters) print_parameter(parameter);
    if (!spec.metrics.empty()) fmt::print("\nMetrics\n");
    for (const MetricSpec& metric : spec.metrics)
        fmt::print("  {} ({})\n      {}\n", metric.name, name_of(metric.unit), metric.help);
}

int show(const std::string& name, bool json, bool example) {
    const FilterLibrary library = open_library();
    const FilterSpec* spec = library.find(name);
    if (!spec) {
        for (const UnusableModule& module : library.unusable())
            if (module.name == name)
                throw Error("the filter '{}' cannot be used: '{}' {}", name, module.manifest.string(), module.reason);
        throw Error("there is no filter '{}'{}", name, did_you_mean(name, library.names())).hint("scanmill list");
    }
    if (example && json) {
        const nlohmann::ordered_json described{
            {"scanmill", 1}, {"filter", spec->name}, {"example", example_workflow(*spec, library)}};
        fmt::print("{}\n", described.dump(2));
    } else if (example) {
        fmt::print("{}", example_workflow(*spec, library));
    } else if (json) {
        auto described = nlohmann::ordered_json::parse(to_json_text({"", *spec}));
        described.erase("scanmill-manifest");
        described.erase("abi");
        fmt::print("{}\n", nlohmann::ordered_json{{"scanmill", 1}, {"filter", std::move(described)}}.dump(2));
    } else {
        print_text(*spec);
    }
    return done;
}

}  // namespace

void add_show(CLI::App& app, Action& chosen) {
    struct Options {
        std::string filter;
        bool json = false, example = false;
    };
    CLI::App* command = app.add_subcommand("show", "Shows what a filter takes, gives and can be told");
    auto options = std::make_shared<Options>();
    command->add_option("FILTER", options->filter, "The filter's name")->required();
    command->add_flag("--json", options->json, "Print the declaration as JSON");
    command->add_flag("--example", options->example,
                      "Print a workflow with this filter, every parameter at its default");
    command->callback(
        [&chosen, options] { chosen = [options] { return show(options->filter, options->json, options->example); }; });
}

}  // namespace scanmill::runner
