// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The numbers that a recorded cell has, and which of them a name means.

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// A number of a cell, and where it comes from.
struct CellValue {
    enum class Of { measurement, output, step };

    Of of = Of::step;
    std::string source;  ///< the label of the step, or the name of the output's file without its folder
    Metric metric;
    LengthUnit lengths = LengthUnit::unknown;
    double diagonal = 0;  ///< what `%diag` refers to; NaN: the source has none

    /// "measure-surface.hausdorff"
    std::string full_name() const { return source + "." + metric.name; }
};

/// The steps of a run by their node. A node that was recorded twice, as its cached value was lost, counts as run last.
using StepsByNode = std::map<std::size_t, const StepRecord*>;
StepsByNode steps_by_node(const RunDetails& run);

/// Metrics and properties of the steps and of the written outputs: first of measuring steps, then of outputs, then of
/// the other steps. A property of a step whose metric has the same name is left out. NaN is left out: it is undefined.
std::vector<CellValue> values_of(const CellRecord& cell, const StepsByNode& steps);

/// What `name` means among them: for STEP.NAME the values of that step; else those of measurements with this name; if
/// there is none, of outputs; if there is none, of all steps.
std::vector<const CellValue*> named(std::span<const CellValue> values, std::string_view name);

/// The value of the same source and name; `hint` is where it probably is. Null: there is none.
const CellValue* same_value(std::span<const CellValue> values, const CellValue& like, std::size_t hint = 0);

}  // namespace scanmill
