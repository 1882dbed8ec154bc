// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How much memory there is to be had.

#include "scanmill/data/array.hpp"

namespace scanmill {

/// Bytes that new work can take without others being pushed out, by the kernel's own estimate and the limit of the
/// control group that this process is in (cgroup v2).
u64 available_memory();

}  // namespace scanmill
