// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Loading one module. A loaded module stays loaded: values it made may outlive everything else.

#include <filesystem>

#include "scanmill/filter/declare.hpp"
#include "scanmill/plugin/plugin_descriptor.hpp"

namespace scanmill {

/// What kind of module is expected: the descriptor's magic, and the word for it in messages.
struct ModuleKind {
    const char* magic;
    std::string_view what;  ///< "filter"
};

/// Loads the module and returns its descriptor, whose declare() may then be called. Throws Error naming the file: not a
/// module, of another kind, of another ABI (both texts), of another name. A module may crash or end the process while
/// it is loaded; then the process writes the module's name to stderr first. Only workers load the modules of a run.
const PluginDescriptor& open_module(const std::filesystem::path& module, ModuleKind kind,
                                    const std::string& expected_name);

/// Calls the descriptor's declare(). Whatever it throws becomes an Error that names the module.
void declare(const PluginDescriptor& descriptor, const std::filesystem::path& module, void* declaration);

/// Loads a filter's module and returns what it declares. Throws Error as open_module() and declare().
FilterDeclaration load_module(const std::filesystem::path& module, const std::string& expected_name);

/// The manifests in a folder of modules, scanmill-<name>.json, sorted; none when the folder is not there.
std::vector<std::filesystem::path> module_manifests(const std::filesystem::path& folder);
/// The <name> of scanmill-<name>.json or scanmill-<name>.so.
std::string module_name(const std::filesystem::path& file);

/// The ABI text that this program was built with.
std::string abi_text();

/// The file that holds this library's code, and the folders of modules that belong to it.
std::filesystem::path core_library_file();
std::filesystem::path installed_plugin_folder();
std::filesystem::path installed_format_folder();

}  // namespace scanmill
