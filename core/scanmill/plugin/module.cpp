// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/module.hpp"

#include <dlfcn.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <sstream>

#include "scanmill/base/error.hpp"
#include "scanmill/plugin/plugin.hpp"

namespace scanmill {

namespace {

constexpr std::string_view module_prefix = "scanmill-";

/// The module that is being loaded. A static object in it may crash or end this process. The process then writes the
/// module's name to stderr before it ends. The name is global, because signal handlers reach no other state.
std::atomic<const char*> module_being_loaded = nullptr;
constexpr std::array fatal_signals{SIGABRT, SIGBUS, SIGFPE, SIGILL, SIGSEGV};

void name_module_being_loaded() {
    const char* const module = module_being_loaded.exchange(nullptr);
    if (!module) return;
    for (const std::string_view text : {std::string_view("error: this process ended while it loaded the module '"),
                                        std::string_view(module), std::string_view("'\n")})
        if (::write(STDERR_FILENO, text.data(), text.size()) < 0) return;
}

class NamedIfFatal {
public:
    explicit NamedIfFatal(const char* module) {
        static const int registered = std::atexit(name_module_being_loaded);
        static_cast<void>(registered);
        module_being_loaded = module;
        struct sigaction action {};
        action.sa_handler = [](int signal) {
            name_module_being_loaded();
            ::signal(signal, SIG_DFL);
            ::raise(signal);
        };
        for (std::size_t i = 0; i < fatal_signals.size(); ++i) ::sigaction(fatal_signals[i], &action, &before_[i]);
    }
    ~NamedIfFatal() {
        module_being_loaded = nullptr;
        for (std::size_t i = 0; i < fatal_signals.size(); ++i) ::sigaction(fatal_signals[i], &before_[i], nullptr);
    }
    NamedIfFatal(const NamedIfFatal&) = delete;
    NamedIfFatal& operator=(const NamedIfFatal&) = delete;

private:
    std::array<struct sigaction, fatal_signals.size()> before_{};
};

/// Is noexcept, because an exception of a static object's constructor must not pass through the loader.
void* open_library(const std::filesystem::path& module) noexcept {
    const NamedIfFatal named(module.c_str());
    return ::dlopen(module.c_str(), RTLD_NOW | RTLD_LOCAL);  // local: two modules may define the same symbol
}

}  // namespace

std::string abi_text() { return SCANMILL_ABI_TEXT; }

void load_declaration(const std::filesystem::path& module, std::string_view magic, std::string_view noun,
                      const std::string& expected_name, void* declaration) {
    void* handle = open_library(module);
    if (!handle) throw Error("module '{}' cannot be loaded: {}", module.string(), ::dlerror());
    const auto* descriptor = static_cast<const PluginDescriptor*>(::dlsym(handle, plugin_symbol));
    if (!descriptor) throw Error("module '{}' is not a {}: it exports no {}", module.string(), noun, plugin_symbol);
    if (const std::string_view found(descriptor->magic, ::strnlen(descriptor->magic, sizeof descriptor->magic));
        found != magic)
        throw Error("module '{}' is not a {}: its {} begins with '{}'; expected '{}'", module.string(), noun,
                    plugin_symbol, found, magic);
    if (descriptor->abi != abi_text())
        throw Error("module '{}' was built for another program: it needs '{}', this is '{}'", module.string(),
                    descriptor->abi, abi_text())
            .hint("build the module again with this program's headers and compiler");
    if (descriptor->name != expected_name)
        throw Error("module '{}' contains the {} '{}', not '{}'", module.string(), noun, descriptor->name,
                    expected_name);
    try {
        descriptor->declare(declaration);
    } catch (const std::exception& error) {
        throw Error("module '{}' fails while it declares itself: {}", module.string(), error.what());
    } catch (...) {
        throw Error("module '{}' fails while it declares itself, with an exception of a foreign type", module.string());
    }
}

FilterDeclaration load_module(const std::filesystem::path& module, const std::string& expected_name) {
    FilterDeclaration declaration;
    load_declaration(module, "scanmill-filter", "filter", expected_name, &declaration);
    if (declaration.spec.name != expected_name)
        throw Error("module '{}' declares the filter '{}', not '{}'", module.string(), declaration.spec.name,
                    expected_name);
    if (!declaration.run) throw Error("module '{}' declares nothing to run", module.string());
    return declaration;
}

void throw_manifest_differs(const std::filesystem::path& module) {
    throw Error("module '{}' differs from the manifest beside it", module.string())
        .hint("build or install the module again; this also writes its manifest");
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

std::string manifest_text(const std::filesystem::path& manifest) {
    std::ifstream stream(manifest, std::ios::binary);
    std::ostringstream text;
    text << stream.rdbuf();
    if (!stream) throw Error("cannot be read");
    return text.str();
}

std::filesystem::path module_beside(const std::filesystem::path& manifest, const std::string& abi) {
    if (abi != abi_text()) throw Error("was built for another program: it needs '{}', this is '{}'", abi, abi_text());
    std::filesystem::path module = std::filesystem::path(manifest).replace_extension(".so");
    if (!std::filesystem::exists(module)) throw Error("has no module beside it");
    return module;
}

std::string module_name(const std::filesystem::path& file) { return file.stem().string().substr(module_prefix.size()); }

std::filesystem::path core_library_file() {
    Dl_info where{};
    ::dladdr(reinterpret_cast<const void*>(&core_library_file), &where);
    return std::filesystem::weakly_canonical(where.dli_fname);
}

std::filesystem::path installed_plugin_folder() { return core_library_file().parent_path() / SCANMILL_PLUGIN_SUBDIR; }

std::filesystem::path installed_format_folder() { return core_library_file().parent_path() / SCANMILL_FORMAT_SUBDIR; }

}  // namespace scanmill
