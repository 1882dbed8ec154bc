// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/filter_page.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

namespace scanmill {

namespace {

constexpr std::string_view generated = "<!-- Written by `scanmill docs` from the filters' declarations. -->\n";

bool is_readable(Kind kind) { return kind == kind_of<PointCloud>() || kind == kind_of<TriangleMesh>(); }

/// A valid value, or a valid item of a list, for the example of a parameter without a default.
std::string sample_item(const ParameterSpec& parameter) {
    switch (parameter.type) {
        case ParameterType::boolean: return "true";
        case ParameterType::choice: return parameter.choices.front().name;
        case ParameterType::length: return "1 %diag";
        case ParameterType::angle: return "40 deg";
        case ParameterType::ratio: return "5 %";
        case ParameterType::text: return "text";
        case ParameterType::path: return "file";
        case ParameterType::integer:
        case ParameterType::number: break;
    }
    return number_text(parameter.low ? parameter.low->value + (parameter.low->inclusive ? 0 : 1) : 1);
}

std::string sample(const ParameterSpec& parameter) {
    const std::string item = sample_item(parameter);
    if (!parameter.list) return item;
    return fmt::format("[{}]", fmt::join(std::vector<std::string>(parameter.size.value_or(1), item), ", "));
}

/// Escapes the character |, which would end a cell of a table.
std::string cell(std::string_view text) {
    std::string escaped(text);
    for (std::size_t at = 0; (at = escaped.find('|', at)) != std::string::npos; at += 2) escaped.insert(at, 1, '\\');
    return escaped;
}

std::string code(std::string_view text) { return text.empty() ? "" : "`" + cell(text) + "`"; }

std::string ports_table(std::string_view title, std::string_view column, const std::vector<PortSpec>& ports) {
    if (ports.empty()) return {};
    std::string table = fmt::format("\n## {}\n\n| {} | kind | content |\n|---|---|---|\n", title, column);
    for (const PortSpec& port : ports)
        table +=
            fmt::format("| {} | {}{}{}{} | {} |\n", code(port.name), kinds_text(port), port.list ? ", any number" : "",
                        port.optional ? ", optional" : "", port.by_name ? ", by name alone" : "", cell(port.help));
    return table;
}

std::string parameters_table(const std::vector<ParameterSpec>& parameters) {
    if (parameters.empty()) return {};
    std::string table = "\n## Parameters\n\n| parameter | default | takes | meaning |\n|---|---|---|---|\n";
    for (const ParameterSpec& parameter : parameters) {
        std::string meaning = parameter.help;
        for (const Choice& choice : parameter.choices) meaning += fmt::format("<br>`{}`: {}", choice.name, choice.help);
        const std::string value = text(parameter.default_value);
        table += fmt::format("| {} | {} | {} | {} |\n", code(parameter.name),
                             parameter.required ? "required"
                             : value.empty()    ? "none"
                                                : code(value),
                             cell(expectation(parameter)), cell(meaning));
    }
    return table;
}

std::string metrics_table(const std::vector<MetricSpec>& metrics) {
    if (metrics.empty()) return {};
    std::string table = "\n## Metrics\n\n| metric | unit | meaning |\n|---|---|---|\n";
    for (const MetricSpec& metric : metrics) {
        std::string meaning = cell(metric.help);
        if (metric.better != Better::neither)
            meaning += fmt::format(" {} is better.", metric.better == Better::larger ? "Larger" : "Smaller");
        table += fmt::format("| {} | {} | {} |\n", code(metric.name) + (metric.numbered ? ", `…@2`" : ""),
                             name_of(metric.unit), meaning);
    }
    return table;
}

std::string remarks(const FilterSpec& spec) {
    std::string list;
    if (!spec.ties.empty()) list += fmt::format("- Ties: {}\n", spec.ties);
    if (!spec.not_finite.empty()) list += fmt::format("- NaN and infinity: {}\n", spec.not_finite);
    if (spec.streams) list += fmt::format("- Large scans: {}\n", stream_text(spec));
    if (spec.measures) list += fmt::format("- Measures: {}\n", measures_text(*spec.measures));
    if (spec.draws) list += fmt::format("- Draws: {}\n", draws_text(*spec.draws));
    if (spec.simplifies) list += fmt::format("- Simplifies: {}\n", simplifies_text(*spec.simplifies));
    if (!spec.adds.empty()) list += fmt::format("- Columns that it may add: `{}`\n", fmt::join(spec.adds, "`, `"));
    return "\n" + list;
}

/// "points, mesh": the kinds of the ports, without those that only `in` connects.
std::string kinds_of(const std::vector<PortSpec>& ports) {
    std::string text;
    for (const PortSpec& port : ports)
        text += fmt::format("{}{}{}", text.empty() ? "" : ", ", kinds_text(port), port.list ? " (a list)" : "");
    return text.empty() ? "nothing" : text;
}

/// The name as a link to the page that `link` names, with `{filter}` for the name and `{folder}` for the name with
/// underscores.
std::string linked(const std::string& name, std::string_view link) {
    std::string folder = name, page(link);
    std::ranges::replace(folder, '-', '_');
    for (const auto& [placeholder, text] : {std::pair("{filter}", name), std::pair("{folder}", folder)})
        if (const std::size_t at = page.find(placeholder); at != std::string::npos)
            page.replace(at, std::string_view(placeholder).size(), text);
    return fmt::format("[{}]({})", name, page);
}

std::string doubts_list(const FilterSpec& spec) {
    if (spec.doubts.empty()) return {};
    std::string list = "\n## Doubts\n\nThe result is doubtful if\n\n";
    for (std::size_t i = 0; i < spec.doubts.size(); ++i)
        list += fmt::format("- {}{}\n", spec.doubts[i], i + 1 < spec.doubts.size() ? ";" : ".");
    return list;
}

/// The first filter whose first output has this kind and whose required inputs can be read from files.
const FilterSpec* maker_of(Kind kind, const FilterLibrary& library) {
    for (const std::string& name : library.names()) {
        const FilterSpec* spec = library.find(name);
        const auto can_be_fed = [](const PortSpec& port) { return port.optional || is_readable(port.kind); };
        if (spec->outputs.front().kind == kind && std::ranges::all_of(spec->inputs, can_be_fed)) return spec;
    }
    return nullptr;
}

/// The step with all parameters if `whole`, and only with required parameters if not.
std::string example_step(const FilterSpec& spec, bool whole) {
    std::string step = fmt::format("  - {}:\n", spec.name);
    for (const ParameterSpec& parameter : spec.parameters) {
        const std::string value = text(parameter.default_value);
        if (!whole && !parameter.required) continue;
        const bool given = !value.empty() || parameter.required;
        step += fmt::format("      {}{}: {}\n", given ? "" : "# ", parameter.name,
                            value.empty() ? sample(parameter) : value);
    }
    return step;
}

/// Whether the step has `in:`. It has if a port takes several kinds.
bool has_wiring(const FilterSpec& spec) {
    return std::ranges::any_of(spec.inputs, [](const PortSpec& port) { return !port.also.empty(); });
}

/// `in:` for a filter with a port that only `in` can wire; empty for other filters. Every port takes the workflow input
/// that has the name of the port.
std::string example_wiring(const FilterSpec& spec) {
    if (!has_wiring(spec)) return {};
    std::string wiring;
    for (const PortSpec& port : spec.inputs)
        wiring += fmt::format("{}{}: {}", wiring.empty() ? "" : ", ", port.name, port.name);
    return fmt::format("    in: {{{}}}\n", wiring);
}

/// The steps of an example: the filter and the filters that make its inputs. `inputs` are the ports that read files.
struct ExampleSteps {
    std::vector<const FilterSpec*> steps;
    std::vector<const PortSpec*> inputs;
};

void add_step(ExampleSteps& example, const FilterSpec& spec, const FilterLibrary& library) {
    const bool is_last = example.steps.empty();
    example.steps.push_back(&spec);  // in reverse order
    for (const PortSpec& port : spec.inputs) {
        if (port.optional && port.by_name && !has_wiring(spec)) continue;
        if (is_readable(port.kind)) {
            if (is_last || !port.optional) example.inputs.push_back(&port);
            continue;
        }
        const FilterSpec* maker = port.maker.empty() ? maker_of(port.kind, library) : library.find(port.maker);
        if (maker && std::ranges::find(example.steps, maker) == example.steps.end()) add_step(example, *maker, library);
    }
}

}  // namespace

std::string example_workflow(const FilterSpec& spec, const FilterLibrary& library) {
    ExampleSteps chain;
    add_step(chain, spec, library);
    auto& [steps, inputs] = chain;
    std::ranges::reverse(steps);
    std::string example = fmt::format("scanmill: 1\nname: {}-example\n", spec.name);
    std::set<std::string_view> fed;
    if (!inputs.empty()) example += "inputs:\n";
    for (const PortSpec* port : inputs)
        if (fed.insert(port->name).second)
            example += fmt::format(
                "  {}: {}\n", port->name,
                port->list ? "[" + std::string(name_of(port->kind)) + "]" : std::string(name_of(port->kind)));
    example += "steps:\n";
    for (const FilterSpec* step : steps) example += example_step(*step, step == &spec) + example_wiring(*step);
    const Kind kind = spec.outputs.front().kind;
    if (is_readable(kind) || kind.has_json())
        example += fmt::format("outputs:\n  \"{{scan}}.{}\": {}\n", is_readable(kind) ? "ply" : "json", spec.name);
    return example;
}

std::string filter_reference(const FilterSpec& spec) {
    const std::string parts = ports_table("Takes", "port", spec.inputs) + ports_table("Gives", "port", spec.outputs) +
                              parameters_table(spec.parameters) + metrics_table(spec.metrics) + doubts_list(spec) +
                              "\n## Details\n" + remarks(spec);
    return parts + fmt::format("- Source: {}.\n- Version {}.\n", spec.source, spec.version);
}

std::string filter_page(const FilterSpec& spec, const FilterLibrary& library) {
    return fmt::format("# {}\n\n{}\n{}\n{}\n## Example\n\n```yaml\n{}```\n", spec.name, generated, spec.summary,
                       filter_reference(spec), example_workflow(spec, library));
}

std::string stream_text(const FilterSpec& spec) {
    const std::vector<std::string>& given = spec.streams->given;
    std::vector<std::string> unwired;
    for (const PortSpec& port : spec.inputs)
        if (port.optional) unwired.push_back("`" + port.name + "`");
    return fmt::format("{}{}, a scan that no other step needs whole is read in chunks and never completely in memory.",
                       given.empty() ? "As the first step" : fmt::format("With {} given", fmt::join(given, " and ")),
                       unwired.empty() ? "" : fmt::format(", without {}", fmt::join(unwired, " and ")));
}

std::string measures_text(const MeasureSpec& measures) {
    const std::string deviation = measures.deviation.empty()
                                      ? ""
                                      : fmt::format(" `{}` has the signed distance from the truth in the column `{}`.",
                                                    measures.deviation, measures.column);
    return fmt::format(
        "Compares the value at `{}` with the truth at `{}`; a batch applies the filter to the results of scans with a "
        "truth.{}",
        measures.value, measures.truth, deviation);
}

std::string draws_text(const DrawSpec& draws) {
    return fmt::format(
        "Without `in`, `{}` takes the last geometric value before the step. The step also runs if one of its inputs "
        "misses a "
        "condition of `expect`.",
        draws.value);
}

std::string simplifies_text(const SimplifySpec& simplifies) {
    return fmt::format(
        "Reduces the mesh at `{}` to the number of triangles in `{}`, within `{}`; reports show meshes reduced this "
        "way.",
        simplifies.value, simplifies.triangles, simplifies.max_error);
}

bool is_filter_page(std::string_view text) { return text.find(generated) != std::string_view::npos; }

std::string filter_table(const std::vector<FilterSpec>& specs, std::string_view link) {
    std::string table = "\n| filter | takes → gives | what it does |\n|---|---|---|\n";
    for (const FilterSpec& spec : specs)
        table += fmt::format("| {} | {} → {} | {} |\n", linked(spec.name, link), kinds_of(spec.inputs),
                             kinds_of(spec.outputs), cell(spec.summary));
    return table + "\n";
}

std::string doubt_table(const std::vector<FilterSpec>& specs, std::string_view link) {
    std::string table = "\n| filter | doubts its result if |\n|---|---|\n";
    for (const FilterSpec& spec : specs)
        if (!spec.doubts.empty())
            table += fmt::format("| {} | {} |\n", linked(spec.name, link),
                                 cell(fmt::format("{}", fmt::join(spec.doubts, "; or<br>"))));
    return table + "\n";
}

std::string filter_index(const std::vector<FilterSpec>& specs) {
    return fmt::format("# Filters\n\n{}{}", generated, filter_table(specs, "{filter}.md"));
}

}  // namespace scanmill
