// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A file that appears whole or not at all.
///
/// Bytes go to a temporary file in the target's folder; commit() makes them durable (fsync), renames the file onto the
/// target and makes the rename durable. Without commit() the destructor removes the temporary file; only a process that
/// is killed in between leaves one (`.scanmill-….part`).

#include <filesystem>
#include <string_view>

namespace scanmill {

class AtomicFile {
public:
    /// Throws Error: the folder is missing or not writable, the target exists and is no regular file.
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Appends; throws Error when the disk is full or fails.
    void write(std::string_view bytes);
    void commit();

private:
    std::filesystem::path target_, temporary_;
    int descriptor_ = -1;
};

}  // namespace scanmill
