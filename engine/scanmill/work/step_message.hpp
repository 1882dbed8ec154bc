// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A planned step as runner and worker tell it to each other.

#include <memory>
#include <nlohmann/json.hpp>

#include "scanmill/engine/plan.hpp"

namespace scanmill {

/// A row for every parameter that has a value: its name, the written items, whether they are a list.
nlohmann::json rows_of(const ParameterSet& parameters);
/// In the order of the declaration.
ParameterSet parameters_from(const nlohmann::json& rows, const FilterSpec& spec);

nlohmann::json to_json(const PlannedStep& step);
/// Throws Error when the library's filter is no longer of that version.
std::shared_ptr<const PlannedStep> step_from(const nlohmann::json& json, const FilterLibrary& library);

}  // namespace scanmill
