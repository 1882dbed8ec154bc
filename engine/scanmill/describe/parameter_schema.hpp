// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A filter's parameter as JSON Schema (draft 7): what an editor completes and checks while a workflow is written.
///
/// The schema accepts what parse() accepts, within what YAML types and regular expressions can say: numbers and their
/// bounds, texts with a unit, choices, words, lists, `$name` and `{sweep: […]}`. It does not know bounds other than 0
/// of texts with a unit, and takes numbers in quotes for texts.

#include <nlohmann/json_fwd.hpp>

#include "scanmill/filter/parameter.hpp"

namespace scanmill {

/// A value, `$name` or `{sweep: […]}`, with the parameter's help, range and default as its description.
nlohmann::ordered_json parameter_schema(const ParameterSpec& parameter);

/// A plain value of the type, as `expect` takes it.
nlohmann::ordered_json value_schema(const ParameterSpec& parameter);

/// An area or a volume, as `expect` takes it (see length_power.hpp). Pre: power is 2 or 3.
nlohmann::ordered_json length_power_schema(int power);

}  // namespace scanmill
