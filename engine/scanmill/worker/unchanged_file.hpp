// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks that files did not change since the run was planned: keys contain the content hash of that time, so results
/// of changed content must not be stored under them.

#include <sys/stat.h>
#include <filesystem>
#include <future>
#include <string>

namespace scanmill {

/// Throws Error if the file's content_hash() differs.
void require_unchanged(const std::filesystem::path& file, const std::string& content);

/// The same check for a file that is about to be read.
class UnchangedWhileRead {
public:
    /// `beside`: hashes on another thread while the file is read; else require() hashes.
    UnchangedWhileRead(std::filesystem::path file, std::string content, bool beside);

    /// Call it after every reading. Throws Error as require_unchanged(). Hashes again if the file's times show a change
    /// since the constructor, or are too recent to show one.
    void require();

private:
    std::filesystem::path file_;
    std::string content_;
    struct stat before_;
    bool is_settled_ = false;
    bool is_hashed_ = false;
    std::future<void> beside_;
};

}  // namespace scanmill
