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

/// Limits the memory of this process while the object exists: allocations beyond `bytes` fail. Mapped files do not
/// count. The stacks of `threads` are added to the limit. With 0 bytes there is no limit. Does nothing under
/// AddressSanitizer and ThreadSanitizer, which need much more memory.
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

/// Measures the time and memory that this process uses after the construction of the object. Only one object at a time
/// can measure the peak of memory.
class ResourceUse {
public:
    ResourceUse();
    Effort until_now() const;

private:
    std::chrono::steady_clock::time_point start_;
    double cpu_seconds_;
};

/// The resident memory of a process in bytes; zeros if the process has ended.
struct ResidentMemory {
    u64 now = 0;
    u64 peak = 0;       ///< largest since the process started or constructed its last ResourceUse
    u64 anonymous = 0;  ///< now, without mapped files
};
ResidentMemory resident_memory(int process);

/// A folder for temporary files in the system's temporary folder. The destructor removes it with its content. The
/// constructor removes folders that killed processes left behind.
class ScratchFolder {
public:
    /// Throws Error if the folder cannot be created.
    ScratchFolder();
    ~ScratchFolder();
    ScratchFolder(const ScratchFolder&) = delete;
    ScratchFolder& operator=(const ScratchFolder&) = delete;

    /// Creates an empty folder within it. An earlier folder of the same name is removed.
    std::filesystem::path folder(const std::string& name) const;

private:
    std::filesystem::path path_;
    int lock_ = -1;  // descriptor whose lock is held while the folder is in use
};

}  // namespace scanmill
