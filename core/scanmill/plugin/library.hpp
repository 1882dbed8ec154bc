// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The available filters. Manifests are read from the module folders; modules are loaded on first use.
///
/// Folders are searched in order; the first module of a name is used. An unusable manifest is kept with the reason; it
/// is an error only for a workflow that uses the filter. Not thread-safe.

#include <filesystem>
#include <map>
#include <string>
#include <vector>

#include "scanmill/filter/declare.hpp"
#include "scanmill/plugin/manifest.hpp"
#include "scanmill/plugin/module.hpp"

namespace scanmill {

/// The folder of the installed modules, then the folders in SCANMILL_PLUGIN_PATH (separated by colons). Entries that
/// are not absolute are ignored, because they depend on the working folder; `ignored` receives them.
std::vector<std::filesystem::path> plugin_folders(std::vector<std::string>* ignored = nullptr);

struct UnusableModule {
    std::string name;  ///< from the file's name
    std::filesystem::path manifest;
    std::string reason;
};

class FilterLibrary {
public:
    explicit FilterLibrary(const std::vector<std::filesystem::path>& folders);

    /// nullptr if there is no usable filter of that name.
    const FilterSpec* find(std::string_view name) const;
    /// The names of the usable filters, sorted.
    std::vector<std::string> names() const;
    const std::vector<UnusableModule>& unusable() const { return unusable_; }
    /// The module's file. Pre: find(name).
    const std::filesystem::path& module_file(std::string_view name) const;
    /// Content hash of the module, computed once. Pre: find(name).
    const std::string& build_id(std::string_view name);
    /// Loads the module on first use. Throws Error if it cannot be loaded or differs from its manifest.
    /// Pre: find(name).
    const FilterDeclaration& load(std::string_view name);

private:
    struct Entry {
        Manifest manifest;
        std::filesystem::path module;
        std::string build_id;
        FilterDeclaration declaration;
    };
    Entry& entry(std::string_view name);
    void read_folder(const std::filesystem::path& folder);

    std::map<std::string, Entry, std::less<>> entries_;
    std::vector<UnusableModule> unusable_;
};

}  // namespace scanmill
