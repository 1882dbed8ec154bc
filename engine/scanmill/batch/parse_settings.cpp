// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/parse_settings.hpp"

#include "scanmill/engine/grammar.hpp"
#include "scanmill/engine/parse_value.hpp"

namespace scanmill {

Settings parse_settings(const YamlNode& node, Diagnostics& diagnostics) {
    Settings settings;
    if (!require_map(node, "a map of parameters, as {max-error: 0.1 %diag}", diagnostics)) return settings;
    for (const YamlEntry& entry : node.entries) {
        if (!require_name(entry.key, entry.position, "a parameter", diagnostics)) continue;
        ValueExpression value = value_expression(entry.value, diagnostics);
        std::erase_if(value.values, [&](const WrittenValue& written) {
            if (!written.uses.empty())
                diagnostics.error(written.uses.front().position,
                                  "a setting cannot refer to a parameter; write the value");
            return !written.uses.empty();
        });
        if (value.values.empty()) continue;  // and that is reported
        value.position = entry.position;
        settings.emplace(entry.key, std::move(value));
    }
    return settings;
}

}  // namespace scanmill
