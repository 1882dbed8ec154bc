// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/graph/graph.hpp"

#include <algorithm>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

std::vector<std::pair<std::string, std::string>> declared_of(const LeafSource& leaf) {
    std::vector<std::pair<std::string, std::string>> texts;
    if (leaf.unit != LengthUnit::unknown) texts.emplace_back("unit", symbol(leaf.unit));
    if (!leaf.frame.empty()) texts.emplace_back("frame", leaf.frame);
    if (leaf.pose) {
        std::string rows;
        for (int row = 0; row < 3; ++row)
            rows += fmt::format("{}[{}, {}, {}, {}]", row > 0 ? ", " : "", leaf.pose->rotation(row, 0),
                                leaf.pose->rotation(row, 1), leaf.pose->rotation(row, 2), leaf.pose->translation[row]);
        texts.emplace_back("pose", "[" + rows + ", [0, 0, 0, 1]]");
    }
    if (leaf.invalid != InvalidRows::by_format) texts.emplace_back("invalid", name_of(leaf.invalid));
    return texts;
}

const std::string& RunGraph::label(const RunNode& node) const {
    static const std::string read = "read";
    const PlannedStep* planned = step(node);
    return planned ? planned->label : read;
}

namespace {

void require_fed(const RunRequest& request, const Plan& plan) {
    const std::vector<WorkflowInput>& inputs = plan.workflow.inputs;
    if (inputs.empty() && !request.scans.empty())
        throw Error("the workflow declares no inputs and takes no scans; scans given: {}", request.scans.size());
    if (inputs.empty() && request.unit != LengthUnit::unknown)
        throw Error("the workflow declares no inputs, so the unit '{}' belongs to no scan", symbol(request.unit))
            .hint("write lengths with units in the workflow, or give the unit where the results are read");
    if (!inputs.empty() && request.scans.empty())
        throw Error("no scan was given for the workflow's input '{}'", inputs.front().name)
            .hint("name at least one scan")
            .remedy(Remedy::name_scans);
    std::vector<std::string> others;
    for (std::size_t i = 1; i < inputs.size(); ++i) others.push_back(inputs[i].name);
    for (const auto& [name, files] : request.inputs) {
        if (!inputs.empty() && name == inputs.front().name)
            throw Error("'{}' is the workflow's first input, which takes the scans", name)
                .hint("name its files as scans")
                .remedy(Remedy::name_scans);
        if (std::ranges::find(others, name) == others.end())
            throw Error("the workflow has no input '{}' beside the scans; {}{}", name,
                        others.empty() ? "it has none" : "it has " + enumerated(others), did_you_mean(name, others));
        const auto& input = *std::ranges::find(inputs, name, &WorkflowInput::name);
        if (!input.list && files.size() > 1) throw Error("the input '{}' takes one file; found {}", name, files.size());
    }
    for (const std::string& name : others) {
        if (request.inputs.contains(name)) continue;
        const auto has_own = [&](const ScanFile& scan) { return scan.inputs.contains(name); };
        if (std::ranges::all_of(request.scans, has_own)) continue;
        throw Error("the workflow's input '{}' has no file", name)
            .hint("name a file for this input")
            .remedy(Remedy::name_input_files);
    }
}

/// `what`: "variant" or "step".
void require_known(const std::string& what, const std::string& name, const std::vector<std::string>& names) {
    if (std::ranges::find(names, name) == names.end())
        throw Error("there is no {} '{}'; there {} {}{}", what, name, by_count(names.size(), "is", "are"),
                    enumerated(names), did_you_mean(name, names));
}

void require_known_names(const RunRequest& request, const Plan& plan) {
    std::vector<std::string> variants;
    std::set<std::string> steps;
    for (const PlannedVariant& variant : plan.variants) {
        variants.push_back(variant.name);
        for (const auto& [name, index] : variant.steps_by_name) steps.insert(name);
    }
    const std::vector<std::string> step_names(steps.begin(), steps.end());
    for (const std::string& name : request.only) require_known("variant", name, variants);
    if (!request.until.empty()) require_known("step", request.until, step_names);
    for (const std::string& name : request.save) require_known("step", name.substr(0, name.find('.')), step_names);
}

}  // namespace

void require_fits(const RunRequest& request, const Plan& plan) {
    require_fed(request, plan);
    const auto is_points = [](const WorkflowInput& input) { return input.kind == kind_of<PointCloud>(); };
    if (request.invalid != InvalidRows::by_format && std::ranges::none_of(plan.workflow.inputs, is_points))
        throw Error("the rule for invalid rows has no effect: the workflow has no input of points");
    require_known_names(request, plan);
}

}  // namespace scanmill
