// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The gate: by how much a metric may get worse from one run to the next before a batch counts as failed.

#include <string>
#include <variant>
#include <vector>

#include "scanmill/plugin/library.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// The metric must stay what it was.
struct Unchanged {
    bool operator==(const Unchanged&) const = default;
};

/// What worse means is the metric's own matter: a smaller f-score, a larger distance.
struct GateRule {
    std::string metric;
    Position position;
    /// Nothing; a share of the earlier value; a length; so many in the metric's own unit.
    std::variant<Unchanged, Ratio, Length, double> allowed;
    std::string text;  ///< as written: "+1 %"
};

/// A metric that a gate may name; several rows of one name when filters give it different units.
std::vector<MetricSpec> gate_metrics(const FilterLibrary& library);

/// The rules under `gate:`, those that are sound.
std::vector<GateRule> parse_gate(const YamlNode& node, const FilterLibrary& library, Diagnostics& diagnostics);

}  // namespace scanmill
