// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A step's lengths in the scan's unit.

#include <functional>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/filter/ports.hpp"
#include "scanmill/formats/files.hpp"
#include "scanmill/graph/graph.hpp"
#include "scanmill/plan/plan.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill {

/// A default that the scan has no measure for, as `0.1 %diag` where all points are at one place, and why.
struct UnresolvedDefault {
    ParameterValue value;
    Error reason;
};

struct ResolvedParameters {
    /// Defaults that are left unresolved stand here as they are declared: the filter may do without them.
    ParameterSet values;
    std::vector<UnresolvedDefault> left;
};

/// Throws Error when a length that somebody chose cannot be resolved.
ResolvedParameters resolved_parameters(const PlannedStep& step, const LengthScale& scale);

/// What `run` gives; when it stumbles over one of the defaults that are left, throws the reason that left it so.
Outputs with_reasons(const std::vector<UnresolvedDefault>& left, const std::function<Outputs()>& run);

// One node's work, without the graph around it: read a file into a value, or run a filter on values.

/// The file's content, in the unit, under the frame's name and in the pose that are declared. Throws Error.
Value read_leaf(const LeafSource& leaf, const std::function<void(std::string)>& on_warning);

/// The same piece by piece, in the unit and under the frame's name that are declared; what is to be said is said once
/// it is sure. Nothing when the file cannot be read so (see open_point_stream()). Pre: leaf.is_streamed.
std::shared_ptr<const PointStream> open_leaf(const LeafSource& leaf, unsigned threads,
                                             const std::function<void(std::string)>& on_warning,
                                             const OnWorldPositions& on_positions = {});

struct StepInput {
    std::string port;
    Value value;
};

/// Asked once the parameters are resolved: the filter's outputs, when somebody remembers them, and what is known of
/// them goes to the report; nothing makes the filter run.
using Recall = std::function<std::optional<Outputs>(const ParameterSet& resolved, NodeReport& report)>;

/// Runs the filter unless `recall` knows better: inputs brought to one origin, lengths resolved, outputs checked. A
/// default that the scan has no measure for (`0.1 %diag` of points at one place) is left to the filter as it is
/// declared, and fails the step only when it is read; a length that was chosen fails it before the filter runs (one
/// that is written out and equals the default counts as the default). What it learned goes to `report` even when it
/// throws (Error or Cancelled). `filter` is called for when it runs.
Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const std::vector<StepInput>& inputs, ContextOptions options, const Recall& recall,
                 NodeReport& report);

/// The same, of a scan that is streamed. Pre: can_stream(step).
Outputs run_step(const PlannedStep& step, const std::function<const FilterDeclaration&()>& filter,
                 const PointStream& scan, ContextOptions options, const Recall& recall, NodeReport& report);

/// Puts the properties about the step's primary output into the report, when it expects something. Throws Error naming
/// what outputs and metrics do not meet.
void require_expectations(const PlannedStep& step, const Value& primary, NodeReport& report);

}  // namespace scanmill
