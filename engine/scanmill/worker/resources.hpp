// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How much memory there is to be had.

#include <chrono>
#include <string>

#include "scanmill/data/array.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill {

/// Bytes that new work can take without others being pushed out, by the kernel's own estimate and the limit of the
/// control group that this process is in (cgroup v2).
u64 available_memory();

// The most memory that this process may ask for, for as long as the object lives: beyond it allocating fails.

/// Counts what belongs to no file; the stacks of `threads`, hardly used, come on top. 0: no limit. Under
/// AddressSanitizer, which takes more than anybody would allow, nothing is limited.
class MemoryLimit {
public:
    MemoryLimit(u64 bytes, unsigned threads);
    ~MemoryLimit();
    MemoryLimit(const MemoryLimit&) = delete;
    MemoryLimit& operator=(const MemoryLimit&) = delete;

private:
    bool is_set_ = false;
    u64 before_ = 0;
};

// What this process uses, from one moment to another.

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

// What a filter can leave behind in its process that the next one would feel.

class ProcessState {
public:
    /// As it is now.
    static ProcessState now();

    /// What differs since `before`, as a part of a sentence: "3 more files are open"; empty: nothing.
    std::string changes_since(const ProcessState& before) const;

private:
    std::string folder_, locale_, environment_;
    unsigned file_mask_ = 0;
    int rounding_ = 0;
    std::size_t open_files_ = 0;
};

/// Bytes of this process that belong to no file.
u64 anonymous_memory();

}  // namespace scanmill
