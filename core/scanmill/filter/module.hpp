// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Loading one filter's module. A loaded module stays loaded: values it made may outlive everything else.

#include <filesystem>

#include "scanmill/filter/declare.hpp"

namespace scanmill {

/// Loads the module and returns what it declares. Throws Error naming the file: not a module, one cut short, another
/// ABI (both texts), another name than `expected_name`, or whatever its declaration threw.
FilterDeclaration load_module(const std::filesystem::path& module, const std::string& expected_name);

/// The ABI text that this program was built with.
std::string abi_text();

/// 128-bit content hash of a file as 32 hexadecimal digits: what tells one build of a module from another.
std::string content_hash(const std::filesystem::path& file);

/// The file that holds this library's code, and the folder of modules that belongs to it.
std::filesystem::path core_library_file();
std::filesystem::path installed_plugin_folder();

}  // namespace scanmill
