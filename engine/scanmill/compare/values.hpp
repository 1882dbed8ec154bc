// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The numbers of a recorded cell, and the numbers to which a name in a gate's rule refers.

#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// A number of a cell, and its source.
struct CellValue {
    enum class Of { measurement, output, step };

    Of of = Of::step;
    std::string source;  ///< the label of the step, or the name of the output's file without its folder
    Metric metric;
    LengthUnit lengths = LengthUnit::unknown;
    double diagonal = 0;  ///< the length to which `%diag` refers; NaN: the source has none

    /// "measure-surface.hausdorff"
    std::string full_name() const { return source + "." + metric.name; }
};

/// The steps of a run by their node. A node whose cached value was lost has two records; the last one is used.
using StepsByNode = std::map<std::size_t, const StepRecord*>;
StepsByNode steps_by_node(const RunDetails& run);

/// The metrics and properties of a cell: first those of measuring steps, then those of outputs, then those of the other
/// steps. If a step has a metric and a property of the same name, only the metric is included. NaN is left out, because
/// it means undefined.
std::vector<CellValue> values_of(const CellRecord& cell, const StepsByNode& steps);

/// The values to which `name` refers. STEP.NAME refers to the values of that step. NAME refers to measurements of this
/// name; without such measurements, to properties of outputs; without such outputs, to values of all steps.
std::vector<const CellValue*> named(std::span<const CellValue> values, std::string_view name);

/// The value with the same source and name as `like`; nullptr if `values` has none. `hint` is its probable index.
const CellValue* same_value(std::span<const CellValue> values, const CellValue& like, std::size_t hint = 0);

}  // namespace scanmill
