// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The JSON documents that steps write and workflows read, as JSON Schemas (draft 7), for programs that make or use
/// them.

#include <string>
#include <string_view>
#include <vector>

namespace scanmill {

/// The kinds with a JSON form.
const std::vector<std::string>& document_names();
/// Indented JSON with a trailing newline. Pre: one of document_names().
std::string document_schema(std::string_view name);

}  // namespace scanmill
