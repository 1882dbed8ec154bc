// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/step_runner.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <cassert>
#include <map>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/kinds/length_scale.hpp"
#include "scanmill/kinds/value.hpp"
#include "scanmill/plan/expectation.hpp"

namespace scanmill {

namespace {

struct ResolvedParameters {
    /// Three kinds of values stay unresolved: defaults that cannot be resolved, defaults that
    /// ParameterSpec::unless_given makes unused, and spacings if ParameterSpec::takes_spacings is set.
    ParameterSet values;
    std::vector<UnresolvedLength> unresolved;  ///< reasons why defaults cannot be resolved
};

/// Throws UnresolvedLength for a length that cannot be resolved and is not its parameter's default.
ResolvedParameters resolved_parameters(const PlannedStep& step, const LengthScale& scale) {
    ResolvedParameters result;
    for (const auto& [name, value] : step.parameters.values) {
        const ParameterSpec* spec = step.spec.parameter(name);
        const bool is_default = spec && spec->default_value == value;
        if ((spec && spec->takes_spacings && is_in_spacings(value)) ||
            (is_default && !spec->unless_given.empty() && has_value(step.parameters.find(spec->unless_given)))) {
            result.values.values.emplace_back(name, value);
            continue;
        }
        try {
            result.values.values.emplace_back(name, resolved(value, scale));
        } catch (UnresolvedLength& reason) {
            reason.add_frame(fmt::format("in the parameter '{}'", name));
            if (!is_default) throw;
            result.unresolved.push_back(reason);
            result.values.values.emplace_back(name, value);
        }
    }
    return result;
}

const Value* first_geometric(const std::vector<StepInput>& inputs) {
    const auto found =
        std::ranges::find_if(inputs, [](const StepInput& input) { return is_geometric(input.value.kind()); });
    return found == inputs.end() ? nullptr : &found->value;
}

/// The input that relative lengths refer to: the first geometric input that has positions, or else the first geometric
/// input. nullptr without geometric inputs. Features, for example, may have no positions.
const Value* measured_input(const std::vector<StepInput>& inputs) {
    const auto found = std::ranges::find_if(inputs, [](const StepInput& input) {
        return is_geometric(input.value.kind()) && !positions_of(input.value).empty();
    });
    return found == inputs.end() ? first_geometric(inputs) : &found->value;
}

/// The unit of all inputs that declare a unit; unknown if none does. Throws Error if two units differ.
LengthUnit common_unit(const std::vector<StepInput>& inputs) {
    const StepInput* first = nullptr;
    for (const StepInput& input : inputs) {
        const std::optional<Frame> frame = frame_of(input.value);
        if (!frame || frame->unit == LengthUnit::unknown) continue;
        if (!first) first = &input;
        if (const LengthUnit unit = frame_of(first->value)->unit; unit != frame->unit)
            throw Error("the inputs have different units: {} at '{}', {} at '{}'", symbol(unit), first->port,
                        symbol(frame->unit), input.port)
                .hint("convert one of them")
                .remedy(Remedy::convert_unit);
    }
    return first ? frame_of(first->value)->unit : LengthUnit::unknown;
}

/// The unit of the value at the port; nullopt if there is no value, or one that is not geometric.
std::optional<LengthUnit> unit_at(const std::vector<StepInput>& inputs, const std::string& port) {
    const auto input = std::ranges::find(inputs, port, &StepInput::port);
    const std::optional<Frame> frame = input == inputs.end() ? std::nullopt : frame_of(input->value);
    return frame ? std::optional(frame->unit) : std::nullopt;
}

void convert_to(LengthUnit unit, const std::string& port, std::vector<StepInput>& inputs) {
    for (StepInput& input : inputs)
        if (input.port == port) input.value = in_unit(input.value, unit);
}

/// The inputs of a drawing step. If the input that sets the camera and the drawn value declare different units, the
/// former is converted to the unit of the value.
std::vector<StepInput> in_unit_of_drawn(std::vector<StepInput> inputs, const DrawSpec& ports) {
    const LengthUnit unit = unit_at(inputs, ports.value).value_or(LengthUnit::unknown);
    const LengthUnit of_camera = unit_at(inputs, ports.camera).value_or(LengthUnit::unknown);
    if (unit != of_camera && unit != LengthUnit::unknown && of_camera != LengthUnit::unknown)
        convert_to(unit, ports.camera, inputs);
    return inputs;
}

/// The inputs of a measuring step, with the truth converted to the unit of the value. Throws Error if only one of the
/// two declares a unit, because a wrong guess would give a wrong score.
std::vector<StepInput> in_unit_of_value(std::vector<StepInput> inputs, const MeasureSpec& ports) {
    const std::optional<LengthUnit> unit = unit_at(inputs, ports.value), of_truth = unit_at(inputs, ports.truth);
    if (!unit || !of_truth || *unit == *of_truth) return inputs;
    const auto text = [](LengthUnit each) {
        return each == LengthUnit::unknown ? "has no unit" : fmt::format("is in {}", symbol(each));
    };
    if (*unit == LengthUnit::unknown || *of_truth == LengthUnit::unknown)
        throw Error("the {} {}, the {} {}; they cannot be compared", ports.value, text(*unit), ports.truth,
                    text(*of_truth))
            .hint(*unit == LengthUnit::unknown
                      ? "declare the scan's unit: `unit:` at the scan or at the workflow's input"
                      : "declare the truth's unit: `truth: {path: FILE, unit: mm}` in a batch, or `unit:` at the "
                        "workflow's input")
            .remedy(*unit == LengthUnit::unknown ? Remedy::declare_unit : Remedy::declare_truth_unit);
    convert_to(*unit, ports.truth, inputs);
    return inputs;
}

/// All inputs in `unit`, relative to the origin of `first`. Inputs without a unit get `unit`, with a warning. Pre:
/// `unit` is the unit of all inputs that declare a unit.
Inputs rebased(const std::vector<StepInput>& inputs, const Value* first, LengthUnit unit, Context& context) {
    Inputs result;
    std::map<std::string, std::size_t> without_unit;  // number of values by port
    for (const StepInput& input : inputs) {
        const std::optional<Frame> own = frame_of(input.value);
        if (!own) {
            result.add(input.port, input.value);
            continue;
        }
        without_unit[input.port] += own->unit != unit;
        Frame frame = *own;
        frame.unit = unit;
        frame.origin = frame_of(*first)->origin;
        result.add(input.port, frame == *own ? input.value : reframed(input.value, frame));
    }
    for (const auto& [port, count] : without_unit)
        if (count > 0)
            context.warn(fmt::format("{} at '{}' {} no unit; the unit of the other inputs is used: {}",
                                     count == 1 ? "the value" : fmt::format("{} values", count), port,
                                     by_count(count, "declares", "declare"), symbol(unit)));
    return result;
}

void require_declared(const Outputs& outputs, const Context& context, const FilterSpec& spec) {
    const auto fail = [&](std::string what) {
        throw BrokenDeclaration(fmt::format("the filter {} {}", spec.name, what));
    };
    if (!context.doubts().empty() && spec.doubts.empty())
        fail(fmt::format("doubts its result ({}), but declares no doubts", context.doubts().front().text));
    for (const Metric& metric : context.metrics().values)
        if (!spec.metric(metric.name))
            fail(fmt::format("reported the metric '{}', which it does not declare", metric.name));
    for (const PortSpec& port : spec.outputs) {
        const Value* value = outputs.find(port.name);
        if (!value) fail(fmt::format("did not give its declared output '{}'", port.name));
        if (kind_of(*value) != port.kind)
            fail(fmt::format("gave {} at '{}', which it declares as {}", name_of(kind_of(*value)), port.name,
                             name_of(port.kind)));
        port.kind.info().require_usable(value->object());
    }
}

void doubt_inside_out(const Outputs& outputs, const FilterSpec& spec, Context& context) {
    for (const PortSpec& port : spec.outputs)
        if (const TriangleMesh* mesh = outputs.find(port.name)->find<TriangleMesh>(); mesh && is_inside_out(*mesh))
            context.doubt(
                fmt::format("the closed surface is inside out: it encloses a volume of {:.6g} {}³",
                            signed_volume(mesh->positions.span(), mesh->triangles.span()), symbol(mesh->frame.unit)),
                port.name);
}

/// Calls `check`. Puts the file's path before the sentence of an error, as readers do.
void naming_file(const std::filesystem::path& file, const std::function<void()>& check) {
    try {
        check();
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}': {}", file.string(), error.sentence()));
    }
}

ReadOptions reading(const LeafSource& leaf, const OnWarning& on_warning) {
    ReadOptions options;
    options.on_warning = on_warning;
    options.unit = leaf.unit;
    options.names_file = false;
    return options;
}

/// Sets `name` to the declared frame name. Returns false if `name` is equal already or no name is declared.
bool take_declared_name(const LeafSource& leaf, std::string& name, const OnWarning& on_warning) {
    if (leaf.frame.empty() || name == leaf.frame) return false;
    if (!name.empty())
        on_warning(fmt::format("the file's frame '{}' was renamed to '{}', as declared", name, leaf.frame));
    name = leaf.frame;
    return true;
}

OnWarning adding_to(std::vector<std::string>& warnings) {
    return [&warnings](std::string sentence) { warnings.push_back(std::move(sentence)); };
}

/// A step whose inputs and parameters are prepared.
struct Prepared {
    ResolvedParameters resolved;
    std::vector<std::string> warnings;  ///< warnings about resolving the parameters
    LengthUnit unit;                    ///< unit of the inputs, and so of the filter's metrics
    std::function<Outputs(const FilterDeclaration&, const ParameterSet&)> run;
};

Outputs run_recorded(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                     ContextOptions options, const Recall& recall, NodeReport& report,
                     const std::function<Prepared(Context&)>& prepare) {
    Context context(std::move(options));
    const auto record = [&] {
        report.warnings = context.warnings();
        report.doubts = context.doubts();
        for (const MetricSpec& declared : step.spec.metrics)
            for (const Metric& metric : context.metrics().values)
                if (step.spec.metric(metric.name) == &declared)
                    report.metrics.set(metric.name, metric.value, declared.unit);
    };
    try {
        const auto [resolved, warnings, unit, run] = prepare(context);
        report.resolved = resolved.values;
        std::optional<Outputs> known = recall(report.resolved, report);
        report.metrics.unit = unit;
        if (known) return std::move(*known);
        for (const std::string& warning : warnings) context.warn(warning);
        Outputs outputs;
        try {
            outputs = run(filter(), resolved.values);
        } catch (const UnresolvedLength& read) {
            for (const UnresolvedLength& reason : resolved.unresolved)
                if (reason.length() == read.length()) throw reason;
            throw;
        }
        require_declared(outputs, context, step.spec);
        doubt_inside_out(outputs, step.spec, context);
        record();
        return outputs;
    } catch (...) {
        record();
        throw;
    }
}

}  // namespace

