// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/plan_batch.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

namespace {

/// Equal for values that mean the same, wherever they stand.
std::string key_of(const Settings& settings) {
    KeyBuilder key;
    for (const auto& [name, value] : settings) {
        key.field("name", name).field("values", std::to_string(value.values.size()));
        for (const WrittenValue& written : value.values) {
            key.field("items", std::to_string(written.literal.items.size()))
                .field("list", written.literal.list ? "1" : "0");
            for (const std::string& item : written.literal.items) key.field("item", item);
        }
    }
    return key.key();
}

/// The batch's values, overridden by the scan's, of those names that the workflow declares.
Settings settings_for(const Workflow& workflow, const Settings& of_batch, const Settings& of_scan) {
    Settings settings = of_scan;
    settings.insert(of_batch.begin(), of_batch.end());
    for (const std::string& name : undeclared(settings, workflow)) settings.erase(name);
    return settings;
}

class BatchPlanner {
public:
    BatchPlanner(const std::string& text, const std::string& file, const FilterLibrary& library)
        : library_(library),
          batch_diagnostics_(file) {
        checked_.batch = parse_batch(text, batch_diagnostics_);
    }

    CheckedBatch checked() {
        for (std::size_t i = 0; i < checked_.batch.workflows.size(); ++i) plan_workflow(i);
        if (!unreadable_) complain_of_undeclared();
        constexpr std::size_t most_cells = 100'000;
        if (const std::size_t cells = checked_.cells(); cells > most_cells)
            batch_diagnostics_.error({}, fmt::format("has {} cells (scans times variants); expected at most {}: make "
                                                     "several batches of it",
                                                     cells, most_cells));
        checked_.diagnostics.insert(checked_.diagnostics.begin(), std::move(batch_diagnostics_));
        return std::move(checked_);
    }

private:
    void plan_workflow(std::size_t index) {
        const BatchWorkflow& place = checked_.batch.workflows[index];
        std::string text;
        try {
            text = read_workflow_file(place.file);
        } catch (const Error& error) {
            batch_diagnostics_.error(place.position, error.sentence());
            unreadable_ = true;
            return;
        }
        if (is_batch(text)) {
            batch_diagnostics_.error(place.position,
                                     fmt::format("'{}' is a batch; expected a workflow", place.file.string()));
            unreadable_ = true;
            return;
        }
        Diagnostics diagnostics(place.file.string());
        const Workflow workflow = parse_workflow(text, diagnostics);
        if (workflow.steps.empty()) unreadable_ = true;  // its names could not be read either
        require_one_input(workflow, place);
        for (const WorkflowParameter& parameter : workflow.parameters) declared_.insert(parameter.name);
        add_parts(workflow, index, diagnostics);
        checked_.diagnostics.push_back(std::move(diagnostics));
    }

    void add_parts(const Workflow& workflow, std::size_t index, Diagnostics& diagnostics) {
        const Batch& batch = checked_.batch;
        std::map<std::string, std::size_t> part_of_settings;
        for (std::size_t scan = 0; scan < batch.scans.size(); ++scan) {
            const Settings settings = settings_for(workflow, batch.settings, batch.scans[scan].settings);
            const auto [part, is_new] = part_of_settings.emplace(key_of(settings), checked_.parts.size());
            if (is_new) checked_.parts.push_back({plan(workflow, settings, diagnostics), index, {}});
            checked_.parts[part->second].scans.push_back(scan);
        }
        if (batch.scans.empty())  // what is wrong is found all the same
            plan(workflow, settings_for(workflow, batch.settings, {}), diagnostics);
    }

    std::shared_ptr<const Plan> plan(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics) {
        return std::make_shared<const Plan>(make_plan(workflow, library_, settings, diagnostics, &batch_diagnostics_));
    }

    void require_one_input(const Workflow& workflow, const BatchWorkflow& place) {
        const std::string name = place.file.string();
        if (workflow.inputs.empty())
            batch_diagnostics_.error(place.position,
                                     fmt::format("'{}' has no inputs, so there is nothing to feed scans to; "
                                                 "run it by itself",
                                                 name));
        if (workflow.inputs.size() <= 1) return;
        batch_diagnostics_.error(
            place.position,
            fmt::format("'{}' has {} inputs, and a batch can only feed the first, '{}'; run it by itself over the "
                        "scans, with a file for '{}'",
                        name, workflow.inputs.size(), workflow.inputs[0].name, workflow.inputs[1].name));
    }

    void complain_of_undeclared() {
        complain_of_undeclared(checked_.batch.settings);
        for (const BatchScan& scan : checked_.batch.scans) complain_of_undeclared(scan.settings);
    }

    void complain_of_undeclared(const Settings& settings) {
        const std::vector<std::string> known(declared_.begin(), declared_.end());
        for (const auto& [name, value] : settings)
            if (!declared_.contains(name))
                batch_diagnostics_.error(
                    value.position, fmt::format("none of the workflows has a parameter '{}'; {}{}", name,
                                                known.empty() ? "they declare none" : "there are " + enumerated(known),
                                                did_you_mean(name, known)));
    }

    const FilterLibrary& library_;
    Diagnostics batch_diagnostics_;
    CheckedBatch checked_;
    std::set<std::string> declared_;
    bool unreadable_ = false;  // a workflow, so what it declares is not known
};

}  // namespace

bool CheckedBatch::has_errors() const { return std::ranges::any_of(diagnostics, &Diagnostics::has_errors); }

std::size_t CheckedBatch::variants() const {
    std::set<std::pair<std::size_t, std::string>> names;
    for (const BatchPart& part : parts)
        for (const PlannedVariant& variant : part.plan->variants) names.emplace(part.workflow, variant.name);
    return names.size();
}

std::size_t CheckedBatch::cells() const {
    std::size_t count = 0;
    for (const BatchPart& part : parts) count += part.plan->variants.size() * part.scans.size();
    return count;
}

CheckedBatch check_batch(const std::string& text, const std::string& file, const FilterLibrary& library) {
    return BatchPlanner(text, file, library).checked();
}

}  // namespace scanmill
