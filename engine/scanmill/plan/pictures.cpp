// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/pictures.hpp"

#include <algorithm>
#include <filesystem>

#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

/// The only drawing filter; nullptr after an error.
const FilterSpec* drawing_filter(const FilterLibrary& library, Diagnostics& diagnostics) {
    const std::vector<std::string> names = drawing_filters(library);
    if (names.size() == 1) return library.find(names.front());
    if (names.empty())
        diagnostics.error({}, "no installed filter draws pictures; `scanmill list` lists the installed ones");
    else
        diagnostics.error({},
                          "{} draw pictures, so none of them is chosen; add a step with one of them to the workflow",
                          enumerated(names));
    return nullptr;
}

enum class Drawable { no, other, surface };

Drawable drawable(Kind kind, const PortSpec& port) {
    if (!is_geometric(kind) || !port.takes(kind)) return Drawable::no;
    return kind == kind_of<TriangleMesh>() || kind == kind_of<PatchComplex>() ? Drawable::surface : Drawable::other;
}

/// The output to draw, as make_plan_with_picture() describes it; nullptr if there is none.
const WorkflowOutput* drawn_output(const Plan& plan, const PortSpec& port) {
    const WorkflowOutput* drawn = nullptr;
    Drawable best = Drawable::no;
    for (const WorkflowOutput& output : plan.workflow.outputs) {
        Drawable found = Drawable::no;
        for (const PlannedVariant& variant : plan.variants)
            for (const PlannedOutput& planned : variant.outputs)
                if (planned.file == output.file) found = std::max(found, drawable(kind_of(plan, planned.source), port));
        if (found == Drawable::no || found < best) continue;
        best = found;
        drawn = &output;
    }
    return drawn;
}

/// `name`, or `name-2`, `name-3` and so on, whichever is the first that is free.
template <class IsTaken>
std::string free_name(const std::string& name, const IsTaken& is_taken) {
    std::string free = name;
    for (std::size_t number = 2; is_taken(free); ++number) free = fmt::format("{}-{}", name, number);
    return free;
}

std::string step_name(const Plan& plan, const std::string& value) {
    std::string name = "picture-" + value;
    std::ranges::replace(name, '.', '-');
    return free_name(name, [&](const std::string& each) {
        const auto has_step = [&](const PlannedVariant& variant) { return variant.steps_by_name.contains(each); };
        return std::ranges::any_of(plan.variants, has_step) ||
               std::ranges::find(plan.workflow.inputs, each, &WorkflowInput::name) != plan.workflow.inputs.end();
    });
}

std::string picture_file(const Workflow& workflow, const std::string& output) {
    const std::string stem = std::filesystem::path(output).replace_extension().string();
    const auto is_taken = [&](const std::string& name) {
        return std::ranges::find(workflow.outputs, name + ".png", &WorkflowOutput::file) != workflow.outputs.end();
    };
    return (is_taken(stem) ? free_name(stem + "-picture", is_taken) : stem) + ".png";
}

void add_picture(Workflow& workflow, const Plan& plain, const FilterSpec& filter, const WorkflowOutput& drawn) {
    const Position position = drawn.source.position;
    StepSyntax step;
    step.filter = filter.name;
    step.position = position;
    step.id = step_name(plain, drawn.source.text);
    step.in = {{filter.draws->value, position, {drawn.source}}};
    step.may_be_left_out = true;
    workflow.outputs.push_back({picture_file(workflow, drawn.file), drawn.position, {step.id, position}, true});
    workflow.steps.push_back({std::move(step)});
}

}  // namespace

std::vector<std::string> drawing_filters(const FilterLibrary& library) {
    std::vector<std::string> names = library.names();
    std::erase_if(names, [&](const std::string& name) {
        const FilterSpec& spec = *library.find(name);
        const auto is_fed = [&](const PortSpec& port) { return port.optional || port.name == spec.draws->value; };
        return !spec.draws || !std::ranges::all_of(spec.inputs, is_fed);
    });
    return names;
}

Plan make_plan_with_picture(Workflow workflow, const FilterLibrary& library, const Settings& settings,
                            Diagnostics& diagnostics) {
    Plan plain = make_plan(workflow, library, settings, diagnostics);
    if (diagnostics.has_errors()) return plain;
    const FilterSpec* filter = drawing_filter(library, diagnostics);
    if (!filter) return plain;
    const PortSpec& port = *filter->input(filter->draws->value);
    const WorkflowOutput* drawn = drawn_output(plain, port);
    if (!drawn) {
        diagnostics.error({}, "has no output for a picture: {} draws {}; expected an output of such a kind",
                          filter->name, kinds_text(port));
        return plain;
    }
    add_picture(workflow, plain, *filter, *drawn);
    return make_plan(std::move(workflow), library, settings, diagnostics);
}

}  // namespace scanmill
