// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The border between the program and the module of a file format: as that of filters (filter/plugin.hpp), with a
/// declaration of its own.
///
///     SCANMILL_FORMAT() { return {{"PCD", {"pcd"}, {"# .PCD"}, {Kind::points}}, read_pcd, {{Kind::points,
///     write_pcd}}}; }

#include "scanmill/filter/plugin_descriptor.hpp"
#include "scanmill/formats/format.hpp"
#include "scanmill/formats/format_spec.hpp"

namespace scanmill {

inline constexpr char format_magic[16] = "scanmill-format";

struct FormatDeclaration {
    FormatSpec spec;
    Format::Read read;  ///< empty when the spec says that the format is not read
    std::vector<std::pair<Kind, Format::Write>> writers;  ///< one for each kind of spec.writes
};

}  // namespace scanmill

/// Exactly once per module; its body returns the declaration. SCANMILL_FORMAT_NAME comes from scanmill_add_format().
#define SCANMILL_FORMAT()                                                                               \
    static scanmill::FormatDeclaration scanmill_format_declaration();                                   \
    extern "C" __attribute__((visibility("default"))) const scanmill::PluginDescriptor scanmill_plugin; \
    constinit const scanmill::PluginDescriptor scanmill_plugin{                                         \
        "scanmill-format", SCANMILL_ABI_TEXT, SCANMILL_FORMAT_NAME, [](void* declaration) {             \
            *static_cast<scanmill::FormatDeclaration*>(declaration) = scanmill_format_declaration();    \
        }};                                                                                             \
    static scanmill::FormatDeclaration scanmill_format_declaration()
