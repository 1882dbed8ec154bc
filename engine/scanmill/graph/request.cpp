// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/graph/request.hpp"

#include <algorithm>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

void require_fed(const RunRequest& request, const Plan& plan) {
    const std::vector<WorkflowInput>& inputs = plan.workflow.inputs;
    if (inputs.empty() && !request.scans.empty())
        throw Error("the workflow takes no scans: it declares no inputs; found {}", request.scans.size());
    if (!inputs.empty() && request.scans.empty())
        throw Error("no scan was given for the workflow's input '{}'", inputs.front().name)
            .hint("scanmill run WORKFLOW SCAN…");
    std::vector<std::string> others;
    for (std::size_t i = 1; i < inputs.size(); ++i) others.push_back(inputs[i].name);
    for (const auto& [name, files] : request.inputs) {
        if (!inputs.empty() && name == inputs.front().name)
            throw Error("--in {}: the first input is fed by the scans", name).hint("scanmill run WORKFLOW SCAN…");
        if (std::ranges::find(others, name) == others.end())
            throw Error("--in {}: the workflow has no such input beside the scans; {}{}", name,
                        others.empty() ? "it has none" : "it has " + enumerated(others), did_you_mean(name, others));
        const auto& input = *std::ranges::find(inputs, name, &WorkflowInput::name);
        if (!input.list && files.size() > 1)
            throw Error("--in {}: the input takes one file; found {}", name, files.size());
    }
    for (const std::string& name : others)
        if (!request.inputs.contains(name))
            throw Error("the workflow's input '{}' is not fed", name).hint("--in " + name + "=FILE");
}

void require_known_names(const RunRequest& request, const Plan& plan) {
    std::vector<std::string> variants;
    std::set<std::string> steps;
    for (const PlannedVariant& variant : plan.variants) {
        variants.push_back(variant.name);
        for (const auto& [name, index] : variant.steps_by_name) steps.insert(name);
    }
    for (const std::string& name : request.only)
        if (std::ranges::find(variants, name) == variants.end())
            throw Error("--only {}: there is no such variant; there {} {}{}", name, variants.size() == 1 ? "is" : "are",
                        enumerated(variants), did_you_mean(name, variants));
    const std::vector<std::string> step_names(steps.begin(), steps.end());
    const auto require_step = [&](const std::string& option, const std::string& name) {
        if (!steps.contains(name))
            throw Error("{} {}: there is no such step; there {} {}{}", option, name,
                        step_names.size() == 1 ? "is" : "are", enumerated(step_names), did_you_mean(name, step_names));
    };
    if (!request.until.empty()) require_step("--until", request.until);
    for (const std::string& name : request.save) require_step("--save", name.substr(0, name.find('.')));
}

}  // namespace

void require_fits(const RunRequest& request, const Plan& plan) {
    require_fed(request, plan);
    require_known_names(request, plan);
}

}  // namespace scanmill
