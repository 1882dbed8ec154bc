// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/module.hpp"

#include <dlfcn.h>
#include <xxhash.h>

#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/plugin.hpp"

namespace scanmill {

std::string abi_text() { return SCANMILL_ABI_TEXT; }

FilterDeclaration load_module(const std::filesystem::path& module, const std::string& expected_name) {
    // Local: two modules may define the same symbol without meeting.
    void* handle = ::dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) throw Error("module '{}' cannot be loaded: {}", module.string(), ::dlerror());
    const auto* descriptor = static_cast<const PluginDescriptor*>(::dlsym(handle, plugin_symbol));
    if (!descriptor || std::memcmp(descriptor->magic, plugin_magic, sizeof plugin_magic) != 0)
        throw Error("module '{}' is no filter: it exports no {}", module.string(), plugin_symbol);
    if (descriptor->abi != abi_text())
        throw Error("module '{}' was built for another program: it needs '{}', this is '{}'", module.string(),
                    descriptor->abi, abi_text())
            .hint("build the module again with this program's headers and compiler");
    if (descriptor->name != expected_name)
        throw Error("module '{}' holds the filter '{}', not '{}'", module.string(), descriptor->name, expected_name);
    FilterDeclaration declaration;
    try {
        descriptor->declare(&declaration);
    } catch (const std::exception& error) {
        throw Error("module '{}' fails while it declares itself: {}", module.string(), error.what());
    }
    if (declaration.spec.name != expected_name)
        throw Error("module '{}' declares the filter '{}', not '{}'", module.string(), declaration.spec.name, expected_name);
    if (!declaration.run) throw Error("module '{}' declares nothing to run", module.string());
    return declaration;
}

std::string content_hash(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error("'{}' cannot be read", file.string());
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_128bits_reset(state.get());
    std::vector<char> block(std::size_t(1) << 20);
    while (stream.read(block.data(), static_cast<std::streamsize>(block.size())), stream.gcount() > 0)
        XXH3_128bits_update(state.get(), block.data(), static_cast<std::size_t>(stream.gcount()));
    if (stream.bad()) throw Error("'{}' cannot be read to its end", file.string());
    const XXH128_hash_t hash = XXH3_128bits_digest(state.get());
    return fmt::format("{:016x}{:016x}", hash.high64, hash.low64);
}

std::filesystem::path core_library_file() {
    Dl_info where{};
    ::dladdr(reinterpret_cast<const void*>(&core_library_file), &where);
    return std::filesystem::weakly_canonical(where.dli_fname);
}

std::filesystem::path installed_plugin_folder() { return core_library_file().parent_path() / SCANMILL_PLUGIN_SUBDIR; }

}  // namespace scanmill
