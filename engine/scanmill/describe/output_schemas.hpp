// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What the commands print with --json, as JSON Schemas (draft 7), for programs that read it.
///
/// A schema names every member that a document may have, so an unknown or a missing one is an error. `"scanmill": 1` is
/// the version of all documents: it rises when a member disappears or changes its meaning; members may be added.

#include <string>
#include <string_view>
#include <vector>

namespace scanmill {

/// The documents: the commands' names, and `error`, which any command may print instead.
const std::vector<std::string>& output_names();
/// Indented JSON with a trailing newline. Pre: one of output_names().
std::string output_schema(std::string_view name);

}  // namespace scanmill
