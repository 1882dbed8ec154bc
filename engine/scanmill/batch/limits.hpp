// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What work on a scan may cost before it is stopped, and how often it may be tried again.

#include "scanmill/data/array.hpp"

namespace scanmill {

/// A cell is one scan under one variant of a workflow. 0: no limit.
struct Limits {
    u64 cell_memory = 0, step_memory = 0;  ///< bytes
    double cell_seconds = 0, step_seconds = 0;
    unsigned retries = 0;  ///< after the first attempt

    bool operator==(const Limits&) const = default;
};

}  // namespace scanmill
