// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The common parts of the JSON forms of all kinds.
///
/// A document is an object with `"scanmill": 1`, a `unit` and the member that identifies its kind. Errors use our
/// words, not those of the JSON library.

#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/metrics.hpp"

namespace scanmill {

using Json = nlohmann::ordered_json;

/// Throws Error for text that is not JSON (with the line), a key that is twice in one object, and nesting deeper than
/// 16 levels.
Json parse_document(std::string_view text);

/// Throws Error unless the document is an object with "scanmill": 1 and no keys but `known`.
void require_document(const Json& document, const std::vector<std::string>& known);
/// Throws Error unless the object has no keys but `known`. `place` begins the message.
void require_keys(const Json& object, const std::string& place, const std::vector<std::string>& known);

/// The member, or null if there is none.
const Json& member(const Json& object, std::string_view key);
/// The member as text; empty if there is none or it is null. Throws Error for another type.
std::string text_member(const Json& object, std::string_view key, const std::string& place);
/// The member `unit`; unknown if it is null or absent. Throws Error for any other text than a unit's symbol.
LengthUnit unit_member(const Json& document);
/// The member as a list. Throws Error for another type.
const Json& list_member(const Json& object, std::string_view key, const std::string& place);

/// Throws Error unless `list` is a list of `count` numbers. `what` begins the message: "pose 2: 'rotation'".
std::vector<double> numbers_of(const Json& list, std::size_t count, const std::string& what);
Vec3 vector_of(const Json& list, const std::string& what);

/// The symbol; null if the unit is unknown.
Json unit_json(LengthUnit unit);
Json json_of(const Vec3& vector);
/// Names and values; a value that is not finite is null.
Json metrics_json(const Metrics& metrics);

}  // namespace scanmill
