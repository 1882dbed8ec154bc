// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks that files did not change since the run was planned. Keys contain the content hash taken at planning time, so
/// results from changed content must not be stored under them.

#include <sys/stat.h>
#include <filesystem>
#include <future>
#include <string>

namespace scanmill {

/// Throws Error if the file's content_hash() is not `content`.
void require_unchanged(const std::filesystem::path& file, const std::string& content);

/// Checks that a file that is about to be read does not change until it was read.
class UnchangedWhileRead {
public:
    /// To be called before the file is read. If `beside` is true, another thread hashes the file while it is read;
    /// otherwise require() hashes it.
    UnchangedWhileRead(std::filesystem::path file, std::string content, bool beside);

    /// To be called after every reading. Throws Error as require_unchanged() does. Hashes the file again if its times
    /// show a change since the constructor, or are too recent to show a change.
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
