// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `set`: values for the parameters of workflows.

#include "scanmill/plan/expand.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// The values under `set:`; each one's position is that of its name. What is wrong is reported and left out.
Settings parse_settings(const YamlNode& node, Diagnostics& diagnostics);

}  // namespace scanmill
