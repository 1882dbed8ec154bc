// SPDX-License-Identifier: GPL-3.0-or-later
#include "commands/load.hpp"
#include "output/stderr_text.hpp"

#include <fmt/format.h>

#include <cstdio>

#include "scanmill/base/error.hpp"
#include "scanmill/plugin/module.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill::runner {

FilterLibrary open_library() {
    std::vector<std::string> ignored;
    FilterLibrary library(plugin_folders(&ignored));
    for (const std::string& folder : ignored)
        tell("warning: SCANMILL_PLUGIN_PATH: '{}' is passed over; only absolute folders are searched\n", folder);
    return library;
}

std::string workflow_file(const std::string& file_or_name) {
    namespace fs = std::filesystem;
    std::error_code ignored;
    if (fs::exists(file_or_name, ignored) || file_or_name.find_first_of("/.") != std::string::npos) return file_or_name;
    const fs::path library = core_library_file().parent_path();
    for (const fs::path& prefix : {library.parent_path(), library.parent_path().parent_path()}) {
        const fs::path shipped = prefix / "share/scanmill/workflows" / (file_or_name + ".yaml");
        if (fs::exists(shipped, ignored)) return shipped.string();
    }
    return file_or_name;
}

CheckedWorkflow check_workflow(const std::string& file, const FilterLibrary& library, const Settings& settings) {
    return check_workflow(file, read_workflow_file(file), library, settings);
}

CheckedWorkflow check_workflow(const std::string& file, const std::string& text, const FilterLibrary& library,
                               const Settings& settings) {
    Diagnostics diagnostics(file);
    Workflow workflow = parse_workflow(text, diagnostics);
    Plan plan = make_plan(std::move(workflow), library, settings, diagnostics);
    return {std::move(diagnostics), std::move(plan)};
}

Settings parse_settings(const std::vector<std::string>& pairs) {
    Settings settings;
    for (const std::string& pair : pairs) {
        const std::size_t equals = pair.find('=');
        if (equals == 0 || equals == std::string::npos) throw Error("--set {}: expected NAME=VALUE", pair);
        Diagnostics diagnostics("--set " + pair);
        ValueExpression value = parse_value_expression(pair.substr(equals + 1), diagnostics);
        if (value.values.empty() && !diagnostics.has_errors()) diagnostics.error({}, "has no value");
        for (const WrittenValue& written : value.values)
            if (!written.uses.empty()) diagnostics.error({}, "cannot refer to another parameter");
        if (diagnostics.has_errors()) throw Error("--set {}: {}", pair, diagnostics.sorted().front().message);
        if (!settings.emplace(pair.substr(0, equals), std::move(value)).second)
            throw Error("--set {} is given twice", pair.substr(0, equals));
    }
    return settings;
}

LengthUnit parse_unit(const std::string& symbol) {
    if (symbol.empty()) return LengthUnit::unknown;
    const std::optional<LengthUnit> unit = length_unit(symbol);
    if (!unit) throw Error("'{}' is no unit; expected one of {}", symbol, length_unit_symbols());
    return *unit;
}

}  // namespace scanmill::runner
