// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a format in a loadable module says of itself: enough to recognise its files and to list it without loading its
/// code. The manifest beside the module holds it as JSON.

#include <string>
#include <string_view>
#include <vector>

#include "scanmill/kinds/value.hpp"

namespace scanmill {

struct FormatSpec {
    std::string name;  ///< "PCD"
    /// Lower case, without the dot; the first is the one to propose.
    std::vector<std::string> extensions;
    /// A file that begins with one of these is certainly of this format.
    std::vector<std::string> begins;
    std::vector<Kind> writes;
    /// False for a format that is written for other programs and not read.
    bool reads = true;

    bool operator==(const FormatSpec&) const = default;
};

struct FormatManifest {
    std::string abi;
    FormatSpec spec;
};

/// Indented JSON with a trailing newline; reading it back gives an equal manifest.
std::string to_json_text(const FormatManifest& manifest);
/// Throws Error saying what is wrong with the text.
FormatManifest parse_format_manifest(std::string_view text);

}  // namespace scanmill