void require_expectations(const PlannedStep& step, const Value& primary, NodeReport& report) {
    if (step.expectations.empty()) return;
    report.properties = properties_of(primary);
    Metrics found = report.properties;
    for (const Metric& metric : report.metrics.values) found.set(metric.name, metric.value, metric.unit);
    require_met(step.expectations, found, length_scale(primary, adding_to(report.warnings)));
}

Value read_leaf(const LeafSource& leaf, const OnWarning& on_warning, std::size_t* dropped) {
    if (!leaf.refusal.empty()) throw leaf.refusal.error();
    const ReadOptions options = reading(leaf, on_warning);
    Value value;
    LoadedFile loaded = leaf.also.empty() && leaf.kind == kind_of<TriangleMesh>()
                            ? LoadedFile{Value(read_mesh(leaf.name(), options)), {}, {}, {}}
                            : read_file(leaf.name(), options);
    const bool is_other_kind = std::ranges::find(leaf.also, loaded.value.kind()) != leaf.also.end();
    if ((is_other_kind ? loaded.value.kind() : leaf.kind) == kind_of<PointCloud>()) {
        Cleaned<PointCloud> scan = accepted_points(loaded, leaf.name(), options, leaf.invalid);
        loaded = {};  // two copies of a large scan may not fit into memory
        if (dropped) *dropped = scan.points;
        value = std::make_shared<const PointCloud>(std::move(scan.result));
    } else {
        value = std::move(loaded.value);
        if (value.kind() != leaf.kind && !is_other_kind)
            throw Error("'{}': the workflow needs {}; the file contains {}", leaf.name(), leaf.kind.name(),
                        value.kind().name());
        naming_file(leaf.name(), [&] { require_supported_range(bounding_box(positions_of(value).span())); });
    }
    if (leaf.pose) value = placed(value, *leaf.pose);
    std::optional<Frame> frame = frame_of(value);
    return frame && take_declared_name(leaf, frame->name, on_warning) ? reframed(value, *frame) : value;
}

