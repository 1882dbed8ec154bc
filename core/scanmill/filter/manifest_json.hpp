// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the manifests of filters and of file formats have in common as JSON.

#include <cstdint>
#include <nlohmann/json.hpp>
#include <utility>

#include "scanmill/base/error.hpp"

namespace scanmill {

using Json = nlohmann::ordered_json;

/// The member; throws Error naming one that is missing.
inline const Json& field(const Json& json, const char* key) {
    const auto found = json.is_object() ? json.find(key) : json.end();
    if (!json.is_object() || found == json.end()) throw Error("is no manifest: '{}' is missing", key);
    return *found;
}

/// The library would cut 1e300 and 1.5 to what fits.
template <class Whole>
Whole whole_number(const Json& json, const char* key) {
    const Json& number = field(json, key);
    const bool fits = number.is_number_unsigned()  ? std::in_range<Whole>(number.get<std::uint64_t>())
                      : number.is_number_integer() ? std::in_range<Whole>(number.get<std::int64_t>())
                                                   : false;
    if (!fits) throw Error("is no manifest: '{}' is no whole number that fits", key);
    return number.get<Whole>();
}

inline void require_manifest_version(const Json& json, const char* key, int known) {
    if (const int version = whole_number<int>(json, key); version != known)
        throw Error("is a manifest of version {}; this program reads version {}", version, known);
}

}  // namespace scanmill
