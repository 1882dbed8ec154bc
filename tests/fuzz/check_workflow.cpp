// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>

#include "fuzz/targets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/plan/plan.hpp"
#include "support/declared_filters.hpp"

namespace scanmill::test {

namespace {

const FilterLibrary& declared_library() {
    static const FilterLibrary library = DeclaredFilters().library();
    return library;
}

void require_sound(const Diagnostics& diagnostics) {
    for (const Diagnostic& diagnostic : diagnostics.sorted()) {
        require_law(!diagnostic.message.empty(), "a finding without words");
        require_law(diagnostic.position.line >= 0 && diagnostic.position.column >= 0, "a finding at no place");
    }
}

/// What may be relied upon when a workflow has passed the check.
void require_sound(const Plan& plan) {
    require_law(!plan.variants.empty(), "a plan without variants");
    for (std::size_t step = 0; step < plan.steps.size(); ++step)
        for (const PlannedInput& input : plan.steps[step].inputs)
            for (const ValueSource& source : input.sources) {
                require_law(!source.step || *source.step < step, "a step before what it reads from");
                require_law(source.step || source.input < plan.workflow.inputs.size(), "a source that is no input");
                const PortSpec* port = plan.steps[step].spec.input(input.port);
                require_law(port && port->kind == kind_of(plan, source), "a value of another kind than its port");
            }
    for (const PlannedVariant& variant : plan.variants) {
        for (const std::size_t step : variant.steps) require_law(step < plan.steps.size(), "a step that is not there");
        for (const PlannedOutput& output : variant.outputs) {
            const std::string file = expand_template(output.file, {"scan", variant.name, plan.workflow.name, "folder"});
            require_law(!file.empty() && file.front() != '/' && !file.starts_with(".."), "an output elsewhere");
        }
    }
}

void plan_and_require(Workflow workflow, const Settings& settings, Diagnostics& diagnostics) {
    const Plan plan = make_plan(std::move(workflow), declared_library(), settings, diagnostics);
    require_sound(diagnostics);
    if (!diagnostics.has_errors()) require_sound(plan);
}

/// A parameter of every type takes `n`.
Workflow taking_n() {
    static const char* const text =
        "scanmill: 1\n"
        "inputs: {scan: points}\n"
        "parameters: {n: 1}\n"
        "steps:\n"
        "  - thin: {size: $n, count: $n, rule: $n, axis: $n}\n"
        "  - tetrahedralise:\n"
        "  - solid: {alpha: $n, coverage: $n, angle: $n}\n"
        "  - simplify: {max-error: $n, target: $n}\n"
        "outputs: {\"{scan}-{variant}.ply\": simplify}\n";
    Diagnostics none("taking-n.yaml");
    static const Workflow workflow = parse_workflow(text, none);
    return workflow;
}

/// What a parameter accepts reads back equal from what is shown of it.
void require_lasting(const ParameterSpec& parameter, const WrittenParameter& text) {
    ParameterValue value;
    try {
        value = parse(parameter, text);
    } catch (const Error&) {
        return;
    }
    require_law(parse(parameter, written(value)) == value, "the value of '" + parameter.name + "' reads back changed");
    require_law(!canonical_text(value).empty() || text.list || text.items.front().empty(), "a value without a text");
}

}  // namespace

bool check_workflow_text(std::string_view bytes) {
    Diagnostics diagnostics("workflow.yaml");
    Workflow workflow = parse_workflow(std::string(bytes), diagnostics);
    plan_and_require(std::move(workflow), {}, diagnostics);
    return !diagnostics.has_errors();
}

bool check_setting(std::string_view bytes) {
    Diagnostics diagnostics("--set");
    const ValueExpression value = parse_value_expression(std::string(bytes), diagnostics);
    require_sound(diagnostics);
    const auto refers = [](const WrittenValue& written) { return !written.uses.empty(); };
    if (diagnostics.has_errors() || value.values.empty() || std::ranges::any_of(value.values, refers)) return false;
    for (const std::string& filter : declared_library().names())
        for (const ParameterSpec& parameter : declared_library().find(filter)->parameters)
            for (const WrittenValue& written : value.values) require_lasting(parameter, written.literal);
    // No value fits every parameter at once; planning must only not fail on it.
    plan_and_require(taking_n(), {{"n", value}}, diagnostics);
    return true;
}

}  // namespace scanmill::test
