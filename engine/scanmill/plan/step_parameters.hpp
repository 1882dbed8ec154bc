// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Computes the values of a step's parameters, resolves their relative paths, and writes paths for a step's key.

#include <filesystem>
#include <functional>
#include <string>

#include "scanmill/filter/parameter.hpp"
#include "scanmill/filter/spec.hpp"
#include "scanmill/plan/expand.hpp"

namespace scanmill {

/// The value with `folder` put before its relative paths. Words, empty paths and absolute paths stay unchanged.
ParameterValue with_paths_from(const std::filesystem::path& folder, const ParameterValue& value);

/// Whether the parameter of this name is a path.
bool names_files(const FilterSpec& spec, std::string_view parameter);

/// The text of a path parameter in a key. Every path is replaced by its extension, which may decide the format, and its
/// `content_of`. Names and folders are not part of the text.
std::string key_text_of_paths(const ParameterValue& value,
                              const std::function<std::string(const std::filesystem::path&)>& content_of);

/// The settings, and the diagnostics for wrong values.
struct ParameterSources {
    std::string workflow;  ///< path of the file that contains the step
    const Settings& settings;
    Diagnostics& diagnostics;
    /// Problems of the batch that contains the settings; nullptr for settings from the command line.
    Diagnostics* settings_diagnostics;
};

/// The value of every parameter that the filter declares, in its order. A value comes from the step, from a `$name` in
/// the step, or from the default. Relative paths count from the folder of the file that contains them. Reports wrong
/// values and replaces them by the default.
ParameterSet step_parameters(const ExpandedStep& step, const FilterSpec& spec, const ParameterSources& sources);

}  // namespace scanmill
