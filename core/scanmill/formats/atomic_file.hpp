// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A file that appears whole or not at all.
///
/// Bytes go to a file without a name on the target's file system; commit() makes them durable (fsync), names the file,
/// renames it onto the target and makes the rename durable; nothing is synced when the file can be made again at any
/// time. Without commit() nothing is left, however the process ends.
/// On file systems that know no such files a temporary one (`.scanmill-….part`) takes its place, which only a process
/// that is killed in between leaves.

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
    enum class Sync { yes, no };
    void commit(Sync sync = Sync::yes);

private:
    void open_named(const std::filesystem::path& folder);

    std::filesystem::path target_;
    std::filesystem::path temporary_;  ///< empty while the file has no name
    int descriptor_ = -1;
};

}  // namespace scanmill
