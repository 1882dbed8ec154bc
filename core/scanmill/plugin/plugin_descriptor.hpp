// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The data that every filter or format module exports: plain C data, compared before the module is called.

#include <Eigen/Core>
#include <string>

#define SCANMILL_TEXT_OF(x) #x
#define SCANMILL_TEXT(x) SCANMILL_TEXT_OF(x)
#if defined(__SANITIZE_ADDRESS__)
#define SCANMILL_ABI_SANITIZER " address-sanitizer"
#elif defined(__SANITIZE_THREAD__)
#define SCANMILL_ABI_SANITIZER " thread-sanitizer"
#else
#define SCANMILL_ABI_SANITIZER ""
#endif
#if defined(_GLIBCXX_DEBUG)
#define SCANMILL_ABI_DEBUG " debug"
#else
#define SCANMILL_ABI_DEBUG ""
#endif
/// Everything that must be equal in program and module for C++ objects to pass between them. SCANMILL_HEADERS, a hash
/// of all headers of this library, comes from the build: with Scanmill::core of the installed package, or from
/// scanmill_add_filter().
#define SCANMILL_ABI_TEXT                                                                                         \
    "scanmill " SCANMILL_VERSION ", compiler abi " SCANMILL_TEXT(__GXX_ABI_VERSION) ", libstdc++ " SCANMILL_TEXT( \
        _GLIBCXX_RELEASE) " strings " SCANMILL_TEXT(_GLIBCXX_USE_CXX11_ABI) SCANMILL_ABI_DEBUG                    \
        ", headers " SCANMILL_HEADERS                                                                             \
        ", c++ " SCANMILL_TEXT(__cplusplus) ", eigen " SCANMILL_TEXT(EIGEN_WORLD_VERSION) "." SCANMILL_TEXT(      \
            EIGEN_MAJOR_VERSION) " aligned to " SCANMILL_TEXT(EIGEN_MAX_STATIC_ALIGN_BYTES) SCANMILL_ABI_SANITIZER

namespace scanmill {

inline constexpr const char* plugin_symbol = "scanmill_plugin";

/// The layout of this struct never changes.
struct PluginDescriptor {
    char magic[16];
    const char* abi;
    const char* name;
    /// Assigns to *declaration, whose type follows from magic. Called only if magic, abi and name match.
    void (*declare)(void* declaration);
};

}  // namespace scanmill

/// Defines the descriptor; the body after it returns the Declaration.
#define SCANMILL_MODULE(magic, name, Declaration)                                                       \
    static Declaration scanmill_declaration();                                                          \
    extern "C" __attribute__((visibility("default"))) const scanmill::PluginDescriptor scanmill_plugin; \
    constinit const scanmill::PluginDescriptor scanmill_plugin{                                         \
        magic, SCANMILL_ABI_TEXT, name,                                                                 \
        [](void* declaration) { *static_cast<Declaration*>(declaration) = scanmill_declaration(); }};   \
    static Declaration scanmill_declaration()
