// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The values of a step's parameters, and parameters that name files: their folder, and their form in a step's key.

#include <filesystem>
#include <functional>
#include <string>

#include "scanmill/filter/parameter.hpp"
#include "scanmill/filter/spec.hpp"
#include "scanmill/plan/expand.hpp"

namespace scanmill {

/// The value with its relative paths taken from `folder`; words, empty paths and absolute ones stay unchanged.
ParameterValue with_paths_from(const std::filesystem::path& folder, const ParameterValue& value);

/// Whether the parameter of this name is a path.
bool names_files(const FilterSpec& spec, std::string_view parameter);

/// The text of a path parameter in a key: every path's extension, which may decide the format, and its `content_of`,
/// without name and folder.
std::string key_text_of_paths(const ParameterValue& value,
                              const std::function<std::string(const std::filesystem::path&)>& content_of);

/// The settings, and the diagnostics for wrong values.
struct ParameterSources {
    std::string workflow;  ///< the file
    const Settings& settings;
    Diagnostics& diagnostics;
    /// Problems of the batch that contains the settings; nullptr for settings from the command line.
    Diagnostics* settings_diagnostics;
};

/// The step's values in the order of the declaration: written in the step, by `$name`, or the default. Relative paths
/// count from the folder of the file that contains them. Wrong values are reported and replaced by the default.
ParameterSet step_parameters(const ExpandedStep& step, const FilterSpec& spec, const ParameterSources& sources);

}  // namespace scanmill
