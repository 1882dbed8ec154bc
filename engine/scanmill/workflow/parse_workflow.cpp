// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <set>

#include "scanmill/base/text.hpp"
#include "scanmill/workflow/grammar.hpp"
#include "scanmill/workflow/parse_steps.hpp"
#include "scanmill/workflow/parse_value.hpp"
#include "scanmill/workflow/workflow.hpp"

namespace scanmill {

namespace {

constexpr std::string_view step_forms = "a step, as `- decimate: {max-error: 0.1 %diag}`, or `- one-of: […]`";

class StepParser {
public:
    explicit StepParser(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

    std::vector<StepItem> steps(const YamlNode& list);

private:
    StepItem step_item(const YamlNode& node);
    OneOfSyntax one_of(const YamlNode& node);
    AlternativeSyntax alternative(const YamlNode& node);
    StepSyntax step(const YamlNode& node);
    void parameters(const YamlNode& node, StepSyntax& step);
    void wiring(const YamlNode& node, StepSyntax& step);
    void expectations(const YamlNode& node, StepSyntax& step);

    static StepItem unreadable(const YamlNode& node) {
        StepSyntax step;
        step.position = node.position;
        return {step};
    }

    Diagnostics& diagnostics_;
};

std::vector<StepItem> StepParser::steps(const YamlNode& list) {
    if (!require_list(list, "a list of steps, each beginning with `- `", diagnostics_)) return {unreadable(list)};
    if (list.items.empty()) {
        diagnostics_.error(list.position, "the list of steps is empty");
        return {unreadable(list)};
    }
    std::vector<StepItem> items;
    for (const YamlNode& node : list.items) items.push_back(step_item(node));
    return items;
}

StepItem StepParser::step_item(const YamlNode& node) {
    if (!require_map(node, step_forms, diagnostics_)) return unreadable(node);
    if (node.find("one-of")) return {one_of(node)};
    return {step(node)};
}

OneOfSyntax StepParser::one_of(const YamlNode& node) {
    OneOfSyntax one_of;
    one_of.position = node.position;
    MapReader keys(node, "a one-of step", diagnostics_);
    one_of.id = keys.text("id");
    if (!one_of.id.empty()) require_name(one_of.id, node.find("id")->position, "a step", diagnostics_);
    const YamlEntry* alternatives = keys.find("one-of");
    keys.complain_of_others();
    const YamlNode& list = alternatives->value;
    if (require_list(list, "a list of alternatives, each beginning with `- `", diagnostics_) && list.items.empty())
        diagnostics_.error(alternatives->position, "one-of has no alternatives");
    for (const YamlNode& item : list.items) one_of.alternatives.push_back(alternative(item));
    if (list.items.empty()) one_of.alternatives.push_back({"", list.position, {unreadable(list)}});
    return one_of;
}

AlternativeSyntax StepParser::alternative(const YamlNode& node) {
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
        result.steps.push_back(step_item(node));
    }
    if (!result.name.empty()) return result;
    const auto* first = std::get_if<StepSyntax>(&result.steps.front().item);
    if (result.steps.size() > 1)
        diagnostics_.error(result.position, "an alternative of several steps needs a name, as `{name: …, steps: […]}`");
    else if (!first)
        return result;  // a fork names its own alternatives
    else
        result.name = first->id.empty() ? first->filter : first->id;
    if (result.name.empty())  // reported; a name of its own keeps its variant apart from others
        result.name = fmt::format("line-{}-column-{}", result.position.line, result.position.column);
    return result;
}

StepSyntax StepParser::step(const YamlNode& node) {
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

void StepParser::parameters(const YamlNode& node, StepSyntax& step) {
    if (node.is_null()) return;
    if (!require_map(node, fmt::format("the parameters of {}, as {{name: value}}, or nothing", step.filter),
                     diagnostics_))
        return;
    for (const YamlEntry& entry : node.entries)
        step.parameters.push_back({entry.key, entry.position, value_expression(entry.value, diagnostics_)});
}

void StepParser::wiring(const YamlNode& node, StepSyntax& step) {
    if (node.is_scalar()) {
        step.in_shorthand = reference(node, diagnostics_);
        return;
    }
    if (!require_map(node, "a map from ports to steps, as {points: scan}", diagnostics_)) return;
    for (const YamlEntry& entry : node.entries) {
        InputWiring wired{entry.key, entry.position, {}};
        if (entry.value.is_sequence()) {
            for (const YamlNode& item : entry.value.items)
                if (auto source = reference(item, diagnostics_)) wired.sources.push_back(*source);
        } else if (auto source = reference(entry.value, diagnostics_)) {
            wired.sources.push_back(*source);
        }
        step.in.push_back(std::move(wired));
    }
}

/// Reads "< 3", "> 3" and "3"; false for a comparison that there is not, which is reported.
bool read_comparison(std::string_view text, Position position, Expectation& expectation, Diagnostics& diagnostics) {
    for (std::string_view other : {"<=", ">=", "==", "!=", "=", "≤", "≥", "≠"})
        if (text.starts_with(other)) {
            diagnostics.error(
                position, fmt::format("expect {}: '{}' is no comparison; expected a value, `< value`, `> value`, or "
                                      "[low, high], both of which count",
                                      expectation.name, other));
            return false;
        }
    if (text.starts_with('<')) expectation.relation = Expectation::Relation::below;
    if (text.starts_with('>')) expectation.relation = Expectation::Relation::above;
    if (expectation.relation != Expectation::Relation::equal) text.remove_prefix(1);
    while (text.starts_with(' ')) text.remove_prefix(1);
    expectation.value = text;
    return true;
}

void StepParser::expectations(const YamlNode& node, StepSyntax& step) {
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
        } else {
            const auto text = require_text(entry.value, "a value, `< value`, `> value` or [low, high]", diagnostics_);
            if (!text || !read_comparison(*text, entry.value.position, expectation, diagnostics_)) continue;
        }
        step.expect.push_back(std::move(expectation));
    }
}

}  // namespace

