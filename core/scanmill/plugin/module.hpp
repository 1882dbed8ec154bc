// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Loads one module. A loaded module is never unloaded, because values that it created may outlive all other objects.

#include <filesystem>

#include "scanmill/filter/declare.hpp"
#include "scanmill/plugin/plugin_descriptor.hpp"

namespace scanmill {

/// Loads the module and writes its declaration to `declaration`, whose type follows from `magic`. `noun` is the word
/// for such a module in messages: "filter". Throws Error with the file's name for a file that is not a module, another
/// magic, another ABI text (the message contains both texts), another name, and any exception while the module declares
/// itself.
///
/// A module may crash or end the process while it is loaded; the process then first writes the module's name to stderr.
/// Only workers load the modules of a run.
void load_declaration(const std::filesystem::path& module, std::string_view magic, std::string_view noun,
                      const std::string& expected_name, void* declaration);

/// The declaration of a filter's module. Throws Error under the conditions of load_declaration().
FilterDeclaration load_module(const std::filesystem::path& module, const std::string& expected_name);
/// Throws Error because the module at this path differs from its manifest. The hint states how to repair this.
[[noreturn]] void throw_manifest_differs(const std::filesystem::path& module);

/// The manifests in a folder of modules, scanmill-<name>.json, sorted; none if there is no such folder.
std::vector<std::filesystem::path> module_manifests(const std::filesystem::path& folder);
std::string manifest_text(const std::filesystem::path& manifest);
/// The module beside a manifest. Throws Error if the manifest's ABI text is not that of this program, or if there is no
/// module.
std::filesystem::path module_beside(const std::filesystem::path& manifest, const std::string& abi);
/// The <name> of scanmill-<name>.json or scanmill-<name>.so.
std::string module_name(const std::filesystem::path& file);

/// The ABI text that this program was built with.
std::string abi_text();

/// The file of this library, and the module folders installed with it.
std::filesystem::path core_library_file();
std::filesystem::path installed_plugin_folder();
std::filesystem::path installed_format_folder();

}  // namespace scanmill
