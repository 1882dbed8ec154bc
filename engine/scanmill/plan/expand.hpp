// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// From a workflow with forks (`one-of`, `sweep`) to its variants: straight lists of steps with one value for every
/// parameter.

#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scanmill/workflow/diagnostics.hpp"
#include "scanmill/workflow/workflow.hpp"

namespace scanmill {

/// Values given from outside for workflow parameters: `--set`, or a batch's `set`.
using Settings = std::map<std::string, ValueExpression>;

/// The names in `settings` that are no parameters of the workflow.
std::vector<std::string> undeclared(const Settings& settings, const Workflow& workflow);

/// A `$name` in a step, and the value that it stands for. Both lead into the workflow or the settings.
struct ReplacedName {
    const NameUse* use;
    const WrittenValue* value;
};

/// A parameter of a step and the value that this variant takes for it.
struct ChosenArgument {
    const NamedExpression* parameter;
    const WrittenValue* written;  ///< what stands in the step
    WrittenParameter value;       ///< the same with every `$name` replaced
    std::vector<ReplacedName> replaced;
};

struct ExpandedStep {
    const StepSyntax* syntax;
    std::vector<ChosenArgument> arguments;  ///< without those whose value could not be read
    std::vector<std::string> aliases;       ///< ids of the one-of steps whose alternative ends here
};

struct Variant {
    /// Its alternatives and swept values joined by `+`, safe in file names: `tight-cocone+max-error=0.1pctdiag`;
    /// `default` when the workflow has no forks.
    std::string name;
    std::vector<ExpandedStep> steps;
};

/// Calls `visit` with every variant, in the order of the file, first fork slowest. Reports unknown parameters, variants
/// of equal names and workflows of more than 10,000 variants or 500,000 steps in all of them; of those it visits only
/// as many as show every alternative and every swept value once, so that what is wrong in them is found too. Costs
/// variants × steps, and the memory of one variant.
void expand(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics,
            const std::function<void(const Variant&)>& visit);

// Whether what a workflow calls by `$name` is there.

/// Every `$name` of the steps must be declared, and be a single value in a list. So must every setting. Every declared
/// one should be mentioned in the file.
void check_references(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics);

}  // namespace scanmill
