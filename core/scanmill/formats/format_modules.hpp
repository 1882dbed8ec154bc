// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Formats whose libraries are heavy live in modules of their own. Their manifests are read when formats are first
/// asked for; a module is loaded when a file needs it.

#include "scanmill/formats/format_plugin.hpp"

namespace scanmill {

/// Loads the module of the format whose file is scanmill-<name>.so. Throws Error as open_module(), when the declaration
/// throws, and when it lacks a reader or a writer that it announces or has one more.
FormatDeclaration load_format_module(const std::filesystem::path& module, const std::string& name);

/// The rows of the modules in the folder, sorted by name. One whose manifest or module cannot be used stays in the
/// table: a file of its extension is told why.
std::vector<Format> format_modules(const std::filesystem::path& folder);

}  // namespace scanmill
