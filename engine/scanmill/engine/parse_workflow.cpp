// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scanmill/engine/grammar.hpp"
#include "scanmill/engine/workflow.hpp"
#include "scanmill/filter/suggestion.hpp"

namespace scanmill {

namespace {

constexpr std::string_view grammar_version = "1";
constexpr std::string_view value_forms = "a value, a list of values, $name or {sweep: [value, …]}";
constexpr std::string_view step_forms = "a step, as `- decimate: {max-error: 0.1 %diag}`, or `- one-of: […]`";

class WorkflowParser {
public:
    explicit WorkflowParser(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

    Workflow workflow(const YamlNode& root);
    ValueExpression expression(const YamlNode& node);

private:
    void version(const YamlEntry* entry);
    void input(const YamlEntry& entry, Workflow& workflow);
    void input_details(const YamlNode& node, WorkflowInput& input);
    void input_kind(const YamlNode& node, WorkflowInput& input);
    void parameter(const YamlEntry& entry, Workflow& workflow);
    void output(const YamlEntry& entry, Workflow& workflow);
    std::vector<StepItem> steps(const YamlNode& list);
    void step_item(const YamlNode& node, std::vector<StepItem>& into);
    OneOfSyntax one_of(const YamlNode& node);
    AlternativeSyntax alternative(const YamlNode& node);
    StepSyntax step(const YamlNode& node);
    void parameters(const YamlNode& node, StepSyntax& step);
    void wiring(const YamlNode& node, StepSyntax& step);
    void expectations(const YamlNode& node, StepSyntax& step);
    std::optional<WrittenValue> value(const YamlNode& node);
    std::optional<Reference> reference(const YamlNode& node);

    template <class Action>
    void each_entry(const YamlEntry* entry, std::string_view expected, Action&& action) {
        if (!entry || entry->value.is_null() || !require_map(entry->value, expected, diagnostics_)) return;
        for (const YamlEntry& child : entry->value.entries) action(child);
    }

    Diagnostics& diagnostics_;
};

Workflow WorkflowParser::workflow(const YamlNode& root) {
    Workflow workflow;
    workflow.file = diagnostics_.file();
    if (root.is_null() && diagnostics_.has_errors()) return workflow;
    if (!require_map(root, "a workflow: a map that begins with `scanmill: 1`", diagnostics_)) return workflow;
    MapReader keys(root, "a workflow", diagnostics_);
    version(keys.find("scanmill"));
    workflow.name = keys.text("name");
    if (const YamlNode* name = root.find("name"); name && name->is_scalar())
        require_name(workflow.name, name->position, "a workflow", diagnostics_);
    workflow.summary = keys.text("summary");
    each_entry(keys.find("inputs"), "a map of inputs, as {scan: points}",
               [&](const YamlEntry& entry) { input(entry, workflow); });
    each_entry(keys.find("parameters"), "a map of parameters, as {max-error: 0.1 %diag}",
               [&](const YamlEntry& entry) { parameter(entry, workflow); });
    if (const YamlEntry* entry = keys.find("steps"))
        workflow.steps = steps(entry->value);
    else
        diagnostics_.error(root.position, "has no steps; expected `steps:` with a list of steps");
    each_entry(keys.find("outputs"), "a map from file names to steps, as {\"{scan}.stl\": decimate}",
               [&](const YamlEntry& entry) { output(entry, workflow); });
    keys.complain_of_others();
    return workflow;
}

void WorkflowParser::version(const YamlEntry* entry) {
    if (!entry)
        diagnostics_.error({1, 1}, "does not say its grammar; expected `scanmill: 1` as the first line");
    else if (entry->value.text != grammar_version)
        diagnostics_.error(entry->value.position, fmt::format("the grammar is {}; this program reads grammar {}",
                                                              entry->value.described(), grammar_version));
}

void WorkflowParser::input(const YamlEntry& entry, Workflow& workflow) {
    WorkflowInput input;
    input.name = entry.key;
    input.position = entry.position;
    require_name(input.name, input.position, "an input", diagnostics_);
    const YamlNode* kind = &entry.value;
    if (entry.value.is_map()) {
        input_details(entry.value, input);
        kind = entry.value.find("kind");
    }
    if (kind)
        input_kind(*kind, input);
    else
        diagnostics_.error(entry.position,
                           fmt::format("the input '{}' has no kind; expected one of {}", input.name, kind_names()));
    workflow.inputs.push_back(std::move(input));
}

void WorkflowParser::input_details(const YamlNode& node, WorkflowInput& input) {
    MapReader keys(node, "an input", diagnostics_);
    keys.find("kind");
    input.help = keys.text("help");
    input.frame = keys.text("frame");
    if (const YamlEntry* list = keys.find("list")) {
        if (list->value.text != "true" && list->value.text != "false")
            diagnostics_.error(list->value.position,
                               fmt::format("found {}; expected true or false", list->value.described()));
        input.list = list->value.text == "true";
    }
    if (const YamlEntry* unit = keys.find("unit")) {
        const std::optional<LengthUnit> known = length_unit(unit->value.text);
        if (!known)
            diagnostics_.error(unit->value.position, fmt::format("{} is no unit; expected one of {}",
                                                                 unit->value.described(), length_unit_symbols()));
        input.unit = known.value_or(LengthUnit::unknown);
    }
    keys.complain_of_others();
}

void WorkflowParser::input_kind(const YamlNode& node, WorkflowInput& input) {
    const YamlNode* scalar = &node;
    if (node.is_sequence() && node.items.size() == 1) {  // `[points]`: a list of points
        input.list = true;
        scalar = &node.items.front();
    }
    const auto text = require_text(*scalar, fmt::format("a kind: {}", kind_names()), diagnostics_);
    if (!text) return;
    const std::optional<Kind> kind = kind_named(*text);
    if (!kind) {
        std::vector<std::string> kinds;
        for (int i = 0; i <= static_cast<int>(Kind::metrics); ++i) kinds.emplace_back(name_of(static_cast<Kind>(i)));
        diagnostics_.error(scalar->position, fmt::format("'{}' is no kind; expected one of {}{}", *text, kind_names(),
                                                         did_you_mean(*text, kinds)));
    } else if (*kind != Kind::points && *kind != Kind::mesh) {
        diagnostics_.error(
            scalar->position,
            fmt::format("an input of kind {} cannot be read from a file; expected points or mesh", *text));
    }
    input.kind = kind.value_or(Kind::points);
}

void WorkflowParser::parameter(const YamlEntry& entry, Workflow& workflow) {
    WorkflowParameter parameter;
    parameter.name = entry.key;
    parameter.position = entry.position;
    require_name(parameter.name, parameter.position, "a parameter", diagnostics_);
    const bool detailed = entry.value.is_map() && !entry.value.find("sweep");
    if (detailed) {
        MapReader keys(entry.value, "a workflow parameter", diagnostics_);
        parameter.help = keys.text("help");
        if (const YamlEntry* value = keys.find("default"))
            parameter.value = expression(value->value);
        else
            diagnostics_.error(entry.position, fmt::format("the parameter '{}' has no default", parameter.name));
        keys.complain_of_others();
    } else {
        parameter.value = expression(entry.value);
    }
    for (const WrittenValue& written : parameter.value.values)
        if (!written.reference.empty())
            diagnostics_.error(written.position, "a default cannot refer to another parameter; write the value");
    workflow.parameters.push_back(std::move(parameter));
}

void WorkflowParser::output(const YamlEntry& entry, Workflow& workflow) {
    if (const auto source = reference(entry.value)) workflow.outputs.push_back({entry.key, entry.position, *source});
}

std::vector<StepItem> WorkflowParser::steps(const YamlNode& list) {
    std::vector<StepItem> items;
    if (!require_list(list, "a list of steps, each beginning with `- `", diagnostics_)) return items;
    if (list.items.empty()) diagnostics_.error(list.position, "the list of steps is empty");
    for (const YamlNode& node : list.items) step_item(node, items);
    return items;
}

void WorkflowParser::step_item(const YamlNode& node, std::vector<StepItem>& into) {
    if (!require_map(node, step_forms, diagnostics_)) return;
    if (node.find("one-of"))
        into.push_back({one_of(node)});
    else
        into.push_back({step(node)});
}

OneOfSyntax WorkflowParser::one_of(const YamlNode& node) {
    OneOfSyntax one_of;
    one_of.position = node.position;
    MapReader keys(node, "a one-of step", diagnostics_);
    one_of.id = keys.text("id");
    if (!one_of.id.empty()) require_name(one_of.id, node.find("id")->position, "a step", diagnostics_);
    const YamlEntry* alternatives = keys.find("one-of");
    keys.complain_of_others();
    if (!require_list(alternatives->value, "a list of alternatives, each beginning with `- `", diagnostics_))
        return one_of;
    if (alternatives->value.items.empty()) diagnostics_.error(alternatives->position, "one-of has no alternatives");
    for (const YamlNode& item : alternatives->value.items) one_of.alternatives.push_back(alternative(item));
    return one_of;
}

AlternativeSyntax WorkflowParser::alternative(const YamlNode& node) {
    AlternativeSyntax result;
    result.position = node.position;
    if (node.is_sequence()) {
        result.steps = steps(node);
    } else if (node.find("steps")) {
        MapReader keys(node, "an alternative", diagnostics_);
        result.name = keys.text("name");
        if (!result.name.empty())
            require_name(result.name, node.find("name")->position, "an alternative", diagnostics_);
        result.steps = steps(keys.find("steps")->value);
        keys.complain_of_others();
    } else {
        step_item(node, result.steps);
    }
    if (!result.name.empty() || result.steps.empty()) return result;
    if (result.steps.size() > 1) {
        diagnostics_.error(result.position, "an alternative of several steps needs a name, as `{name: …, steps: […]}`");
        return result;
    }
    if (const auto* only = std::get_if<StepSyntax>(&result.steps.front().item))
        result.name = only->id.empty() ? only->filter : only->id;
    return result;
}

StepSyntax WorkflowParser::step(const YamlNode& node) {
    StepSyntax step;
    step.position = node.position;
    MapReader keys(node, "a step", diagnostics_);
    step.id = keys.text("id");
    if (!step.id.empty()) require_name(step.id, node.find("id")->position, "a step", diagnostics_);
    if (const YamlEntry* in = keys.find("in")) wiring(in->value, step);
    if (const YamlEntry* expect = keys.find("expect")) expectations(expect->value, step);
    static const std::set<std::string_view> reserved{"id", "in", "expect"};
    const YamlEntry* filter = nullptr;
    for (const YamlEntry& entry : node.entries) {
        if (reserved.contains(entry.key)) continue;
        if (filter) {
            diagnostics_.error(
                entry.position,
                fmt::format("a step has one filter; '{}' stands beside '{}'. A second step begins with `- `; "
                            "beside the filter a step takes id, in and expect",
                            entry.key, filter->key));
            continue;
        }
        filter = &entry;
    }
    if (!filter) {
        diagnostics_.error(node.position, fmt::format("a step without a filter; expected {}", step_forms));
        return step;
    }
    step.filter = filter->key;
    step.position = filter->position;
    parameters(filter->value, step);
    return step;
}

void WorkflowParser::parameters(const YamlNode& node, StepSyntax& step) {
    if (node.is_null()) return;
    if (!require_map(node, fmt::format("the parameters of {}, as {{name: value}}, or nothing", step.filter),
                     diagnostics_))
        return;
    for (const YamlEntry& entry : node.entries)
        step.parameters.push_back({entry.key, entry.position, expression(entry.value)});
}

ValueExpression WorkflowParser::expression(const YamlNode& node) {
    ValueExpression result;
    result.position = node.position;
    if (node.is_map()) {
        MapReader keys(node, "a value", diagnostics_);
        const YamlEntry* sweep = keys.find("sweep");
        keys.complain_of_others();
        if (!sweep || !require_list(sweep->value, "a list of values to sweep over", diagnostics_)) return result;
        result.sweep = true;
        for (const YamlNode& item : sweep->value.items)
            if (auto written = value(item)) result.values.push_back(std::move(*written));
        if (sweep->value.items.empty()) diagnostics_.error(sweep->position, "a sweep over no values");
    } else if (auto written = value(node)) {
        result.values.push_back(std::move(*written));
    }
    return result;
}

std::optional<WrittenValue> WorkflowParser::value(const YamlNode& node) {
    WrittenValue result;
    result.position = node.position;
    if (node.is_sequence()) {
        result.literal.list = true;
        for (const YamlNode& item : node.items) {
            const auto text = require_text(item, "a value", diagnostics_);
            if (!text) return std::nullopt;
            result.literal.items.push_back(*text);
        }
        return result;
    }
    const auto text = require_text(node, value_forms, diagnostics_);
    if (!text) return std::nullopt;
    if (text->starts_with("$$"))
        result.literal.items.push_back(text->substr(1));  // a text that begins with one $
    else if (text->starts_with('$'))
        result.reference = text->substr(1);
    else
        result.literal.items.push_back(*text);
    return result;
}

std::optional<Reference> WorkflowParser::reference(const YamlNode& node) {
    const auto text = require_text(node, "the name of a step or an input, or step.port", diagnostics_);
    if (!text) return std::nullopt;
    return Reference{*text, node.position};
}

void WorkflowParser::wiring(const YamlNode& node, StepSyntax& step) {
    if (node.is_scalar()) {
        step.in_shorthand = reference(node);
        return;
    }
    if (!require_map(node, "a map from ports to steps, as {points: scan}", diagnostics_)) return;
    for (const YamlEntry& entry : node.entries) {
        InputWiring wired{entry.key, entry.position, {}};
        if (entry.value.is_sequence()) {
            for (const YamlNode& item : entry.value.items)
                if (auto source = reference(item)) wired.sources.push_back(*source);
        } else if (auto source = reference(entry.value)) {
            wired.sources.push_back(*source);
        }
        step.in.push_back(std::move(wired));
    }
}

void WorkflowParser::expectations(const YamlNode& node, StepSyntax& step) {
    if (!require_map(node, "a map, as {closed: true, components: 1}", diagnostics_)) return;
    for (const YamlEntry& entry : node.entries) {
        Expectation expectation{entry.key, entry.position, Expectation::Relation::equal, {}, {}};
        if (entry.value.is_sequence()) {
            if (entry.value.items.size() != 2 || !entry.value.items[0].is_scalar() ||
                !entry.value.items[1].is_scalar()) {
                diagnostics_.error(entry.value.position, "a range has two ends, as [2, 4]");
                continue;
            }
            expectation.relation = Expectation::Relation::between;
            expectation.value = entry.value.items[0].text;
            expectation.high = entry.value.items[1].text;
        } else if (const auto text =
                       require_text(entry.value, "a value, `< value`, `> value` or [low, high]", diagnostics_)) {
            std::string_view rest = *text;
            if (rest.starts_with('<')) expectation.relation = Expectation::Relation::below;
            if (rest.starts_with('>')) expectation.relation = Expectation::Relation::above;
            if (expectation.relation != Expectation::Relation::equal) rest.remove_prefix(1);
            while (rest.starts_with(' ')) rest.remove_prefix(1);
            expectation.value = rest;
        } else {
            continue;
        }
        step.expect.push_back(std::move(expectation));
    }
}

}  // namespace

Workflow parse_workflow(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return WorkflowParser(diagnostics).workflow(root);
}

ValueExpression parse_value_expression(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    if (diagnostics.has_errors()) return {};
    return WorkflowParser(diagnostics).expression(root);
}

}  // namespace scanmill
