// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The memory that this process can still use.

#include <cstdint>

namespace scanmill {

/// Bytes that new work can use without swapping: the kernel's estimate, within the limits of the control groups of this
/// process (cgroup v2).
std::uint64_t available_memory();

}  // namespace scanmill
