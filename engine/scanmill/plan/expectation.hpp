// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `expect` on a step: typed when the workflow is checked, compared when the step has run.

#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// The expectation with its numbers typed by the metric or property that it names. Areas and volumes are lengths whose
/// amounts count the unit's power (see sizes.hpp). Unknown names and values of the wrong type are reported.
std::optional<PlannedExpectation> plan_expectation(const Expectation& written, const FilterSpec& spec,
                                                   Diagnostics& diagnostics);

/// The names that `expect` accepts: the filter's metrics, and the properties of its primary output.
std::vector<MetricSpec> expectable(const FilterSpec& spec);

/// The parameter type in which a number of this unit is written; for areas and volumes, before the power.
ParameterSpec written_as(Unit unit);

/// Throws Error naming every expectation that `found` does not meet. Lengths are resolved against `scale`.
void require_met(const std::vector<PlannedExpectation>& expectations, const Metrics& found, const LengthScale& scale);

}  // namespace scanmill
