// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// At most one run writes into an output folder at a time.
///
/// A run locks the file `scanmill.lock` in the folder (an open file description lock), which the system releases when
/// the process ends, however it ends. The file names the lock's holder, for messages, and is removed at the end.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/base/error.hpp"

namespace scanmill {

/// Another run writes into the output folder.
class __attribute__((visibility("default"))) FolderInUse : public Error {
public:
    using Error::Error;
    explicit FolderInUse(Error error) : Error(std::move(error)) {}
};

class OutputLock {
public:
    /// Throws FolderInUse, which names the process that holds the lock and how long it has. If the file system has no
    /// locks, warns, and holds none. Pre: the folder is writable.
    OutputLock(const std::filesystem::path& folder, const std::vector<std::string>& command_line,
               const std::function<void(std::string)>& warn);
    ~OutputLock();
    OutputLock(const OutputLock&) = delete;
    OutputLock& operator=(const OutputLock&) = delete;

    /// Whether a run writes into the folder now. Disturbs no run that begins.
    static bool is_held(const std::filesystem::path& folder);

private:
    std::filesystem::path file_;
    int descriptor_ = -1;
};

}  // namespace scanmill
