// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Resources of this process and the machine: memory, time and scratch folder.

#include <chrono>
#include <filesystem>
#include <string>

#include "scanmill/data/array.hpp"
#include "scanmill/io/memory.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill {

/// Limits the memory of this process as long as the object lives: allocations beyond it fail. Mapped files do not
/// count; the stacks of `threads` are added. 0: no limit. Does nothing under AddressSanitizer, which needs much more.
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

/// Measures the time and memory of this process from its construction on. Only one object can measure the peak at a
/// time.
class ResourceUse {
public:
    ResourceUse();
    Effort until_now() const;

private:
    std::chrono::steady_clock::time_point start_;
    double cpu_seconds_;
};

/// Resident bytes of a process. Zeros when it has ended.
struct ResidentMemory {
    u64 now = 0;
    u64 peak = 0;  ///< since the process, or its last ResourceUse, began
    u64 anonymous = 0;  ///< now, without mapped files
};
ResidentMemory resident_memory(int process);

/// A folder for temporary files in the system's temporary folder, removed at the end with its content. The constructor
/// removes folders that killed processes left behind.
class ScratchFolder {
public:
    /// Throws Error if it cannot be made.
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    /// An empty folder in it.
    std::filesystem::path folder(const std::string& name) const;

private:
    std::filesystem::path path_;
    int lock_ = -1;  // held while the folder is in use
};

}  // namespace scanmill
