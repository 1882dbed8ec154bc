// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A file that appears whole or not at all.
///
/// Bytes go to a file without a name on the target's file system; commit() makes them durable (fsync), gives them the
/// target's name and makes that durable; nothing is synced when the file can be made again at any time. Without
/// commit() nothing is left, however the process ends. Where there is a file of the target's name, or on file systems
/// that know no files without one, a temporary name (`.scanmill-….part`) comes in between, which only a process that is
/// killed just then leaves.

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
    bool link_to(const std::filesystem::path& name) const;

    std::filesystem::path target_;
    std::filesystem::path temporary_;  ///< empty while the file has no name
    int descriptor_ = -1;
};

/// Removes from the folder the temporary names of processes that are gone, a minute after they were last written to.
void remove_abandoned_parts(const std::filesystem::path& folder);

}  // namespace scanmill
