// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/library.hpp"

#include <algorithm>
#include <cassert>
#include <cstdlib>
#include <fstream>
#include <sstream>

#include "scanmill/base/error.hpp"
#include "scanmill/base/hash.hpp"
#include "scanmill/plugin/module.hpp"

namespace scanmill {

namespace {

Manifest read_manifest(const std::filesystem::path& file, const std::string& name) {
    std::ifstream stream(file, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw Error("cannot be read");
    Manifest manifest = parse_manifest(text.str());
    require_sound(manifest.spec);
    if (manifest.spec.name != name) throw Error("describes the filter '{}'", manifest.spec.name);
    if (manifest.abi != abi_text())
        throw Error("was built for another program: it needs '{}', this is '{}'", manifest.abi, abi_text());
    return manifest;
}

}  // namespace

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
            entry.manifest = read_manifest(file, name);
            entry.module = std::filesystem::path(file).replace_extension(".so");
            if (!std::filesystem::exists(entry.module)) throw Error("has no module beside it");
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
    std::vector<std::string> names;
    for (const auto& [name, entry] : entries_) names.push_back(name);
    return names;
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
        if (!(declaration.spec == found.manifest.spec))
            throw Error("module '{}' differs from the manifest beside it", found.module.string())
                .hint("build or install the module again; its manifest is written then");
        found.declaration = std::move(declaration);
    }
    return found.declaration;
}

}  // namespace scanmill
