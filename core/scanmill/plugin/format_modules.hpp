// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The interface between the program and the module of a file format, like plugin.hpp for filters. Formats with heavy
/// libraries are modules. Manifests are read when formats are first listed; a module is loaded when a file needs it.
///
///     SCANMILL_FORMAT() { return {{"PCD", {"pcd"}, {"# .PCD"}, {kind_of<PointCloud>()}}, read_pcd,
///     {{kind_of<PointCloud>(), write_pcd}}}; }

#include "scanmill/formats/common/format.hpp"
#include "scanmill/plugin/manifest.hpp"
#include "scanmill/plugin/plugin_descriptor.hpp"

namespace scanmill {

struct FormatDeclaration {
    FormatSpec spec;
    Format::Read read;  ///< empty if the format is not read
    std::vector<std::pair<Kind, Format::Write>> writers;  ///< one for each kind of spec.writes
    Format::MayStream may_stream = {};  ///< both empty if the format is not streamed
    Format::OpenStream open_stream = {};
    std::function<u32(std::string_view file)> count_views = {};  ///< see Format::count_views; only if spec.has_views
};

/// Loads the module scanmill-<name>.so. Throws Error under the conditions of load_declaration(), and if its functions
/// differ from those in the spec.
FormatDeclaration load_format_module(const std::filesystem::path& module, const std::string& name);

/// The rows of the modules in the folder, sorted by name. An unusable module has a row, too: reading a file with its
/// extension throws Error with the reason.
std::vector<Format> format_modules(const std::filesystem::path& folder);

}  // namespace scanmill

/// Use it exactly once per module; its body returns the declaration. SCANMILL_FORMAT_NAME comes from
/// scanmill_add_format().
#define SCANMILL_FORMAT() SCANMILL_MODULE("scanmill-format", SCANMILL_FORMAT_NAME, scanmill::FormatDeclaration)
