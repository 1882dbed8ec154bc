// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The grammars of workflow and batch files as JSON Schema (draft 7), for editors and other programs.
///
/// A schema checks everything that can be checked at one position of the file: keys, filters, parameters, ports, and
/// names in `expect`. `scanmill check` does all other checks: of the whole file (wiring, references, repeated names),
/// of other files, and of numbers that depend on each other. Alternatives are chosen by the type or the keys of a value
/// (if, then, else), so that an error names the intended alternative.
///
/// A parameter's schema accepts what parse() accepts, as far as YAML types and regular expressions can express it. For
/// a text with a unit, it checks only the bound 0. It refuses numbers in quotes.

#include <string>

#include "scanmill/plugin/library.hpp"

namespace scanmill {

/// Schema of workflow files, as indented JSON with a trailing newline. Equal filters give equal bytes.
std::string workflow_schema(const FilterLibrary& library);
/// Schema of batch files, in the same form. `measure` accepts the parameters of the measuring filters.
std::string batch_schema(const FilterLibrary& library);

}  // namespace scanmill