std::shared_ptr<const PointStream> open_leaf(const LeafSource& leaf, unsigned threads, const OnWarning& on_warning,
                                             const OnWorldPositions& on_positions) {
    assert(leaf.is_streamed && leaf.kind == kind_of<PointCloud>() && !leaf.pose);
    std::shared_ptr<PointStream> scan =
        open_point_stream(leaf.name(), reading(leaf, on_warning), threads, on_positions);
    if (!scan) return nullptr;
    if (is_too_long(scan->bounds())) return nullptr;  // the file may have invalid rows
    naming_file(leaf.file, [&] { require_supported_range(scan->bounds()); });
    if (std::string name = scan->frame().name; take_declared_name(leaf, name, on_warning)) scan->rename_frame(name);
    return scan;
}

Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const std::vector<StepInput>& inputs, ContextOptions options, const Recall& recall,
                 NodeReport& report) {
    return run_recorded(step, filter, std::move(options), recall, report, [&](Context& context) {
        const std::vector<StepInput> comparable = step.spec.measures ? in_unit_of_value(inputs, *step.spec.measures)
                                                  : step.spec.draws  ? in_unit_of_drawn(inputs, *step.spec.draws)
                                                                     : inputs;
        const Value* first = first_geometric(comparable);
        const LengthUnit unit = common_unit(comparable);
        Inputs ports = rebased(comparable, first, unit, context);
        // Without a geometric input, the filter itself resolves lengths, by the size of its result.
        std::vector<std::string> warnings;
        ResolvedParameters resolved{step.parameters, {}};
        if (const Value* measured = measured_input(comparable)) {
            LengthScale scale = length_scale(*measured, adding_to(warnings));
            scale.unit = unit;
            resolved = resolved_parameters(step, scale);
        }
        return Prepared{
            std::move(resolved), std::move(warnings), unit,
            [&context, ports = std::move(ports)](const FilterDeclaration& declared, const ParameterSet& parameters) {
                return declared.run(ports, parameters, context);
            }};
    });
}

Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const PointStream& scan, ContextOptions options, const Recall& recall, NodeReport& report) {
    return run_recorded(step, filter, std::move(options), recall, report, [&](Context& context) {
        std::vector<std::string> warnings;
        ResolvedParameters resolved = resolved_parameters(step, length_scale(scan, adding_to(warnings)));
        return Prepared{std::move(resolved), std::move(warnings), scan.frame().unit,
                        [&](const FilterDeclaration& declared, const ParameterSet& parameters) {
                            return declared.run_streamed(scan, parameters, context);
                        }};
    });
}

}  // namespace scanmill
