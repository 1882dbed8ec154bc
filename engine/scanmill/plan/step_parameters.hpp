// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parameters that name files which a filter reads: where they are looked for, and how a step's key knows them.

#include <filesystem>
#include <functional>
#include <string>

#include "scanmill/filter/parameter.hpp"
#include "scanmill/filter/spec.hpp"
#include "scanmill/plan/expand.hpp"
#include "scanmill/workflow/diagnostics.hpp"

namespace scanmill {

/// The value with its relative paths taken from `folder`; words, empty paths and absolute ones stay as they are.
ParameterValue with_paths_from(const std::filesystem::path& folder, const ParameterValue& value);

/// Whether the parameter of this name names files.
bool names_files(const FilterSpec& spec, std::string_view parameter);

/// What a key holds in place of the paths: for every one its extension, which may decide how the file is read, and what
/// `content_of` says of the file, whatever its name and folder.
std::string key_text_of_paths(const ParameterValue& value,
                              const std::function<std::string(const std::filesystem::path&)>& content_of);

// The values that a step's parameters get: what is written there, what a name there stands for, or the default.

/// Where values come from, and who is told what is wrong with them.
struct ParameterSources {
    std::string workflow;
    const Settings& settings;
    Diagnostics& diagnostics;
    /// Of the batch that has the settings; nullptr when they are the command line's.
    Diagnostics* settings_diagnostics;
};

/// In the order of the declaration; relative paths count from the folder of the file that they are written in. What
/// is wrong is told, and the default taken instead.
ParameterSet step_parameters(const ExpandedStep& step, const FilterSpec& spec, const ParameterSources& sources);

}  // namespace scanmill
