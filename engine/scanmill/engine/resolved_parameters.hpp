// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A step's lengths in the scan's unit.

#include <functional>
#include <vector>

#include "scanmill/engine/plan.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/filter/ports.hpp"

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

}  // namespace scanmill
