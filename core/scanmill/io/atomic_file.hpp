// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A file that appears whole or not at all.
///
/// Bytes go to an unnamed file on the target's file system. commit() writes them to disk (fsync), gives the file a
/// temporary name (`.scanmill-HOST-PROCESS-….part`), and then that of the target. Without commit() no file is left,
/// even if the process is killed. On file systems without unnamed files, the temporary name exists from the start and
/// stays if the process is killed; remove_abandoned_parts() removes it.
///
/// Processes of any machines may write the same target at once, also on a network file system: no locks are used. A
/// target that already holds the same bytes stays the same file, so that machines that have mapped it can go on reading
/// it. A call that the server carried out counts as done, even if its answer was lost and the repeated call failed.

#include <filesystem>
#include <string_view>

namespace scanmill {

class AtomicFile {
public:
    /// Throws Error if the folder is missing or not writable, or if the target exists and is neither a regular file nor
    /// a symbolic link.
    explicit AtomicFile(std::filesystem::path target);
    ~AtomicFile();
    AtomicFile(const AtomicFile&) = delete;
    AtomicFile& operator=(const AtomicFile&) = delete;

    /// Appends the bytes. Throws Error if the disk is full or fails.
    void write(std::string_view bytes);
    /// `no` skips fsync, for a file that can be made again at any time.
    enum class Sync { yes, no };
    void commit(Sync sync = Sync::yes);

private:
    void open_named(const std::filesystem::path& folder);

    std::filesystem::path target_;
    std::filesystem::path temporary_;  ///< empty while the file has no name
    int descriptor_ = -1;
};

/// Whether the file is a temporary file that no process will complete. On the machine that wrote it, its process no
/// longer runs, and its last change is a minute ago. On other machines, which cannot see the process and whose clocks
/// may differ by hours, the last change is a day ago.
bool is_abandoned_part(const std::filesystem::path& file);

void remove_abandoned_parts(const std::filesystem::path& folder);

}  // namespace scanmill
