// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "scanmill/base/text.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/workflow/grammar.hpp"
#include "scanmill/workflow/workflow.hpp"

namespace scanmill {

namespace {

constexpr std::string_view value_forms = "a value, a list of values, $name or {sweep: [value, …]}";
constexpr std::string_view step_forms = "a step, as `- FILTER: {PARAMETER: VALUE}`, or `- one-of: […]`";
constexpr std::string_view workflow_forms = "a workflow: a map that begins with `scanmill: 1`";

/// Adds one text, literal or `$name`; false after an error.
bool add_item(WrittenValue& value, const YamlNode& node, std::string_view forms, Diagnostics& diagnostics) {
    const auto text = require_text(node, forms, diagnostics);
    if (!text) return false;
    if (*text == "$") {
        diagnostics.error(node.position, "'$' is not the name of a parameter; expected $name, or $$ for the text '$'");
        return false;
    }
    std::string item = *text;
    if (text->starts_with("$$")) {
        item = text->substr(1);  // a literal text with one $
    } else if (text->starts_with('$')) {
        value.uses.push_back({text->substr(1), node.position, value.literal.items.size()});
        item.clear();
    }
    value.literal.items.push_back(std::move(item));
    return true;
}

std::optional<WrittenValue> written_value(const YamlNode& node, Diagnostics& diagnostics) {
    WrittenValue result;
    result.position = node.position;
    result.literal.list = node.is_sequence();
    bool is_whole = true;
    if (!node.is_sequence()) is_whole = add_item(result, node, value_forms, diagnostics);
    for (const YamlNode& item : node.items) is_whole &= add_item(result, item, "a value or $name", diagnostics);
    return is_whole ? std::optional(result) : std::nullopt;
}

/// "step", "step.port" or an input's name.
std::optional<Reference> reference(const YamlNode& node, Diagnostics& diagnostics) {
    const auto text = require_text(node, "the name of a step or an input, or step.port", diagnostics);
    if (!text) return std::nullopt;
    return Reference{*text, node.position};
}

void add_mentions(const YamlNode& node, std::set<std::string>& names) {
    if (node.is_scalar() && node.text.starts_with('$')) names.insert(node.text.substr(1));
    for (const YamlNode& item : node.items) add_mentions(item, names);
    for (const YamlEntry& entry : node.entries) add_mentions(entry.value, names);
}

class WorkflowParser {
public:
    explicit WorkflowParser(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

    Workflow workflow(const YamlNode& root) {
        Workflow workflow;
        workflow.file = diagnostics_.file();
        if (root.is_null()) {
            if (!diagnostics_.has_errors()) diagnostics_.error({}, "is empty; expected {}", workflow_forms);
            return workflow;
        }
        if (!require_map(root, workflow_forms, diagnostics_)) return workflow;
        if (const YamlNode* batch = root.find("batch")) {
            diagnostics_.error(batch->position, "is a batch; expected a workflow (`scanmill batch` runs batches)");
            return workflow;
        }
        read_mapping(root, "a workflow",
                     {grammar_version_key(diagnostics_),
                      {"name", name_into(workflow.name, "a workflow", diagnostics_)},
                      {"summary", text_into(workflow.summary, diagnostics_)},
                      {"inputs", each("a map of inputs, as {scan: points}",
                                      [&](const YamlEntry& entry) { workflow.inputs.push_back(input(entry)); })},
                      {"parameters", each("a map of parameters, as {max-error: 0.1 %diag}",
                                          [&](const YamlEntry& entry) { parameter(entry, workflow); })},
                      {"steps", [&](const YamlEntry& entry) { workflow.steps = steps(entry.value); },
                       "has no steps; expected `steps:` with a list of steps"},
                      {"outputs", each("a map from file names to steps, as {\"{scan}.stl\": STEP}",
                                       [&](const YamlEntry& entry) {
                                           if (const auto source = reference(entry.value, diagnostics_))
                                               workflow.outputs.push_back({entry.key, entry.position, *source});
                                       })}},
                     diagnostics_);
        for (const char* key : {"steps", "outputs"})
            if (const YamlNode* part = root.find(key)) add_mentions(*part, workflow.mentions);
        workflow.mentions.merge(expected_);
        return workflow;
    }

private:
    /// A reader that calls `read` for every entry of a mapping; the mapping may be empty.
    ReadEntry each(std::string_view expected, ReadEntry read) {
        return [this, expected, read](const YamlEntry& entry) {
            if (entry.value.is_null() || !require_map(entry.value, expected, diagnostics_)) return;
            for (const YamlEntry& child : entry.value.entries) read(child);
        };
    }

    WorkflowInput input(const YamlEntry& entry) {
        WorkflowInput input;
        input.name = entry.key;
        input.position = entry.position;
        require_name(input.name, input.position, "an input", diagnostics_);
        if (!entry.value.is_map()) {
            input_kind(entry.value, input);
            return input;
        }
        const auto list = [&](const YamlEntry& flag) {
            input.list |= flag.value.text == "true";
            if (flag.value.text != "true" && flag.value.text != "false")
                diagnostics_.error(flag.value.position, "found {}; expected true or false", flag.value.described());
        };
        const auto frame = [&](const YamlEntry& name) {
            text_into(input.frame, diagnostics_)(name);
            check_stem_template(input.frame, "the frame", name.value.position, diagnostics_);
        };
        std::optional<Position> rule;
        const auto invalid = [&](const YamlEntry& given) {
            invalid_into(input.invalid, diagnostics_)(given);
            rule = given.position;
        };
        read_mapping(entry.value, "an input",
                     {{"kind", [&](const YamlEntry& kind) { input_kind(kind.value, input); },
                       fmt::format("the input '{}' has no kind; expected one of {}", input.name, kind_names())},
                      {"help", text_into(input.help, diagnostics_)},
                      {"frame", frame},
                      {"invalid", invalid},
                      {"list", list},
                      {"unit", unit_into(input.unit, diagnostics_)}},
                     diagnostics_);
        if (rule && input.kind != kind_of<PointCloud>())
            diagnostics_.error(*rule, "`invalid` is for points; the input '{}' is of kind {}", input.name,
                               input.kind.name());
        return input;
    }

    void input_kind(const YamlNode& node, WorkflowInput& input) {
        const YamlNode* scalar = &node;
        if (node.is_sequence() && node.items.size() == 1) {  // `[points]`: a list of points
            input.list = true;
            scalar = &node.items.front();
        }
        const auto text = require_text(*scalar, fmt::format("a kind: {}", kind_names()), diagnostics_);
        if (!text) return;
        const std::optional<Kind> kind = kind_named(*text);
        input.kind = kind.value_or(kind_of<PointCloud>());
        const std::vector<std::string> readable = readable_kinds();
        std::vector<std::string> kinds;
        for (const Kind each : all_kinds()) kinds.emplace_back(each.name());
        if (!kind)
            diagnostics_.error(scalar->position, "'{}' is not a kind; expected one of {}{}", *text, kind_names(),
                               did_you_mean(*text, kinds));
        else if (std::ranges::find(readable, *text) == readable.end())
            diagnostics_.error(scalar->position, "an input of kind {} cannot be read from a file; expected one of {}",
                               *text, fmt::join(readable, ", "));
    }

    void parameter(const YamlEntry& entry, Workflow& workflow) {
        WorkflowParameter parameter;
        parameter.name = entry.key;
        parameter.position = entry.position;
        require_name(parameter.name, parameter.position, "a parameter", diagnostics_);
        const auto value = [&](const YamlEntry& given) {
            parameter.value = value_expression(given.value, diagnostics_);
            add_mentions(given.value, workflow.mentions);
        };
        if (entry.value.is_map() && !entry.value.find("sweep"))
            read_mapping(entry.value, "a workflow parameter",
                         {{"default", value, fmt::format("the parameter '{}' has no default", parameter.name)},
                          {"help", text_into(parameter.help, diagnostics_)}},
                         diagnostics_);
        else
            value(entry);
        refuse_uses(parameter.value, "a default", diagnostics_);
        workflow.parameters.push_back(std::move(parameter));
    }

    /// A step without a filter, in place of a step that could not be read. Planning does not report it again.
    static StepItem unreadable(const YamlNode& node) {
        StepSyntax step;
        step.position = node.position;
        return {step};
    }

    std::vector<StepItem> steps(const YamlNode& list) {
        if (!require_list(list, "a list of steps, each beginning with `- `", diagnostics_)) return {unreadable(list)};
        if (list.items.empty()) {
            diagnostics_.error(list.position, "the list of steps is empty");
            return {unreadable(list)};
        }
        std::vector<StepItem> items;
        for (const YamlNode& node : list.items) items.push_back(step_item(node));
        return items;
    }

    StepItem step_item(const YamlNode& node) {
        if (!require_map(node, step_forms, diagnostics_)) return unreadable(node);
        if (node.find("one-of")) return {one_of(node)};
        return {step(node)};
    }

    OneOfSyntax one_of(const YamlNode& node) {
        OneOfSyntax fork;
        fork.position = node.position;
        const auto alternatives = [&](const YamlEntry& entry) {
            const YamlNode& list = entry.value;
            if (require_list(list, "a list of alternatives, each beginning with `- `", diagnostics_) &&
                list.items.empty())
                diagnostics_.error(entry.position, "one-of has no alternatives");
            for (const YamlNode& item : list.items) fork.alternatives.push_back(alternative(item));
            if (list.items.empty()) fork.alternatives.push_back({"", list.position, {unreadable(list)}});
        };
        read_mapping(node, "a one-of step",
                     {{"id", name_into(fork.id, "a step", diagnostics_)}, {"one-of", alternatives}}, diagnostics_);
        return fork;
    }

    AlternativeSyntax alternative(const YamlNode& node) {
        AlternativeSyntax result;
        result.position = node.position;
        if (node.is_sequence())
            result.steps = steps(node);
        else if (node.find("steps"))
            read_mapping(node, "an alternative",
                         {{"name", name_into(result.name, "an alternative", diagnostics_)},
                          {"steps", [&](const YamlEntry& entry) { result.steps = steps(entry.value); }}},
                         diagnostics_);
        else
            result.steps.push_back(step_item(node));
        if (!result.name.empty()) return result;
        const auto* first = std::get_if<StepSyntax>(&result.steps.front().item);
        if (result.steps.size() > 1)
            diagnostics_.error(result.position,
                               "an alternative of several steps needs a name, as `{name: …, steps: […]}`");
        else if (!first)
            return result;  // the alternatives of the nested one-of have names
        else
            result.name = first->name();
        if (result.name.empty())  // after an error; a unique name avoids a second error about equal variants
            result.name = fmt::format("line-{}-column-{}", result.position.line, result.position.column);
        return result;
    }

    StepSyntax step(const YamlNode& node) {
        StepSyntax step;
        step.position = node.position;
        const YamlEntry* filter = nullptr;
        for (const YamlEntry& entry : node.entries) {
            if (entry.key == "id")
                name_into(step.id, "a step", diagnostics_)(entry);
            else if (entry.key == "in")
                wiring(entry.value, step);
            else if (entry.key == "expect")
                expectations(entry.value, step);
            else if (!filter)
                filter = &entry;
            else
                diagnostics_.error(entry.position,
                                   "a step has one filter; found '{}' beside '{}'. A second step begins "
                                   "with `- `; the other keys of a step are id, in and expect",
                                   entry.key, filter->key);
        }
        if (!filter) {
            diagnostics_.error(node.position, "the step has no filter; expected {}", step_forms);
            return step;
        }
        step.filter = filter->key;
        step.position = filter->position;
        each(fmt::format("the parameters of {}, as {{name: value}}, or nothing", step.filter),
             [&](const YamlEntry& entry) {
                 step.parameters.push_back({entry.key, entry.position, value_expression(entry.value, diagnostics_)});
             })(*filter);
        return step;
    }

    void wiring(const YamlNode& node, StepSyntax& step) {
        if (node.is_scalar()) {
            step.in_shorthand = reference(node, diagnostics_);
            return;
        }
        if (!require_map(node, "a map from ports to steps, as {points: scan}", diagnostics_)) return;
        for (const YamlEntry& entry : node.entries) {
            InputWiring wired{entry.key, entry.position, {}};
            const YamlNode& value = entry.value;
            for (const YamlNode& item : value.is_sequence() ? std::span(value.items) : std::span(&value, 1))
                if (auto source = reference(item, diagnostics_)) wired.sources.push_back(*source);
            step.in.push_back(std::move(wired));
        }
    }

    /// Reads "< 3", "> 3" and "3"; false after an error.
    bool read_comparison(std::string_view text, Position position, Expectation& expectation) {
        for (std::string_view other : {"<=", ">=", "==", "!=", "=", "≤", "≥", "≠"})
            if (text.starts_with(other)) {
                diagnostics_.error(position,
                                   "expect {}: '{}' is not supported; expected a value, `< value`, "
                                   "`> value`, or [low, high], which includes both ends",
                                   expectation.name, other);
                return false;
            }
        if (text.starts_with('<')) expectation.relation = Expectation::Relation::below;
        if (text.starts_with('>')) expectation.relation = Expectation::Relation::above;
        if (expectation.relation != Expectation::Relation::equal) text.remove_prefix(1);
        while (text.starts_with(' ')) text.remove_prefix(1);
        return read_end(text, position, 0, expectation);
    }

    /// Reads an end of a condition, a literal or `$name`; false after an error.
    bool read_end(std::string_view text, Position position, std::size_t item, Expectation& expectation) {
        std::string& end = item == 0 ? expectation.value : expectation.high;
        if (text == "$") {
            diagnostics_.error(position,
                               "expect {}: '$' is not the name of a parameter; expected $name, or $$ for the text '$'",
                               expectation.name);
            return false;
        }
        if (text.starts_with("$$")) {
            end = text.substr(1);
        } else if (text.starts_with('$')) {
            expectation.uses.push_back({std::string(text.substr(1)), position, item});
            expected_.insert(expectation.uses.back().name);
        } else {
            end = text;
        }
        return true;
    }

    void expectations(const YamlNode& node, StepSyntax& step) {
        if (!require_map(node, "a map, as {closed: true, components: 1}", diagnostics_)) return;
        for (const YamlEntry& entry : node.entries) {
            Expectation expectation{entry.key, entry.position, Expectation::Relation::equal, {}, {}};
            const std::vector<YamlNode>& ends = entry.value.items;
            if (!entry.value.is_sequence()) {
                const auto text =
                    require_text(entry.value, "a value, `< value`, `> value` or [low, high]", diagnostics_);
                if (!text || !read_comparison(*text, entry.value.position, expectation)) continue;
            } else if (ends.size() == 2 && ends[0].is_scalar() && ends[1].is_scalar()) {
                expectation.relation = Expectation::Relation::between;
                if (!read_end(ends[0].text, ends[0].position, 0, expectation) ||
                    !read_end(ends[1].text, ends[1].position, 1, expectation))
                    continue;
            } else {
                diagnostics_.error(entry.value.position, "a range has two ends, as [2, 4]");
                continue;
            }
            step.expect.push_back(std::move(expectation));
        }
    }

    Diagnostics& diagnostics_;
    std::set<std::string> expected_;  // names used as `$name` in `expect`
};

}  // namespace

ValueExpression value_expression(const YamlNode& node, Diagnostics& diagnostics) {
    ValueExpression result;
    result.position = node.position;
    const auto add = [&](const YamlNode& value) {
        if (auto written = written_value(value, diagnostics)) result.values.push_back(std::move(*written));
    };
    const auto sweep = [&](const YamlEntry& entry) {
        if (!require_list(entry.value, "a list of values to sweep over", diagnostics)) return;
        result.sweep = true;
        for (const YamlNode& item : entry.value.items) add(item);
        if (entry.value.items.empty()) diagnostics.error(entry.position, "the sweep has no values");
    };
    if (node.is_map())
        read_mapping(node, "a value", {{"sweep", sweep}}, diagnostics);
    else
        add(node);
    return result;
}

ValueExpression parse_value_expression(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return diagnostics.has_errors() ? ValueExpression{} : value_expression(root, diagnostics);
}

void refuse_uses(ValueExpression& value, std::string_view what, Diagnostics& diagnostics) {
    std::erase_if(value.values, [&](const WrittenValue& written) {
        if (!written.uses.empty())
            diagnostics.error(written.uses.front().position, "{} cannot refer to a parameter; write the value", what);
        return !written.uses.empty();
    });
}

Workflow parse_workflow(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    return WorkflowParser(diagnostics).workflow(root);
}

}  // namespace scanmill
