// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/wiring.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

template <class Items>
std::vector<std::string> names_of(const Items& items) {
    std::vector<std::string> names;
    for (const auto& item : items) names.push_back(item.name);
    return names;
}

/// "; filters that make mesh: alpha-solid and sculpt", or empty if no filter does.
std::string makers(const FilterLibrary& library, Kind kind) {
    std::vector<std::string> names;
    for (const std::string& name : library.names())
        if (library.find(name)->outputs.front().kind == kind) names.push_back("'" + name + "'");
    return names.empty() ? "" : "; filters that make " + std::string(name_of(kind)) + ": " + enumerated(names);
}

class Wiring {
public:
    Wiring(const StepSyntax& step, const FilterSpec& spec, const WiringScope& scope, Diagnostics& diagnostics)
        : step_(step),
          spec_(spec),
          scope_(scope),
          diagnostics_(diagnostics) {}

    std::vector<PlannedInput> all() {
        check_ports();
        std::vector<PlannedInput> inputs;
        for (const PortSpec& port : spec_.inputs) {
            std::vector<ValueSource> sources = is_given(port)   ? given(port)
                                               : is_drawn(port) ? last_drawable(port)
                                                                : nearest(port);
            if (!sources.empty()) inputs.push_back({port.name, std::move(sources)});
        }
        return inputs;
    }

private:
    void check_ports() {
        for (const InputWiring& wired : step_.in)
            if (!spec_.input(wired.port))
                diagnostics_.error(wired.position, "{} has no input port '{}'; {}", spec_.name, wired.port,
                                   it_has(spec_.inputs, wired.port));
        if (step_.in_shorthand && spec_.inputs.size() != 1)
            diagnostics_.error(step_.in_shorthand->position,
                               "`in:` with a single name is for filters with one input port; {}: {}. Expected "
                               "`in: {{port: {}}}`",
                               spec_.name, it_has(spec_.inputs, ""), step_.in_shorthand->text);
    }

    bool is_given(const PortSpec& port) const {
        return (step_.in_shorthand && spec_.inputs.size() == 1) ||
               std::ranges::find(step_.in, port.name, &InputWiring::port) != step_.in.end();
    }

    std::vector<ValueSource> given(const PortSpec& port) {
        std::vector<Reference> references;
        if (step_.in_shorthand)
            references.push_back(*step_.in_shorthand);
        else
            references = std::ranges::find(step_.in, port.name, &InputWiring::port)->sources;
        if (references.size() > 1 && !port.list)
            diagnostics_.error(references[1].position, "the port '{}' of {} takes one value; found {}", port.name,
                               spec_.name, references.size());
        std::vector<ValueSource> sources;
        for (const Reference& reference : references) {
            const auto source = resolve(reference, scope_, diagnostics_);
            if (source && fits(port, *source, reference)) sources.push_back(*source);
        }
        return sources;
    }

    bool fits(const PortSpec& port, const ValueSource& source, const Reference& reference) {
        const Kind kind = kind_of(scope_.plan, source);
        if (!port.takes(kind)) {
            diagnostics_.error(reference.position, "'{}' is {}; the port '{}' of {} takes {}{}", reference.text,
                               name_of(kind), port.name, spec_.name, kinds_text(port),
                               makers(scope_.library, port.kind));
            return false;
        }
        if (!source.step && scope_.plan.workflow.inputs[source.input].list && !port.list) {
            diagnostics_.error(reference.position, "'{}' is a list of {}; the port '{}' of {} takes one",
                               reference.text, name_of(kind), port.name, spec_.name);
            return false;
        }
        return true;
    }

    bool is_drawn(const PortSpec& port) const { return spec_.draws && spec_.draws->value == port.name; }

    /// The last geometric value before the step that the port takes. Other outputs than the first of a step, and values
    /// that feed only ports that name them, do not count.
    std::vector<ValueSource> last_drawable(const PortSpec& port) {
        const auto is_drawable = [&](Kind kind) { return is_geometric(kind) && port.takes(kind); };
        for (auto step = scope_.earlier.rbegin(); step != scope_.earlier.rend(); ++step) {
            const PortSpec& output = scope_.plan.steps[*step].spec.outputs.front();
            if (is_drawable(output.kind) && !output.by_name) return {{*step, 0, output.name}};
        }
        const std::vector<WorkflowInput>& inputs = scope_.plan.workflow.inputs;
        const auto input = std::ranges::find_if(
            inputs, [&](const WorkflowInput& each) { return is_drawable(each.kind) && !each.by_name && !each.list; });
        if (input != inputs.end()) return {{std::nullopt, static_cast<std::size_t>(input - inputs.begin()), ""}};
        if (!scope_.uncertain)
            diagnostics_.error(step_.position,
                               "{} draws {}, and neither an earlier step nor an input gives any; expected a step that "
                               "does, or `in: {{{}: …}}`",
                               spec_.name, kinds_text(port), port.name);
        return {};
    }

