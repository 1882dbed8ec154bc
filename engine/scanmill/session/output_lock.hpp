// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Ensures that at most one run writes into an output folder at a time.
///
/// A run locks the file `scanmill.lock` in the folder with an open file description lock. The system releases the lock
/// when the process ends, even by a crash. The file contains the name of the process for messages. It is removed at the
/// end of the run.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/base/error.hpp"

namespace scanmill {

/// Thrown if another run writes into the output folder.
class __attribute__((visibility("default"))) FolderInUse : public Error {
public:
    using Error::Error;
    explicit FolderInUse(Error error) : Error(std::move(error)) {}
};

class OutputLock {
public:
    /// Takes the lock. If another process holds it, throws FolderInUse, which names the process and how long it has
    /// been writing. If the file system has no locks, warns and goes on without a lock. Pre: the folder is writable.
    OutputLock(const std::filesystem::path& folder, const std::vector<std::string>& command_line,
               const std::function<void(std::string)>& warn);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

    /// Whether a run writes into the folder now. Does not take the lock, so a run can begin meanwhile.
    static bool is_held(const std::filesystem::path& folder);

private:
    std::filesystem::path file_;
    int descriptor_ = -1;
};

}  // namespace scanmill
