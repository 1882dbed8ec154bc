// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The grammars of workflow and batch files as JSON Schema (draft 7), for editors and other programs.
///
/// A schema checks everything that one position in the file can show: keys, filters, parameters, ports, names in
/// `expect`. Checks of the whole file (wiring, references, repeated names), of other files and of numbers that depend
/// on each other are left to `scanmill check`. Alternatives are chosen by the type or the keys of a value (if, then,
/// else), so that an error names the alternative that was meant.
///
/// A parameter's schema accepts what parse() accepts, as far as YAML types and regular expressions can express it: it
/// checks no bound other than 0 of texts with a unit, and takes numbers in quotes for texts.

#include <string>

#include "scanmill/plugin/library.hpp"

namespace scanmill {

/// Indented JSON with a trailing newline; equal filters give equal bytes.
std::string workflow_schema(const FilterLibrary& library);
/// Schema of batch files; `measure` accepts the parameters of the measuring filters.
std::string batch_schema(const FilterLibrary& library);

}  // namespace scanmill