    std::vector<ValueSource> nearest(const PortSpec& port) {
        if (!port.also.empty() || port.by_name) {
            if (!port.optional)
                diagnostics_.error(step_.position,
                                   "the port '{}' of {} takes {} and must be named in `in`; expected `in: {{{}: …}}`",
                                   port.name, spec_.name, kinds_text(port), port.name);
            return {};
        }
        std::size_t rivals = 0;
        for (const PortSpec& other : spec_.inputs) {
            if (other.kind != port.kind || other.name == port.name || !other.also.empty() || other.by_name) continue;
            // An optional port would take the same value as an earlier port of its kind, so only `in` can wire it.
            if (port.optional && &other < &port) return {};
            rivals += other.optional ? 0 : 1;
        }
        if (rivals > 0 && !port.optional) {
            diagnostics_.error(step_.position, "{} has {} ports that take {}; expected `in: {{{}: …}}`", spec_.name,
                               rivals + 1, name_of(port.kind), port.name);
            return {};
        }
        for (auto step = scope_.earlier.rbegin(); step != scope_.earlier.rend(); ++step) {
            const std::vector<PortSpec>& outputs = scope_.plan.steps[*step].spec.outputs;
            std::vector<std::string> found;
            for (const PortSpec& output : outputs)
                if (output.kind == port.kind && !output.by_name) found.push_back(output.name);
            if (found.size() == 1) return {{*step, 0, found.front()}};
            if (found.size() > 1) {
                ambiguous(port, fmt::format("'{}' has {} outputs of that kind ({})", scope_.plan.steps[*step].label,
                                            found.size(), enumerated(found)));
                return {};
            }
        }
        return nearest_input(port);
    }

    std::vector<ValueSource> nearest_input(const PortSpec& port) {
        const std::vector<WorkflowInput>& inputs = scope_.plan.workflow.inputs;
        std::vector<std::size_t> found;
        for (std::size_t i = 0; i < inputs.size(); ++i)
            if (inputs[i].kind == port.kind && !inputs[i].by_name && (port.list || !inputs[i].list)) found.push_back(i);
        if (found.size() == 1) return {{std::nullopt, found.front(), ""}};
        if (found.size() > 1) {
            std::vector<std::string> names;
            for (std::size_t i : found) names.push_back(inputs[i].name);
            ambiguous(port, "the workflow has the inputs " + enumerated(names));
        } else if (!port.optional && !scope_.uncertain) {
            diagnostics_.error(step_.position, "{} needs {} for its port '{}', and no earlier step makes any{}",
                               spec_.name, name_of(port.kind), port.name, makers(scope_.library, port.kind));
        }
        return {};
    }

    void ambiguous(const PortSpec& port, const std::string& why) {
        diagnostics_.error(step_.position,
                           "the port '{}' of {} could take several values of kind {}: {}; expected `in: {{{}: …}}`",
                           port.name, spec_.name, name_of(port.kind), why, port.name);
    }

    const StepSyntax& step_;
    const FilterSpec& spec_;
    const WiringScope& scope_;
    Diagnostics& diagnostics_;
};

}  // namespace

std::optional<ValueSource> resolve(const Reference& reference, const WiringScope& scope, Diagnostics& diagnostics) {
    const std::size_t dot = reference.text.find('.');
    const std::string name = reference.text.substr(0, dot);
    const auto step = scope.steps_by_name.find(name);
    if (step != scope.steps_by_name.end()) {
        const PlannedStep& planned = scope.plan.steps[step->second];
        const std::string port =
            dot == std::string::npos ? planned.spec.outputs.front().name : reference.text.substr(dot + 1);
        if (planned.spec.output(port)) return ValueSource{step->second, 0, port};
        diagnostics.error(reference.position, "'{}' has no output port '{}'; {}", name, port,
                          it_has(planned.spec.outputs, port));
        return std::nullopt;
    }
    if (const auto unusable = scope.unusable_names.find(name); unusable != scope.unusable_names.end()) {
        if (!unusable->second.empty()) diagnostics.error(reference.position, unusable->second);
        return std::nullopt;
    }
    const std::vector<WorkflowInput>& inputs = scope.plan.workflow.inputs;
    const auto input = std::ranges::find(inputs, name, &WorkflowInput::name);
    if (input != inputs.end() && dot == std::string::npos)
        return ValueSource{std::nullopt, static_cast<std::size_t>(input - inputs.begin()), ""};
    std::vector<std::string> names = names_of(inputs);
    for (const auto& [step_name, index] : scope.steps_by_name) names.push_back(step_name);
    diagnostics.error(reference.position, "'{}' is neither an earlier step nor an input; there {} {}{}", name,
                      names.size() == 1 ? "is" : "are", names.empty() ? "none" : enumerated(names),
                      did_you_mean(name, names));
    return std::nullopt;
}

std::vector<PlannedInput> wire(const StepSyntax& step, const FilterSpec& spec, const WiringScope& scope,
                               Diagnostics& diagnostics) {
    return Wiring(step, spec, scope, diagnostics).all();
}

}  // namespace scanmill
