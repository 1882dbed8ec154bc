// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Computes one node without the graph around it: reads a file into a value, or runs a filter on values.

#include <functional>
#include <stdexcept>
#include <vector>

#include "scanmill/filter/context.hpp"
#include "scanmill/filter/ports.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill {

/// Reads the file and applies the declared unit, frame name and pose. Invalid rows of points are dropped or refused.
/// `dropped`, unless null, gets the number of dropped rows. Warnings do not name the file. Throws Error.
Value read_leaf(const LeafSource& leaf, const OnWarning& on_warning, std::size_t* dropped = nullptr);

/// Opens the file as a stream with the declared unit and frame name. Returns nullptr if it cannot be streamed (see
/// open_point_stream()) or may have invalid rows. Pre: leaf.is_streamed.
std::shared_ptr<const PointStream> open_leaf(const LeafSource& leaf, unsigned threads, const OnWarning& on_warning,
                                             const OnWorldPositions& on_positions = {});

/// Thrown if a filter returns an output or reports a metric that it does not declare, or omits a declared output.
struct BrokenDeclaration : std::logic_error {
    using std::logic_error::logic_error;
};

struct StepInput {
    std::string port;
    Value value;
};

/// Called with the resolved parameters. If the cache has the filter's outputs, returns them and completes the report.
/// If not, returns nothing, and the filter runs.
using Recall = std::function<std::optional<Outputs>(const ParameterSet& resolved, NodeReport& report)>;

/// Moves the inputs to a common origin, resolves lengths, and runs the filter unless `recall` returns its outputs. Then
/// checks the outputs. `filter` is called only if the filter runs.
///
/// A length that cannot be resolved (`0.1 %diag` if all points coincide) makes the step fail before the filter runs. If
/// that length is a default, the filter gets it unresolved, and the step fails only when the filter reads it.
///
/// Throws Error, Cancelled or BrokenDeclaration; the report is complete even then.
Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const std::vector<StepInput>& inputs, ContextOptions options, const Recall& recall,
                 NodeReport& report);

/// Runs the step on a streamed scan. Pre: can_stream(step, 1).
Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const PointStream& scan, ContextOptions options, const Recall& recall, NodeReport& report);

/// If the step has expectations, adds the properties of its primary output to the report. Throws Error naming all
/// expectations that are not met.
void require_expectations(const PlannedStep& step, const Value& primary, NodeReport& report);

}  // namespace scanmill
