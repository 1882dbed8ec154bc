// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The border between the program and the module of a file format: as that of filters (filter/plugin.hpp), with a
/// declaration of its own.
///
///     SCANMILL_FORMAT() { return {{"PCD", {"pcd"}, {"# .PCD"}, {kind_of<PointCloud>()}}, read_pcd,
///     {{kind_of<PointCloud>(), write_pcd}}}; }

#include "scanmill/formats/common/format.hpp"
#include "scanmill/plugin/format_manifest.hpp"
#include "scanmill/plugin/plugin_descriptor.hpp"

namespace scanmill {

inline constexpr char format_magic[16] = "scanmill-format";

struct FormatDeclaration {
    FormatSpec spec;
    Format::Read read;  ///< empty when the spec says that the format is not read
    std::vector<std::pair<Kind, Format::Write>> writers;  ///< one for each kind of spec.writes
};

// Formats whose libraries are heavy live in modules of their own. Their manifests are read when formats are first
// asked for; a module is loaded when a file needs it.

/// Loads the module of the format whose file is scanmill-<name>.so. Throws Error as open_module(), when the declaration
/// throws, and when it lacks a reader or a writer that it announces or has one more.
FormatDeclaration load_format_module(const std::filesystem::path& module, const std::string& name);

/// The rows of the modules in the folder, sorted by name. One whose manifest or module cannot be used stays in the
/// table: a file of its extension is told why.
std::vector<Format> format_modules(const std::filesystem::path& folder);

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
