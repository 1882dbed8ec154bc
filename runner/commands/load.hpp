// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What several commands begin with: the filters at hand, and a workflow file parsed and checked.

#include <optional>
#include <string>

#include "scanmill/plan/plan.hpp"

namespace scanmill::runner {

/// All usable filters; entries of SCANMILL_PLUGIN_PATH that are passed over are told on stderr.
FilterLibrary open_library();

struct CheckedWorkflow {
    Diagnostics diagnostics;
    Plan plan;  ///< to be run only without errors
};

/// The file; when there is none and it is a bare name, the shipped workflow of that name.
std::string workflow_file(const std::string& file_or_name);

/// Throws Error when the file itself cannot be read.
CheckedWorkflow check_workflow(const std::string& file, const FilterLibrary& library, const Settings& settings);
/// The same of a file that was read already.
CheckedWorkflow check_workflow(const std::string& file, const std::string& text, const FilterLibrary& library,
                               const Settings& settings);

/// NAME=VALUE pairs of --set. Throws Error for what is no such pair.
Settings parse_settings(const std::vector<std::string>& pairs);

/// Throws Error for anything but a unit's symbol; empty is unknown.
LengthUnit parse_unit(const std::string& symbol);

}  // namespace scanmill::runner
