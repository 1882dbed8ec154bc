// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What this process uses, from one moment to another.

#include <chrono>

#include "scanmill/engine/report.hpp"

namespace scanmill {

/// Begins to measure when it is made. Only one can measure the peak of memory at a time.
class ResourceUse {
public:
    ResourceUse();
    Effort until_now() const;

private:
    std::chrono::steady_clock::time_point start_;
    double cpu_seconds_;
};

/// Bytes of a process that are in memory: now, the most since it began or ResourceUse last did, and now without what
/// belongs to files. Zeros when it is gone.
struct ResidentMemory {
    u64 now = 0, peak = 0, anonymous = 0;
};
ResidentMemory resident_memory(int process);

}  // namespace scanmill
