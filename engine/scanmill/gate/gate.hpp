// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The gate of a batch: by how much its metrics, costs and outputs may differ from the accepted run before it trips.
///
/// A rule's text states what is allowed: `+1 %` the value may rise by 1 % of the accepted one, and fall as it likes;
/// `-1 %` the reverse; `1 %` it may do neither by more; `+0.01 mm`, `-2`, `3 deg`: the same as absolute amounts, in the
/// metric's unit; `exact` it must be equal. The costs `seconds`, `cpu-seconds` and `memory` take `+20 %`; `outputs` is
/// `exact`: no output file may change a byte.
///
/// A rule NAME is for the measurements of a cell (see is_measurement()) that have this metric; else for the outputs
/// that have it as a property; else for every step that reports it. A rule STEP.NAME is for that step.

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/frame.hpp"
#include "scanmill/data/metrics.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

struct GateRule {
    std::string metric;  ///< NAME, STEP.NAME, or one of the words `seconds`, `cpu-seconds`, `memory`, `outputs`
    std::string text;  ///< as written: "+1 %"
    Position position;

    bool operator==(const GateRule& other) const { return metric == other.metric && text == other.text; }
};

struct Gate {
    std::vector<GateRule> rules;
    unsigned repeats = 1;  ///< how often a run measures its costs

    bool operator==(const Gate&) const = default;
};

/// What a rule's text allows, for a metric of a known unit.
struct Tolerance {
    bool may_rise = false, may_fall = false;  ///< without limit
    double amount = 0;  ///< in the metric's unit, or a share of the accepted value; 0: exact
    bool is_relative = false;
};

/// `lengths` is the unit of the metric's lengths, `diagonal` what `%diag` refers to (NaN: unknown). Throws Error with
/// the forms that the unit accepts: no sign nor unit, another dimension, a length that cannot be converted.
/// The amount of a relative rule is a share of the accepted value's magnitude. A ratio's absolute amount is a plain
/// number: `-0.01` is one percentage point. Amounts are finite and not negative; `spacing` is refused.
Tolerance parse_tolerance(std::string_view text, Unit unit, LengthUnit lengths, double diagonal);

/// Checks a rule of a batch before any value is known. Throws Error as parse_tolerance() does, and for a rule that
/// limits improvements: without a sign, or with the wrong one, although one direction is the better one.
void require_rule_fits(std::string_view text, Unit unit, Better better);

/// The labels of the steps that a batch's `measure` adds begin with it.
inline constexpr std::string_view measurement_prefix = "measure-";
/// Whether the numbers of the step with this label are measurements.
inline bool is_measurement(std::string_view label) { return label.starts_with(measurement_prefix); }

/// `seconds`, `cpu-seconds` and `memory`.
bool is_cost(std::string_view metric);
/// Parses the rule for a cost: a positive share with a plus sign, `+20 %`. Throws Error for anything else.
Tolerance parse_cost_tolerance(std::string_view text);

}  // namespace scanmill
