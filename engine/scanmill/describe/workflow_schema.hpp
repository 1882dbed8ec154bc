// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The grammar of workflow files over the filters at hand as JSON Schema (draft 7), for editors and other programs.
///
/// It says what can be said of one place in the file: keys, filters, parameters, ports, the names that `expect` knows.
/// What needs the whole file (wiring, references, names given twice) is left to `check`.

#include <string>

#include "scanmill/plugin/library.hpp"

namespace scanmill {

/// Indented JSON with a trailing newline; equal filters give equal bytes.
std::string workflow_schema(const FilterLibrary& library);

}  // namespace scanmill
