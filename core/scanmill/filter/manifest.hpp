// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A module's manifest: its declaration as JSON, written at build time by the module itself, so that listing, checking
/// and schema generation load no code.

#include <string>
#include <string_view>

#include "scanmill/filter/spec.hpp"

namespace scanmill {

struct Manifest {
    std::string abi;
    FilterSpec spec;

    bool operator==(const Manifest&) const = default;
};

/// Indented JSON with a trailing newline; reading it back gives an equal manifest.
std::string to_json_text(const Manifest& manifest);
/// Throws Error saying what is wrong with the text.
Manifest parse_manifest(std::string_view text);

}  // namespace scanmill
