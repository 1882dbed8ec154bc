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

/// The file's content with the declared unit, frame name and pose; of points the valid rows. Throws Error. Warnings do
/// not name the file. `dropped`, unless null, gets the number of rows that were left out because they are invalid.
Value read_leaf(const LeafSource& leaf, const OnWarning& on_warning, std::size_t* dropped = nullptr);

/// The file as a stream with the declared unit and frame name; nullptr if it cannot be streamed (see
/// open_point_stream()) or has invalid rows. Pre: leaf.is_streamed.
std::shared_ptr<const PointStream> open_leaf(const LeafSource& leaf, unsigned threads, const OnWarning& on_warning,
                                             const OnWorldPositions& on_positions = {});

/// A filter gave or reported what it does not declare, or did not give what it declares.
struct BrokenDeclaration : std::logic_error {
    using std::logic_error::logic_error;
};

struct StepInput {
    std::string port;
    Value value;
};

/// Called with the resolved parameters. Returns the filter's outputs if the cache has them and completes the report;
/// returns nothing to run the filter.
using Recall = std::function<std::optional<Outputs>(const ParameterSet& resolved, NodeReport& report)>;

/// Runs the filter unless `recall` returns its outputs: rebases the inputs on one origin, resolves lengths, checks the
/// outputs. A length that the scan cannot resolve (`0.1 %diag` where all points coincide) fails the step before the
/// filter runs; if it is the parameter's default, the filter gets it unresolved and the step fails only when the filter
/// reads it. The report is completed also when this throws (Error, Cancelled or BrokenDeclaration). `filter` is called
/// only if it runs.
Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const std::vector<StepInput>& inputs, ContextOptions options, const Recall& recall,
                 NodeReport& report);

/// The same for a streamed scan. Pre: can_stream(step, 1).
Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const PointStream& scan, ContextOptions options, const Recall& recall, NodeReport& report);

/// If the step has expectations, adds the properties of its primary output to the report. Throws Error naming all that
/// are not met.
void require_expectations(const PlannedStep& step, const Value& primary, NodeReport& report);

}  // namespace scanmill
