// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/parse_value.hpp"

#include "scanmill/workflow/grammar.hpp"

namespace scanmill {

namespace {

constexpr std::string_view value_forms = "a value, a list of values, $name or {sweep: [value, …]}";

/// Adds one text, as it stands or as `$name`; false when it cannot be read, which is reported.
bool add_item(WrittenValue& value, const YamlNode& node, std::string_view forms, Diagnostics& diagnostics) {
    const auto text = require_text(node, forms, diagnostics);
    if (!text) return false;
    if (*text == "$") {
        diagnostics.error(node.position, "'$' names no parameter; expected $name, or $$ for the text '$'");
        return false;
    }
    std::string item = *text;
    if (text->starts_with("$$")) {
        item = text->substr(1);  // a text that begins with one $
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
    if (!node.is_sequence())
        return add_item(result, node, value_forms, diagnostics) ? std::optional(result) : std::nullopt;
    bool is_whole = true;
    for (const YamlNode& item : node.items)
        if (!add_item(result, item, "a value or $name", diagnostics)) is_whole = false;
    return is_whole ? std::optional(result) : std::nullopt;
}

}  // namespace

ValueExpression value_expression(const YamlNode& node, Diagnostics& diagnostics) {
    ValueExpression result;
    result.position = node.position;
    if (node.is_map()) {
        MapReader keys(node, "a value", diagnostics);
        const YamlEntry* sweep = keys.find("sweep");
        keys.complain_of_others();
        if (!sweep || !require_list(sweep->value, "a list of values to sweep over", diagnostics)) return result;
        result.sweep = true;
        for (const YamlNode& item : sweep->value.items)
            if (auto written = written_value(item, diagnostics)) result.values.push_back(std::move(*written));
        if (sweep->value.items.empty()) diagnostics.error(sweep->position, "a sweep over no values");
    } else if (auto written = written_value(node, diagnostics)) {
        result.values.push_back(std::move(*written));
    }
    return result;
}

std::optional<Reference> reference(const YamlNode& node, Diagnostics& diagnostics) {
    const auto text = require_text(node, "the name of a step or an input, or step.port", diagnostics);
    if (!text) return std::nullopt;
    return Reference{*text, node.position};
}

ValueExpression parse_value_expression(const std::string& text, Diagnostics& diagnostics) {
    const YamlNode root = parse_yaml(text, diagnostics);
    if (diagnostics.has_errors()) return {};
    return value_expression(root, diagnostics);
}

}  // namespace scanmill
