// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// JSON Schemas (draft 7) of the JSON documents that steps write and workflows read.

#include <string>
#include <string_view>
#include <vector>

namespace scanmill {

/// The names of the kinds that have a JSON form.
const std::vector<std::string>& document_names();
/// The schema of a kind as indented JSON with a trailing newline. Pre: `name` is one of document_names().
std::string document_schema(std::string_view name);

}  // namespace scanmill
