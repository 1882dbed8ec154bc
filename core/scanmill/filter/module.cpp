// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/module.hpp"
#include "scanmill/filter/counted.hpp"

#include <dlfcn.h>
#include <link.h>
#include <xxhash.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <fstream>
#include <memory>
#include <vector>

#include "scanmill/filter/error.hpp"
#include "scanmill/filter/module_trial.hpp"
#include "scanmill/filter/plugin.hpp"

namespace scanmill {

namespace {

constexpr std::string_view module_prefix = "scanmill-";

/// The loader maps what a library's header promises; where the file ends earlier, the first touch ends the program. So
/// a file that was cut short is refused before the loader sees it. What is no library at all is left to the loader.
void require_whole(const std::filesystem::path& module) {
    std::ifstream stream(module, std::ios::binary);
    ElfW(Ehdr) header{};
    if (!stream.read(reinterpret_cast<char*>(&header), sizeof header)) return;
    if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0 || header.e_phentsize != sizeof(ElfW(Phdr))) return;
    std::error_code unknown;
    const std::uintmax_t size = std::filesystem::file_size(module, unknown);
    const auto require = [&](std::uintmax_t begin, std::uintmax_t length) {
        if (unknown || begin > size || length > size - begin)
            throw Error("module '{}' was cut short: it has {} and promises {}", module.string(),
                        counted(size, "byte", "bytes"), begin + length);
    };
    require(header.e_phoff, header.e_phnum * sizeof(ElfW(Phdr)));
    stream.seekg(static_cast<std::streamoff>(header.e_phoff));
    std::vector<ElfW(Phdr)> segments(header.e_phnum);
    stream.read(reinterpret_cast<char*>(segments.data()),
                static_cast<std::streamsize>(segments.size() * sizeof(ElfW(Phdr))));
    for (const ElfW(Phdr) & segment : segments) require(segment.p_offset, segment.p_filesz);
}

}  // namespace

std::string abi_text() { return SCANMILL_ABI_TEXT; }

const PluginDescriptor& open_module(const std::filesystem::path& module, ModuleKind kind,
                                    const std::string& expected_name, FirstLoad first) {
    require_whole(module);
    if (first == FirstLoad::in_a_copy) require_harmless_loading(module);
    // Local: two modules may define the same symbol without meeting.
    void* handle = ::dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);
    if (!handle) throw Error("module '{}' cannot be loaded: {}", module.string(), ::dlerror());
    const auto* descriptor = static_cast<const PluginDescriptor*>(::dlsym(handle, plugin_symbol));
    if (!descriptor) throw Error("module '{}' is no {}: it exports no {}", module.string(), kind.what, plugin_symbol);
    if (const std::string_view magic(descriptor->magic, ::strnlen(descriptor->magic, sizeof descriptor->magic));
        magic != kind.magic)
        throw Error("module '{}' is no {}: its {} begins with '{}'; expected '{}'", module.string(), kind.what,
                    plugin_symbol, magic, kind.magic);
    if (descriptor->abi != abi_text())
        throw Error("module '{}' was built for another program: it needs '{}', this is '{}'", module.string(),
                    descriptor->abi, abi_text())
            .hint("build the module again with this program's headers and compiler");
    if (descriptor->name != expected_name)
        throw Error("module '{}' holds the {} '{}', not '{}'", module.string(), kind.what, descriptor->name,
                    expected_name);
    return *descriptor;
}

void declare(const PluginDescriptor& descriptor, const std::filesystem::path& module, void* declaration) {
    try {
        descriptor.declare(declaration);
    } catch (const std::exception& error) {
        throw Error("module '{}' fails while it declares itself: {}", module.string(), error.what());
    } catch (...) {
        throw Error("module '{}' fails while it declares itself, with an exception of a foreign type", module.string());
    }
}

FilterDeclaration load_module(const std::filesystem::path& module, const std::string& expected_name, FirstLoad first) {
    FilterDeclaration declaration;
    declare(open_module(module, {filter_magic, "filter"}, expected_name, first), module, &declaration);
    if (declaration.spec.name != expected_name)
        throw Error("module '{}' declares the filter '{}', not '{}'", module.string(), declaration.spec.name,
                    expected_name);
    if (!declaration.run) throw Error("module '{}' declares nothing to run", module.string());
    return declaration;
}

std::vector<std::filesystem::path> module_manifests(const std::filesystem::path& folder) {
    std::vector<std::filesystem::path> manifests;
    std::error_code absent;
    for (const auto& file : std::filesystem::directory_iterator(folder, absent))
        if (file.path().extension() == ".json" && file.path().stem().string().starts_with(module_prefix))
            manifests.push_back(file.path());
    std::ranges::sort(manifests);
    return manifests;
}

std::string module_name(const std::filesystem::path& file) { return file.stem().string().substr(module_prefix.size()); }

std::string content_hash(const std::filesystem::path& file) {
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error("'{}' cannot be read", file.string());
    const std::unique_ptr<XXH3_state_t, decltype(&XXH3_freeState)> state(XXH3_createState(), XXH3_freeState);
    XXH3_128bits_reset(state.get());
    std::array<char, 1 << 16> block;
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

std::filesystem::path installed_format_folder() { return core_library_file().parent_path() / SCANMILL_FORMAT_SUBDIR; }

}  // namespace scanmill
