// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// JSON Schemas (draft 7) of the documents that the commands print with --json.
///
/// A schema names every member that a document may have, so an unknown member is an error. `"scanmill": 1` is the
/// version of all documents. It increases when a member is removed or changes its meaning, but not when a member is
/// added.

#include <string>
#include <string_view>
#include <vector>

namespace scanmill {

/// The names of the documents: those of commands, and `error`, which any command may print instead.
const std::vector<std::string>& output_names();
/// The schema of a document as indented JSON with a trailing newline. Pre: `name` is one of output_names().
std::string output_schema(std::string_view name);

}  // namespace scanmill
