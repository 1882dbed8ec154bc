// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The manifest of a module: its declaration as JSON, written at build time beside the module. Listing, checking and
/// schema generation therefore load no code.

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/filter/spec.hpp"

namespace scanmill {

/// The declaration of a filter's module.
struct Manifest {
    std::string abi;
    FilterSpec spec;

    bool operator==(const Manifest&) const = default;
};
constexpr auto fields(const Manifest*) {
    return std::tuple{field("abi", &Manifest::abi), field("spec", &Manifest::spec).flat()};
}

struct FormatSpec {
    std::string name;  ///< "PCD"
    /// Lower case, without the dot. The first extension is proposed to users.
    std::vector<std::string> extensions;
    /// Beginnings of files: a file with one of these beginnings is certainly of this format. In the manifest, each
    /// character of a beginning is one byte, U+0000 to U+00FF.
    std::vector<std::string> begins;
    std::vector<Kind> writes;
    /// False for a format that is only written, for other programs.
    bool reads = true;
    /// Whether files can be read piece by piece, see Format::open_stream.
    bool streams = false;
    /// See Format::memory_per_byte. The default is that of PCD; it is too low for compressed formats.
    double memory_per_byte = 8;
    /// Whether a file may hold several views (see Format::count_views).
    bool has_views = false;

    bool operator==(const FormatSpec&) const = default;
};
constexpr auto fields(const FormatSpec*) {
    using T = FormatSpec;
    return std::tuple{field("name", &T::name),
                      field("extensions", &T::extensions),
                      field("begins", &T::begins),
                      field("writes", &T::writes),
                      field("reads", &T::reads),
                      field("streams", &T::streams),
                      field("memory-per-byte", &T::memory_per_byte),
                      field("has-views", &T::has_views)};
}

/// The declaration of a file format's module.
struct FormatManifest {
    std::string abi;
    FormatSpec spec;
};
constexpr auto fields(const FormatManifest*) {
    return std::tuple{field("abi", &FormatManifest::abi), field("spec", &FormatManifest::spec).flat()};
}

/// Indented JSON with a trailing newline, which reads back to an equal manifest.
std::string to_json_text(const Manifest& manifest);
std::string to_json_text(const FormatManifest& manifest);
/// Parse a manifest. Throw Error with the reason if the text is not a valid manifest.
Manifest parse_manifest(std::string_view text);
FormatManifest parse_format_manifest(std::string_view text);

/// A filter's declaration in the JSON form of its manifest, for other programs.
nlohmann::ordered_json declaration_json(const FilterSpec& spec);
nlohmann::ordered_json declaration_schema();

}  // namespace scanmill
