// SPDX-License-Identifier: GPL-3.0-or-later
// The commands `list` and `show`, which print the installed filters.

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "commands/commands.hpp"
#include "commands/common.hpp"
#include "output/terminal.hpp"
#include "scanmill/describe/filter_page.hpp"

namespace scanmill::runner {

namespace {

using Json = nlohmann::ordered_json;

std::string kinds(const std::vector<PortSpec>& ports) {
    std::string text;
    for (const PortSpec& port : ports)
        text += (text.empty() ? "" : ", ") + kinds_text(port) + (port.list ? "…" : "") + (port.optional ? "?" : "");
    return text.empty() ? "-" : text;
}

struct ListOptions {
    bool json = false, names = false;
};

int list(const ListOptions& options) {
    const FilterLibrary library = open_library();
    Json filters = Json::array(), unusable = Json::array();
    Table table({"filter", "takes", "gives", "what it does"});
    for (const std::string& name : library.names()) {
        const FilterSpec& spec = *library.find(name);
        table.add({name, kinds(spec.inputs), kinds(spec.outputs), spec.summary});
        if (options.json) filters.push_back(declaration_json(spec));
        if (options.names) fmt::print("{}\n", name);
    }
    if (options.names) return done;
    for (const UnusableModule& module : library.unusable()) {
        const std::string manifest = module.manifest.string();
        unusable.push_back({{"name", module.name}, {"manifest", manifest}, {"reason", module.reason}});
        if (!options.json)
            print_warning(fmt::format("the filter '{}' cannot be used: '{}' {}", module.name, manifest, module.reason));
    }
    if (options.json)
        print_json({{"scanmill", 1}, {"filters", std::move(filters)}, {"unusable", std::move(unusable)}});
    else
        fmt::print("{}", table.text());
    return done;
}

void print_ports(std::string_view title, const std::vector<PortSpec>& ports) {
    if (ports.empty()) return;
    fmt::print("\n{}\n", title);
    for (const PortSpec& port : ports)
        fmt::print("  {} ({}{}{}{})\n      {}\n", port.name, kinds_text(port), port.list ? ", any number" : "",
                   port.optional ? ", optional" : "", port.by_name ? ", by name alone" : "", port.help);
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

void print_filter(const FilterSpec& spec) {
    fmt::print("{} (version {})\n  {}\n  Source: {}\n", spec.name, spec.version, spec.summary, spec.source);
    if (!spec.ties.empty()) fmt::print("  Ties: {}\n", spec.ties);
    if (!spec.not_finite.empty()) fmt::print("  NaN and infinity: {}\n", spec.not_finite);
    if (spec.streams) fmt::print("  Large scans: {}\n", stream_text(spec));
    if (spec.measures) fmt::print("  Measures: {}\n", measures_text(*spec.measures));
    if (spec.draws) fmt::print("  Draws: {}\n", draws_text(*spec.draws));
    if (spec.simplifies) fmt::print("  Simplifies: {}\n", simplifies_text(*spec.simplifies));
    if (!spec.adds.empty()) fmt::print("  Columns that it may add: {}\n", fmt::join(spec.adds, ", "));
    print_ports("Takes", spec.inputs);
    print_ports("Gives (the step's name alone refers to the first)", spec.outputs);
    if (!spec.parameters.empty()) fmt::print("\nParameters\n");
    for (const ParameterSpec& parameter : spec.parameters) print_parameter(parameter);
    if (!spec.metrics.empty()) fmt::print("\nMetrics\n");
    for (const MetricSpec& metric : spec.metrics)
        fmt::print("  {} ({})\n      {}{}\n", metric.name, name_of(metric.unit), metric.help,
                   metric.better == Better::neither  ? ""
                   : metric.better == Better::larger ? " Larger is better."
                                                     : " Smaller is better.");
    if (!spec.doubts.empty()) fmt::print("\nThe result is doubtful if\n");
    for (const std::string& doubt : spec.doubts) fmt::print("  - {}\n", doubt);
}

struct ShowOptions {
    std::string filter;
    bool json = false, example = false;
};

int show(const ShowOptions& options) {
    const FilterLibrary library = open_library();
    const FilterSpec& spec = find_filter(library, options.filter);
    if (options.example && options.json)
        print_json({{"scanmill", 1}, {"filter", spec.name}, {"example", example_workflow(spec, library)}});
    else if (options.example)
        fmt::print("{}", example_workflow(spec, library));
    else if (options.json)
        print_json({{"scanmill", 1}, {"filter", declaration_json(spec)}});
    else
        print_filter(spec);
    return done;
}

}  // namespace

void add_list_and_show(CLI::App& app, Action& chosen) {
    auto [list_command, list_options] =
        add_command<ListOptions>(app, chosen, "list", "Lists the installed filters", list);
    list_command.add_flag("--json", list_options.json, "Print the declarations of the filters as JSON");
    list_command.add_flag("--names", list_options.names, "Print only the names, one per line")->excludes("--json");

    auto [show_command, show_options] = add_command<ShowOptions>(
        app, chosen, "show", "Shows the inputs, outputs, parameters and metrics of a filter", show);
    show_command.add_option("FILTER", show_options.filter, "The filter's name")->required();
    show_command.add_flag("--json", show_options.json, "Print the declaration as JSON");
    show_command.add_flag("--example", show_options.example,
                          "Print a workflow with this filter, every parameter at its default");
}

}  // namespace scanmill::runner
