// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether what a workflow calls by `$name` is there.

#include "scanmill/engine/diagnostics.hpp"
#include "scanmill/engine/expand.hpp"

namespace scanmill {

/// Every `$name` of the file must be declared, in a list be a single value, and every declared one should be used. So
/// must every setting.
void check_references(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics);

}  // namespace scanmill
