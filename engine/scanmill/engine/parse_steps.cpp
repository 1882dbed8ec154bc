// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/parse_steps.hpp"

#include <fmt/format.h>

#include <set>

#include "scanmill/engine/grammar.hpp"
#include "scanmill/engine/parse_value.hpp"

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

}  // namespace scanmill
