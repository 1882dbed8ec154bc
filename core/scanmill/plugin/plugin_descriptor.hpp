// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What every module exports, whether it holds a filter or a file format: plain C data that is compared before anything
/// in the module is called.

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
/// Everything that must agree for C++ objects to cross the border. SCANMILL_HEADERS, a hash of all headers of this
/// library, comes from the build: with Scanmill::core of the installed package, or from scanmill_add_filter().
#define SCANMILL_ABI_TEXT                                                                                         \
    "scanmill " SCANMILL_VERSION ", compiler abi " SCANMILL_TEXT(__GXX_ABI_VERSION) ", libstdc++ " SCANMILL_TEXT( \
        _GLIBCXX_RELEASE) " strings " SCANMILL_TEXT(_GLIBCXX_USE_CXX11_ABI) SCANMILL_ABI_DEBUG                    \
        ", headers " SCANMILL_HEADERS                                                                             \
        ", c++ " SCANMILL_TEXT(__cplusplus) ", eigen " SCANMILL_TEXT(EIGEN_WORLD_VERSION) "." SCANMILL_TEXT(      \
            EIGEN_MAJOR_VERSION) " aligned to " SCANMILL_TEXT(EIGEN_MAX_STATIC_ALIGN_BYTES) SCANMILL_ABI_SANITIZER

namespace scanmill {

inline constexpr const char* plugin_symbol = "scanmill_plugin";

/// Its layout never changes.
struct PluginDescriptor {
    char magic[16];
    const char* abi;
    const char* name;
    /// Writes into *declaration, whose type the magic says. Called only when magic, abi and name are right.
    void (*declare)(void* declaration);
};

}  // namespace scanmill
