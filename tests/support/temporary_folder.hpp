// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A folder for one test's files, removed afterwards with everything in it.

#include <filesystem>
#include <string>
#include <string_view>

namespace scanmill::test {

class TemporaryFolder {
public:
    TemporaryFolder();
    ~TemporaryFolder();
    TemporaryFolder(const TemporaryFolder&) = delete;
    TemporaryFolder& operator=(const TemporaryFolder&) = delete;

    const std::filesystem::path& path() const { return path_; }
    std::filesystem::path operator/(std::string_view name) const { return path_ / name; }
    /// Writes a file below the folder, making folders on the way, and returns its path.
    std::filesystem::path write(std::string_view name, std::string_view content) const;
    /// How many files and folders lie directly in it.
    std::size_t files() const;

private:
    std::filesystem::path path_;
};

/// The whole file as bytes; an empty string when it cannot be read.
std::string content_of(const std::filesystem::path& file);

}  // namespace scanmill::test