std::vector<StepItem> parse_steps(const YamlNode& list, Diagnostics& diagnostics) {
    return StepParser(diagnostics).steps(list);
}

namespace {

void add_mentions(const YamlNode& node, std::set<std::string>& names) {
    if (node.is_scalar() && node.text.starts_with('$')) names.insert(node.text.substr(1));
    for (const YamlNode& item : node.items) add_mentions(item, names);
    for (const YamlEntry& entry : node.entries) add_mentions(entry.value, names);
}

class WorkflowParser {
public:
    explicit WorkflowParser(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

    Workflow workflow(const YamlNode& root);

private:
    void input(const YamlEntry& entry, Workflow& workflow);
    void input_details(const YamlNode& node, WorkflowInput& input);
    void input_kind(const YamlNode& node, WorkflowInput& input);
    void parameter(const YamlEntry& entry, Workflow& workflow);
    void output(const YamlEntry& entry, Workflow& workflow);

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
    if (root.is_null()) {
        if (!diagnostics_.has_errors())
            diagnostics_.error({}, "is empty; expected a workflow: a map that begins with `scanmill: 1`");
        return workflow;
    }
    if (!require_map(root, "a workflow: a map that begins with `scanmill: 1`", diagnostics_)) return workflow;
    if (const YamlNode* batch = root.find("batch")) {
        diagnostics_.error(batch->position, "is a batch; expected a workflow (`scanmill batch` runs batches)");
        return workflow;
    }
    MapReader keys(root, "a workflow", diagnostics_);
    require_grammar_version(keys, diagnostics_);
    workflow.name = keys.text("name");
    if (const YamlNode* name = root.find("name"); name && name->is_scalar())
        require_name(workflow.name, name->position, "a workflow", diagnostics_);
    workflow.summary = keys.text("summary");
    each_entry(keys.find("inputs"), "a map of inputs, as {scan: points}",
               [&](const YamlEntry& entry) { input(entry, workflow); });
    each_entry(keys.find("parameters"), "a map of parameters, as {max-error: 0.1 %diag}", [&](const YamlEntry& entry) {
        parameter(entry, workflow);
        const YamlNode* value = entry.value.is_map() ? entry.value.find("default") : &entry.value;
        if (value) add_mentions(*value, workflow.mentions);
    });
    if (const YamlEntry* entry = keys.find("steps"))
        workflow.steps = parse_steps(entry->value, diagnostics_);
    else
        diagnostics_.error(root.position, "has no steps; expected `steps:` with a list of steps");
    each_entry(keys.find("outputs"), "a map from file names to steps, as {\"{scan}.stl\": decimate}",
               [&](const YamlEntry& entry) { output(entry, workflow); });
    keys.complain_of_others();
    for (const char* key : {"steps", "outputs"})
        if (const YamlNode* part = root.find(key)) add_mentions(*part, workflow.mentions);
    return workflow;
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
    if (const YamlNode* frame = node.find("frame")) check_frame_template(input.frame, frame->position, diagnostics_);
    if (const YamlEntry* list = keys.find("list")) {
        if (list->value.text != "true" && list->value.text != "false")
            diagnostics_.error(list->value.position,
                               fmt::format("found {}; expected true or false", list->value.described()));
        input.list = list->value.text == "true";
    }
    if (const YamlEntry* unit = keys.find("unit")) input.unit = require_unit(unit->value, diagnostics_);
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
        for (const Kind each : all_kinds()) kinds.emplace_back(each.name());
        diagnostics_.error(scalar->position, fmt::format("'{}' is no kind; expected one of {}{}", *text, kind_names(),
                                                         did_you_mean(*text, kinds)));
    } else if (*kind != kind_of<PointCloud>() && *kind != kind_of<TriangleMesh>() && !kind->has_json()) {
        std::string readable = "points, mesh";
        for (const Kind each : all_kinds())
            if (each.has_json()) readable.append(", ").append(each.name());
        diagnostics_.error(
            scalar->position,
            fmt::format("an input of kind {} cannot be read from a file; expected one of {}", *text, readable));
    }
    input.kind = kind.value_or(kind_of<PointCloud>());
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
            parameter.value = value_expression(value->value, diagnostics_);
        else
            diagnostics_.error(entry.position, fmt::format("the parameter '{}' has no default", parameter.name));
        keys.complain_of_others();
    } else {
        parameter.value = value_expression(entry.value, diagnostics_);
    }
    std::erase_if(parameter.value.values, [&](const WrittenValue& written) {
        if (!written.uses.empty())
            diagnostics_.error(written.uses.front().position,
                               "a default cannot refer to another parameter; write the value");
        return !written.uses.empty();
    });
    workflow.parameters.push_back(std::move(parameter));
}

void WorkflowParser::output(const YamlEntry& entry, Workflow& workflow) {
    if (const auto source = reference(entry.value, diagnostics_))
        workflow.outputs.push_back({entry.key, entry.position, *source});
}

}  // namespace

Workflow parse_workflow(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return WorkflowParser(diagnostics).workflow(root);
}

}  // namespace scanmill
