// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the JSON Schemas of workflows and of batches have in common.

#include <nlohmann/json.hpp>

namespace scanmill::schema {

using Json = nlohmann::ordered_json;

inline constexpr const char* name_pattern = "^[A-Za-z][A-Za-z0-9_-]*$";

Json name_of(const char* description);

/// Any scalar is a text in YAML, quoted or not.
Json text(const char* description);

/// An object of exactly these keys.
Json object_of(Json properties);

/// A map that may also be left empty.
Json map_from_names(Json values, const char* description);

Json unit();

/// A value whose type only its use decides, or a sweep over several.
Json any_value();

/// The whole: draft 7, its title, the keys that must be there.
Json document(const char* title, Json required, Json properties);

}  // namespace scanmill::schema
