// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The gate of a batch limits by how much metrics, costs and outputs may differ from the accepted run.
///
/// A rule's text states what is allowed:
/// - `+1 %`: the value may rise by 1 % of the accepted value, and fall without limit;
/// - `-1 %`: the value may fall by 1 % of the accepted value, and rise without limit;
/// - `1 %`: the value may rise or fall by 1 % of the accepted value;
/// - `+0.01 mm`, `-2`, `3 deg`: the same with an absolute amount;
/// - `exact`: the value must be equal;
/// - `= truth`: the value NAME must be equal to the metric `truth-NAME` of the same cell, whatever was accepted.
/// If a cell has the metric `truth-NAME`, a value that moves towards it is never a regression.
/// Rules for the costs `seconds`, `cpu-seconds` and `memory` have the form `+20 %`. The rule for `outputs` is `exact`:
/// no byte of an output file may change.
///
/// A rule NAME applies to the measurements of a cell (see is_measurement()) that have this metric. Without such a
/// measurement, it applies to the outputs that have NAME as a property. Without such an output, it applies to every
/// step that reports NAME. A rule STEP.NAME applies to that step.

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
    unsigned repeats = 1;  ///< number of times that a run measures its costs

    bool operator==(const Gate&) const = default;
};

/// The difference that a rule allows, for a metric of a known unit.
struct Tolerance {
    bool may_rise = false, may_fall = false;  ///< whether the value may rise or fall without limit
    double amount = 0;  ///< in the metric's unit, or a share of the accepted value; 0: exact
    bool is_relative = false;
};

/// Parses a rule's text. `lengths` is the unit of the metric's lengths. `diagonal` is the length to which `%diag`
/// refers; NaN: unknown. The amount of a relative rule is a share of the accepted value's magnitude. A ratio's absolute
/// amount is a plain number: `-0.01` is one percentage point. Amounts are finite and not negative.
///
/// Throws Error with the accepted forms: for a text of another form, for a unit of another dimension, for a length that
/// cannot be converted, and for `spacing`.
Tolerance parse_tolerance(std::string_view text, Unit unit, LengthUnit lengths, double diagonal);

/// Checks a rule of a batch before any value is known. Throws Error as parse_tolerance() does. If one direction is
/// better, also throws Error for a rule that limits improvements: one without a sign or with the wrong sign. `= truth`
/// fits every metric.
void require_rule_fits(std::string_view text, Unit unit, Better better);

/// The beginning of the labels of steps that a batch's `measure` adds.
inline constexpr std::string_view measurement_prefix = "measure-";
/// Whether a batch's `measure` added the step with this label, so that its metrics are measurements.
inline bool is_measurement(std::string_view label) { return label.starts_with(measurement_prefix); }

/// The beginning of the names of metrics that are properties of a cell's truth.
inline constexpr std::string_view truth_prefix = "truth-";
/// Whether the rule's text requires the value of the truth.
inline bool requires_truth(std::string_view text) { return text == "= truth"; }

/// Whether the name is one of the costs `seconds`, `cpu-seconds` and `memory`.
bool is_cost(std::string_view metric);
/// Parses the rule for a cost: a positive share with a plus sign, `+20 %`. Throws Error for anything else.
Tolerance parse_cost_tolerance(std::string_view text);

}  // namespace scanmill
