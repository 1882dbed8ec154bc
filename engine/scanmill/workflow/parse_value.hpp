// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The smallest parts of the grammar: the value of a parameter, and the name of a step or an input.

#include <optional>

#include "scanmill/workflow/workflow.hpp"

namespace scanmill {

/// A value, a list of values, `$name` (also within a list) or `{sweep: [value, …]}`. What is wrong is reported and left
/// out.
ValueExpression value_expression(const YamlNode& node, Diagnostics& diagnostics);

/// "step", "step.port" or an input's name.
std::optional<Reference> reference(const YamlNode& node, Diagnostics& diagnostics);

}  // namespace scanmill
