// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// From a workflow with forks (`one-of`, `sweep`) to its variants: straight lists of steps with every value written
/// out.

#include <map>
#include <string>
#include <vector>

#include "scanmill/engine/workflow.hpp"

namespace scanmill {

/// Values given from outside for workflow parameters: `--set`.
using Settings = std::map<std::string, ValueExpression>;

struct WrittenArgument {
    std::string name;
    Position name_position;
    WrittenParameter value;
    Position value_position;
    std::string reference;  ///< the workflow parameter it came through; empty: none
};

struct ExpandedStep {
    const StepSyntax* syntax;
    std::vector<WrittenArgument> arguments;
    std::vector<std::string> aliases;  ///< ids of the one-of steps whose alternative ends here
};

struct Variant {
    /// Its alternatives and swept values joined by `+`, safe in file names: `tight-cocone+max-error=0.1pctdiag`;
    /// `default` when the workflow has no forks.
    std::string name;
    std::vector<ExpandedStep> steps;
};

/// Every variant, in the order of the file, first fork slowest. Pointers lead into `workflow`. Reports unknown
/// parameters and variants of equal names.
std::vector<Variant> expand(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics);

}  // namespace scanmill
