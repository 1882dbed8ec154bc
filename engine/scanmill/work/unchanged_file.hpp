// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Is a file still what it was when the run was planned? A key knows a file by its content of then; what it holds now
/// must not be kept under that key.

#include <sys/stat.h>

#include <filesystem>
#include <future>
#include <string>

namespace scanmill {

/// Throws Error when the file's content_hash() is another.
void require_unchanged(const std::filesystem::path& file, const std::string& content);

/// The same for a file that is about to be read: begun beside the reading, ended after it.
class UnchangedWhileRead {
public:
    /// `beside`: on another thread, if the system gives one; else all is done in require().
    UnchangedWhileRead(std::filesystem::path file, std::string content, bool beside);

    /// After reading; again after reading more. Throws Error as require_unchanged(). Hashes again when the file's
    /// stamps say that it was written to since the constructor, or so shortly before that they could not tell.
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
