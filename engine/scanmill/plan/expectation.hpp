// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// `expect` on a step: typed when the workflow is checked, compared when the step has run.

#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// The expectation with its numbers typed by what it asks for: a metric of the filter, or a fact about its primary
/// output. Areas and volumes are lengths whose amounts count the unit's power (see length_power.hpp). Reports unknown
/// names and values of the wrong type.
std::optional<PlannedExpectation> plan_expectation(const Expectation& written, const FilterSpec& spec,
                                                   Diagnostics& diagnostics);

/// What `expect` may ask for: the filter's metrics, and the properties about its primary output.
std::vector<MetricSpec> expectable(const FilterSpec& spec);

/// How a number of this unit is written in a workflow; of areas and volumes, before the unit is raised to its power.
ParameterSpec written_as(Unit unit);

/// Throws Error naming every expectation that `found` does not meet. Lengths are resolved against `scale`.
void require_met(const std::vector<PlannedExpectation>& expectations, const Metrics& found, const LengthScale& scale);

}  // namespace scanmill
