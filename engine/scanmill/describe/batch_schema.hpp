// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The grammar of batch files as JSON Schema (draft 7), for editors and other programs.
///
/// It says what can be said of one place in the file. Which files there are, whether a pose's numbers make a rotation,
/// and what the workflows make of `set` is left to `check`.

#include <string>

namespace scanmill {

/// Indented JSON with a trailing newline; always the same bytes.
std::string batch_schema();

}  // namespace scanmill
