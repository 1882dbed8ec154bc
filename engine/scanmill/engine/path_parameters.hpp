// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parameters that name files which a filter reads: where they are looked for, and how a step's key knows them.

#include <filesystem>
#include <functional>
#include <string>

#include "scanmill/filter/parameter.hpp"
#include "scanmill/filter/spec.hpp"

namespace scanmill {

/// The value with its relative paths taken from `folder`; words, empty paths and absolute ones stay as they are.
ParameterValue with_paths_from(const std::filesystem::path& folder, const ParameterValue& value);

/// Whether the parameter of this name names files.
bool names_files(const FilterSpec& spec, std::string_view parameter);

/// What a key holds in place of the paths: for every one its extension, which may decide how the file is read, and what
/// `content_of` says of the file, whatever its name and folder.
std::string key_text_of_paths(const ParameterValue& value,
                              const std::function<std::string(const std::filesystem::path&)>& content_of);

}  // namespace scanmill
