// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The border between the program and a filter's module.
///
/// A module exports one symbol of plain C data. The program compares magic, ABI text and name before it calls anything;
/// only then does it ask the module for its declaration, and from there on both speak C++.
///
///     SCANMILL_FILTER() { return Declare<MyParams>("my-filter", 1)….run(…); }

#include "scanmill/filter/declare.hpp"
#include "scanmill/plugin/plugin_descriptor.hpp"

namespace scanmill {

inline constexpr char filter_magic[16] = "scanmill-filter";

}  // namespace scanmill

/// Exactly once per module; its body returns the declaration. SCANMILL_FILTER_NAME comes from scanmill_add_filter().
#define SCANMILL_FILTER()                                                                               \
    static scanmill::FilterDeclaration scanmill_filter_declaration();                                   \
    extern "C" __attribute__((visibility("default"))) const scanmill::PluginDescriptor scanmill_plugin; \
    constinit const scanmill::PluginDescriptor scanmill_plugin{                                         \
        "scanmill-filter", SCANMILL_ABI_TEXT, SCANMILL_FILTER_NAME, [](void* declaration) {             \
            *static_cast<scanmill::FilterDeclaration*>(declaration) = scanmill_filter_declaration();    \
        }};                                                                                             \
    static scanmill::FilterDeclaration scanmill_filter_declaration()
