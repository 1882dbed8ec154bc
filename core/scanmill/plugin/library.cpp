// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/library.hpp"

#include <cassert>
#include <cstdlib>
#include <ranges>
#include <sstream>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/plugin/module.hpp"

namespace scanmill {

std::vector<std::filesystem::path> plugin_folders(std::vector<std::string>* ignored) {
    std::vector<std::filesystem::path> folders{installed_plugin_folder()};
    const char* variable = std::getenv("SCANMILL_PLUGIN_PATH");
    std::istringstream entries(variable ? variable : "");
    for (std::string entry; std::getline(entries, entry, ':');) {
        if (std::filesystem::path(entry).is_absolute())
            folders.emplace_back(entry);
        else if (!entry.empty() && ignored)
            ignored->push_back(entry);
    }
    return folders;
}

FilterLibrary::FilterLibrary(const std::vector<std::filesystem::path>& folders) {
    for (const std::filesystem::path& folder : folders) read_folder(folder);
}

void FilterLibrary::read_folder(const std::filesystem::path& folder) {
    for (const std::filesystem::path& file : module_manifests(folder)) {
        const std::string name = module_name(file);
        if (entries_.contains(name)) continue;
        try {
            Entry entry;
            entry.manifest = parse_manifest(manifest_text(file));
            require_sound(entry.manifest.spec);
            if (entry.manifest.spec.name != name) throw Error("describes the filter '{}'", entry.manifest.spec.name);
            entry.module = module_beside(file, entry.manifest.abi);
            entries_.emplace(name, std::move(entry));
        } catch (const Error& error) {
            unusable_.push_back({name, file, error.sentence()});
        }
    }
}

const FilterSpec* FilterLibrary::find(std::string_view name) const {
    const auto found = entries_.find(name);
    return found == entries_.end() ? nullptr : &found->second.manifest.spec;
}

std::vector<std::string> FilterLibrary::names() const {
    const auto names = entries_ | std::views::keys;
    return {names.begin(), names.end()};
}

FilterLibrary::Entry& FilterLibrary::entry(std::string_view name) {
    const auto found = entries_.find(name);
    assert(found != entries_.end());
    return found->second;
}

const std::filesystem::path& FilterLibrary::module_file(std::string_view name) const {
    const auto found = entries_.find(name);
    assert(found != entries_.end());
    return found->second.module;
}

const std::string& FilterLibrary::build_id(std::string_view name) {
    Entry& found = entry(name);
    if (found.build_id.empty()) found.build_id = content_hash(found.module);
    return found.build_id;
}

const FilterDeclaration& FilterLibrary::load(std::string_view name) {
    Entry& found = entry(name);
    if (!found.declaration.run) {
        FilterDeclaration declaration = load_module(found.module, std::string(name));
        if (declaration.spec != found.manifest.spec) throw_manifest_differs(found.module);
        found.declaration = std::move(declaration);
    }
    return found.declaration;
}

}  // namespace scanmill
