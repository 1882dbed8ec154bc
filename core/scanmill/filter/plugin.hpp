// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The border between the program and a filter's module.
///
/// A module exports one symbol of plain C data. The program compares magic, ABI text and name before it calls anything;
/// only then does it ask the module for its declaration, and from there on both speak C++.
///
///     SCANMILL_FILTER() { return Declare<MyParams>("my-filter", 1)….run(…); }

#include "scanmill/filter/declare.hpp"

#define SCANMILL_TEXT_OF(x) #x
#define SCANMILL_TEXT(x) SCANMILL_TEXT_OF(x)
#if defined(__SANITIZE_ADDRESS__)
#define SCANMILL_ABI_SANITIZER " address-sanitizer"
#elif defined(__SANITIZE_THREAD__)
#define SCANMILL_ABI_SANITIZER " thread-sanitizer"
#else
#define SCANMILL_ABI_SANITIZER ""
#endif
/// Everything that must agree for C++ objects to cross the border.
#define SCANMILL_ABI_TEXT \
    "scanmill " SCANMILL_VERSION ", compiler abi " SCANMILL_TEXT(__GXX_ABI_VERSION) ", libstdc++ "  \
    SCANMILL_TEXT(_GLIBCXX_RELEASE) ", c++ " SCANMILL_TEXT(__cplusplus) ", eigen "                  \
    SCANMILL_TEXT(EIGEN_WORLD_VERSION) "." SCANMILL_TEXT(EIGEN_MAJOR_VERSION) " aligned to "        \
    SCANMILL_TEXT(EIGEN_MAX_STATIC_ALIGN_BYTES) SCANMILL_ABI_SANITIZER

namespace scanmill {

inline constexpr char plugin_magic[16] = "scanmill-filter";
inline constexpr const char* plugin_symbol = "scanmill_plugin";

/// Plain C data: its layout never changes.
struct PluginDescriptor {
    char magic[16];
    const char* abi;
    const char* name;
    /// Writes the declaration into *declaration. Called only when magic, abi and name are right.
    void (*declare)(FilterDeclaration* declaration);
};

}  // namespace scanmill

/// Exactly once per module; its body returns the declaration. SCANMILL_FILTER_NAME comes from scanmill_add_filter().
#define SCANMILL_FILTER()                                                                                \
    static scanmill::FilterDeclaration scanmill_filter_declaration();                                    \
    extern "C" __attribute__((visibility("default"))) const scanmill::PluginDescriptor scanmill_plugin;  \
    constinit const scanmill::PluginDescriptor scanmill_plugin{                                          \
        "scanmill-filter", SCANMILL_ABI_TEXT, SCANMILL_FILTER_NAME,                                      \
        [](scanmill::FilterDeclaration* declaration) { *declaration = scanmill_filter_declaration(); }}; \
    static scanmill::FilterDeclaration scanmill_filter_declaration()
