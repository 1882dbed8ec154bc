// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Conditions under `expect` in a step. They are typed when the workflow is checked, and compared with the result when
/// the step has run.

#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// Types the numbers of an expectation by the unit of its metric or property. An area or volume becomes a Length as
/// parse_length_power() returns it. Reports unknown names and values of the wrong type, and returns nothing for them.
std::optional<PlannedExpectation> plan_expectation(const Expectation& written, const FilterSpec& spec,
                                                   Diagnostics& diagnostics);

/// The names that `expect` accepts: the filter's metrics, and the properties of its primary output.
std::vector<MetricSpec> expectable(const FilterSpec& spec);

/// The parameter type in which a number of this unit is written. Areas and volumes have the type of lengths.
ParameterSpec written_as(Unit unit);

/// Throws Error naming every expectation that `found` does not meet. Lengths are resolved against `scale`.
void require_met(const std::vector<PlannedExpectation>& expectations, const Metrics& found, const LengthScale& scale);

}  // namespace scanmill
