// SPDX-License-Identifier: GPL-3.0-or-later
#include "fuzz/targets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/plugin/manifest.hpp"

namespace scanmill::test {

bool check_manifest(std::string_view bytes) {
    try {
        const Manifest manifest = parse_manifest(bytes);
        require_sound(manifest.spec);
        require_law(parse_manifest(to_json_text(manifest)) == manifest, "a manifest that reads back changed");
        return true;
    } catch (const Error&) {
        return false;
    }
}

bool check_format_manifest(std::string_view bytes) {
    try {
        const FormatManifest manifest = parse_format_manifest(bytes);
        const FormatManifest again = parse_format_manifest(to_json_text(manifest));
        require_law(again.abi == manifest.abi && again.spec == manifest.spec, "a manifest that reads back changed");
        return true;
    } catch (const Error&) {
        return false;
    }
}

}  // namespace scanmill::test
