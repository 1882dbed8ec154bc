// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Whether what a workflow calls by `$name` is there.

#include "scanmill/engine/diagnostics.hpp"
#include "scanmill/engine/expand.hpp"

namespace scanmill {

/// Every `$name` of the steps must be declared, and be a single value in a list. So must every setting. Every declared
/// one should be mentioned in the file.
void check_references(const Workflow& workflow, const Settings& settings, Diagnostics& diagnostics);

}  // namespace scanmill
