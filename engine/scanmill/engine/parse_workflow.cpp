// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "scanmill/engine/grammar.hpp"
#include "scanmill/engine/input_frame.hpp"
#include "scanmill/engine/parse_steps.hpp"
#include "scanmill/engine/parse_value.hpp"
#include "scanmill/engine/workflow.hpp"
#include "scanmill/filter/suggestion.hpp"

namespace scanmill {

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
