// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// One node's work, without the graph around it: read a file into a value, or run a filter on values.

#include "scanmill/engine/run.hpp"
#include "scanmill/filter/ports.hpp"

namespace scanmill {

/// The file's content as the workflow's input declares it. Throws Error.
Value read_leaf(const std::filesystem::path& file, const WorkflowInput& declared, LengthUnit unit,
                const std::function<void(std::string)>& on_warning);

struct StepInput {
    std::string port;
    Value value;
};

/// Runs the filter: inputs brought to one origin, lengths resolved, outputs checked. What it learned goes to `report`
/// even when it throws (Error or Cancelled).
Outputs run_step(const PlannedStep& step, const FilterDeclaration& filter, const std::vector<StepInput>& inputs,
                 ContextOptions options, NodeReport& report);

}  // namespace scanmill
