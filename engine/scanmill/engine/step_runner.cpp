// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/step_runner.hpp"

#include <algorithm>

#include "scanmill/engine/expectation.hpp"
#include "scanmill/engine/facts.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/geometry/length_scale.hpp"
#include "scanmill/geometry/placed.hpp"

namespace scanmill {

namespace {

const Value* first_geometric(const std::vector<StepInput>& inputs) {
    const auto found =
        std::ranges::find_if(inputs, [](const StepInput& input) { return frame_of(input.value) != nullptr; });
    return found == inputs.end() ? nullptr : &found->value;
}

/// The unit that all inputs are in: those without one are taken to be in that of the others. Throws Error when two are
/// known and differ.
LengthUnit common_unit(const std::vector<StepInput>& inputs) {
    const StepInput* known = nullptr;
    for (const StepInput& input : inputs) {
        const Frame* frame = frame_of(input.value);
        if (!frame || frame->unit == LengthUnit::unknown) continue;
        if (!known) known = &input;
        if (const LengthUnit unit = frame_of(known->value)->unit; unit != frame->unit)
            throw Error("the inputs have different units: {} at '{}', {} at '{}'", symbol(unit), known->port,
                        symbol(frame->unit), input.port)
                .hint("convert one of them: scanmill convert --to-unit mm IN OUT");
    }
    return known ? frame_of(known->value)->unit : LengthUnit::unknown;
}

/// All inputs in one unit and relative to one origin, that of the first.
Inputs rebased(const std::vector<StepInput>& inputs, const Value* first, Context& context) {
    const LengthUnit unit = common_unit(inputs);
    Inputs result;
    for (const StepInput& input : inputs) {
        const Frame* own = frame_of(input.value);
        if (!own) {
            result.add(input.port, input.value);
            continue;
        }
        if (own->unit != unit)
            context.warn(fmt::format("the value at '{}' declares no unit and was taken to be in that of the others: {}",
                                     input.port, symbol(unit)));
        Frame frame = *own;
        frame.unit = unit;
        frame.origin = frame_of(*first)->origin;
        result.add(input.port, frame == *own ? input.value : reframed(input.value, frame));
    }
    return result;
}

/// A default that the scan has no measure for, as `0.1 %diag` where all points are at one place, and why.
struct Unresolved {
    ParameterValue value;
    Error reason;
};

/// Lengths in the scan's unit. What somebody chose must resolve; a default that does not stays as it is declared and
/// goes to `unresolved`: the filter may do without it.
ParameterSet resolved_parameters(const PlannedStep& step, const Value* scale_of, std::vector<Unresolved>& unresolved) {
    if (!scale_of) return step.parameters;  // nothing to measure against: the filter resolves against what it makes
    const LengthScale scale = length_scale(*scale_of);
    ParameterSet set;
    for (const auto& [name, value] : step.parameters.values) {
        try {
            set.values.emplace_back(name, resolved(value, scale));
        } catch (Error& error) {
            error.add_frame(fmt::format("in the parameter '{}'", name));
            const ParameterSpec* spec = step.spec.parameter(name);
            if (!spec || spec->default_value != value) throw;
            unresolved.push_back({value, error});
            set.values.emplace_back(name, value);
        }
    }
    return set;
}

/// Whether the error is the one that a filter meets when it reads a length of this value.
bool comes_of_reading(const ParameterValue& value, const Error& error) {
    const auto is_refused_alike = [&](const ParameterScalar& item) {
        const auto* length = std::get_if<Length>(&item);
        if (!length) return false;
        try {
            length->value();
        } catch (const Error& own) {
            return own.sentence() == error.sentence();
        }
        return false;
    };
    if (const auto* one = std::get_if<ParameterScalar>(&value)) return is_refused_alike(*one);
    const auto* list = std::get_if<std::vector<ParameterScalar>>(&value);
    return list && std::ranges::any_of(*list, is_refused_alike);
}

/// Runs the filter; one that stumbles over an unresolved default fails for the reason that left it so.
Outputs run_filter(const FilterDeclaration& filter, const Inputs& ports, const ParameterSet& parameters,
                   const std::vector<Unresolved>& unresolved, Context& context) {
    try {
        return filter.run(ports, parameters, context);
    } catch (const Error& error) {
        for (const Unresolved& left : unresolved)
            if (comes_of_reading(left.value, error)) throw left.reason;
        throw;
    }
}

void require_whole(const Outputs& outputs, const FilterSpec& spec) {
    for (const PortSpec& port : spec.outputs) {
        const Value* value = outputs.find(port.name);
        if (!value) throw Error("the filter {} gave no '{}', which it declares", spec.name, port.name);
        if (kind_of(*value) != port.kind)
            throw Error("the filter {} gave {} at '{}', which it declares as {}", spec.name, name_of(kind_of(*value)),
                        port.name, name_of(port.kind));
        if (const auto* mesh = std::get_if<std::shared_ptr<const TriangleMesh>>(value)) {
            require_consistent(**mesh);
            if ((*mesh)->triangles.empty()) throw Error("the result has no triangles");
        }
        if (const auto* points = std::get_if<std::shared_ptr<const PointCloud>>(value);
            points && (*points)->size() == 0)
            throw Error("the result has no points");
    }
}

}  // namespace

void require_expectations(const PlannedStep& step, const Value& primary, NodeReport& report) {
    if (step.expectations.empty()) return;
    report.facts = facts_of(primary);
    Metrics known = report.facts;
    for (const Metric& metric : report.metrics.values) known.set(metric.name, metric.value, metric.unit);
    require_met(step.expectations, known, length_scale(primary));
}

Value read_leaf(const LeafSource& leaf, const std::function<void(std::string)>& on_warning) {
    ReadOptions options;
    options.on_warning = on_warning;
    options.unit = leaf.unit;
    Value value;
    if (leaf.kind == Kind::mesh)
        value = read_mesh(leaf.file, options);
    else
        value = read_points(leaf.file, options);
    if (leaf.pose) value = placed(value, *leaf.pose);
    if (leaf.frame.empty() || frame_of(value)->name == leaf.frame) return value;
    Frame frame = *frame_of(value);
    if (!frame.name.empty())
        on_warning(fmt::format("'{}': the frame '{}' of the file is called '{}' by the workflow or the batch",
                               leaf.file.string(), frame.name, leaf.frame));
    frame.name = leaf.frame;
    return reframed(value, frame);
}

Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const std::vector<StepInput>& inputs, ContextOptions options, const Recall& recall,
                 NodeReport& report) {
    Context context(std::move(options));
    const Value* first = first_geometric(inputs);
    const auto keep_findings = [&] {
        report.warnings = context.warnings();
        std::vector<std::pair<const MetricSpec*, const Metric*>> told;
        for (const Metric& metric : context.metrics().values)
            if (const MetricSpec* declared = step.spec.metric(metric.name)) told.emplace_back(declared, &metric);
        std::ranges::stable_sort(told, {}, [](const auto& pair) { return pair.first; });  // as they are declared
        for (const auto& [declared, metric] : told) report.metrics.set(metric->name, metric->value, declared->unit);
    };
    try {
        const Inputs ports = rebased(inputs, first, context);
        std::vector<Unresolved> unresolved;
        report.resolved = resolved_parameters(step, first, unresolved);
        if (std::optional<Outputs> known = recall(report.resolved, report)) return std::move(*known);
        Outputs outputs = run_filter(filter(), ports, report.resolved, unresolved, context);
        require_whole(outputs, step.spec);
        keep_findings();
        return outputs;
    } catch (...) {
        keep_findings();
        throw;
    }
}

}  // namespace scanmill
