// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/step_runner.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>

#include "scanmill/base/error.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/length_scale.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/plan/expectation.hpp"

namespace scanmill {

namespace {

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

}  // namespace

ResolvedParameters resolved_parameters(const PlannedStep& step, const LengthScale& scale) {
    ResolvedParameters result;
    for (const auto& [name, value] : step.parameters.values) {
        try {
            result.values.values.emplace_back(name, resolved(value, scale));
        } catch (Error& error) {
            error.add_frame(fmt::format("in the parameter '{}'", name));
            const ParameterSpec* spec = step.spec.parameter(name);
            if (!spec || spec->default_value != value) throw;
            result.left.push_back({value, error});
            result.values.values.emplace_back(name, value);
        }
    }
    return result;
}

Outputs with_reasons(const std::vector<UnresolvedDefault>& left, const std::function<Outputs()>& run) {
    try {
        return run();
    } catch (const Error& error) {
        for (const UnresolvedDefault& unresolved : left)
            if (comes_of_reading(unresolved.value, error)) throw unresolved.reason;
        throw;
    }
}

namespace {

const Value* first_geometric(const std::vector<StepInput>& inputs) {
    const auto found =
        std::ranges::find_if(inputs, [](const StepInput& input) { return is_geometric(input.value.kind()); });
    return found == inputs.end() ? nullptr : &found->value;
}

/// The unit that all inputs are in: those without one are taken to be in that of the others. Throws Error when two are
/// known and differ.
LengthUnit common_unit(const std::vector<StepInput>& inputs) {
    const StepInput* known = nullptr;
    for (const StepInput& input : inputs) {
        const std::optional<Frame> frame = frame_of(input.value);
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
        const std::optional<Frame> own = frame_of(input.value);
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

void require_whole(const Outputs& outputs, const FilterSpec& spec) {
    for (const PortSpec& port : spec.outputs) {
        const Value* value = outputs.find(port.name);
        if (!value) throw Error("the filter {} gave no '{}', which it declares", spec.name, port.name);
        if (kind_of(*value) != port.kind)
            throw Error("the filter {} gave {} at '{}', which it declares as {}", spec.name, name_of(kind_of(*value)),
                        port.name, name_of(port.kind));
        port.kind.info().require_usable(value->object());
    }
}

/// Errors of `check` begin with the file's path, as those of reading do.
void naming_file(const std::filesystem::path& file, const std::function<void()>& check) {
    try {
        check();
    } catch (const Error& error) {
        throw Error("'{}': {}", file.string(), error.sentence()).hint(error.hint());
    }
}

ReadOptions reading(const LeafSource& leaf, const std::function<void(std::string)>& on_warning) {
    ReadOptions options;
    options.on_warning = on_warning;
    options.unit = leaf.unit;
    return options;
}

/// Whether the frame gets another name than the one it has.
bool take_declared_name(const LeafSource& leaf, std::string& name, const std::function<void(std::string)>& on_warning) {
    if (leaf.frame.empty() || name == leaf.frame) return false;
    if (!name.empty())
        on_warning(fmt::format("'{}': the frame '{}' of the file is called '{}' by the workflow or the batch",
                               leaf.file.string(), name, leaf.frame));
    name = leaf.frame;
    return true;
}

/// A step whose inputs are in order.
struct Ready {
    ResolvedParameters resolved;
    std::function<Outputs(const FilterDeclaration&, const ParameterSet&)> run;
};

/// Runs what `prepare` makes ready, unless `recall` knows better; what was learned goes to the report.
Outputs run_recorded(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                     ContextOptions options, const Recall& recall, NodeReport& report,
                     const std::function<Ready(Context&)>& prepare) {
    Context context(std::move(options));
    const auto keep_findings = [&] {
        report.warnings = context.warnings();
        std::vector<std::pair<const MetricSpec*, const Metric*>> told;
        for (const Metric& metric : context.metrics().values)
            if (const MetricSpec* declared = step.spec.metric(metric.name)) told.emplace_back(declared, &metric);
        std::ranges::stable_sort(told, {}, [](const auto& pair) { return pair.first; });  // as they are declared
        for (const auto& [declared, metric] : told) report.metrics.set(metric->name, metric->value, declared->unit);
    };
    try {
        const Ready ready = prepare(context);
        report.resolved = ready.resolved.values;
        if (std::optional<Outputs> known = recall(report.resolved, report)) return std::move(*known);
        Outputs outputs = with_reasons(ready.resolved.left, [&] { return ready.run(filter(), ready.resolved.values); });
        require_whole(outputs, step.spec);
        keep_findings();
        return outputs;
    } catch (...) {
        keep_findings();
        throw;
    }
}

}  // namespace

void require_expectations(const PlannedStep& step, const Value& primary, NodeReport& report) {
    if (step.expectations.empty()) return;
    report.properties = properties_of(primary);
    Metrics known = report.properties;
    for (const Metric& metric : report.metrics.values) known.set(metric.name, metric.value, metric.unit);
    require_met(step.expectations, known, length_scale(primary));
}

Value read_leaf(const LeafSource& leaf, const std::function<void(std::string)>& on_warning) {
    const ReadOptions options = reading(leaf, on_warning);
    Value value = leaf.kind == kind_of<PointCloud>()     ? Value(read_points(leaf.file, options))
                  : leaf.kind == kind_of<TriangleMesh>() ? Value(read_mesh(leaf.file, options))
                                                         : read_file(leaf.file, options).value;
    if (value.kind() != leaf.kind)
        throw Error("'{}': {} are needed; the file contains {}", leaf.file.string(), leaf.kind.name(),
                    value.kind().name());
    naming_file(leaf.file, [&] { require_supported_range(bounding_box(positions_of(value).span())); });
    if (leaf.pose) value = placed(value, *leaf.pose);
    std::optional<Frame> frame = frame_of(value);
    return frame && take_declared_name(leaf, frame->name, on_warning) ? reframed(value, *frame) : value;
}

std::shared_ptr<const PointStream> open_leaf(const LeafSource& leaf, unsigned threads,
                                             const std::function<void(std::string)>& on_warning,
                                             const OnWorldPositions& on_positions) {
    assert(leaf.is_streamed && leaf.kind == kind_of<PointCloud>() && !leaf.pose);
    std::shared_ptr<PointStream> scan = open_point_stream(leaf.file, reading(leaf, on_warning), threads, on_positions);
    if (!scan) return nullptr;
    naming_file(leaf.file, [&] { require_supported_range(scan->bounds()); });
    if (std::string name = scan->frame().name; take_declared_name(leaf, name, on_warning)) scan->rename_frame(name);
    return scan;
}

Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const std::vector<StepInput>& inputs, ContextOptions options, const Recall& recall,
                 NodeReport& report) {
    return run_recorded(step, filter, std::move(options), recall, report, [&](Context& context) {
        const Value* first = first_geometric(inputs);
        Inputs ports = rebased(inputs, first, context);
        // Without anything to measure against, the filter resolves against what it makes.
        ResolvedParameters resolved =
            first ? resolved_parameters(step, length_scale(*first)) : ResolvedParameters{step.parameters, {}};
        return Ready{std::move(resolved), [&context, ports = std::move(ports)](const FilterDeclaration& declared,
                                                                               const ParameterSet& parameters) {
                         return declared.run(ports, parameters, context);
                     }};
    });
}

Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const PointStream& scan, ContextOptions options, const Recall& recall, NodeReport& report) {
    return run_recorded(step, filter, std::move(options), recall, report, [&](Context& context) {
        return Ready{resolved_parameters(step, length_scale(scan)),
                     [&](const FilterDeclaration& declared, const ParameterSet& parameters) {
                         return declared.run_streamed(scan, parameters, context);
                     }};
    });
}

}  // namespace scanmill
