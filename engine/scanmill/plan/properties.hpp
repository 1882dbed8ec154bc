// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What is true of a value whatever filter made it: the numbers that `expect` may ask for beside a filter's metrics,
/// and that summaries show.

#include <vector>

#include "scanmill/filter/spec.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

/// Names, units and meanings of the facts about values of this kind. Meshes: closed, components, genus, boundary-loops,
/// triangles, points; point clouds: points; tetrahedra: points, cells.
std::vector<MetricSpec> fact_specs(Kind kind);

/// The facts, in the order of fact_specs; one that is not defined (the genus of a mesh that is no manifold) is left
/// out.
Metrics facts_of(const Value& value);

/// "3000", "0.0125", "true": a metric's number for people, angles in degrees.
std::string display(const Metric& metric);
/// The same with the unit that its lengths are in: "0.0125 mm", "3.2 u²".
std::string display(const Metric& metric, LengthUnit unit);

}  // namespace scanmill
