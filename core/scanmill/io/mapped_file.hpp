// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Reads files: the bytes of a regular file without a copy, and the reason why a path is not a regular file.

#include <filesystem>
#include <optional>
#include <string_view>

#include "scanmill/base/error.hpp"

namespace scanmill {

/// Maps a regular, non-empty file for the object's life. Throws Error for a path that is missing, a folder, not a
/// regular file, unreadable or empty. If a process shortens the file meanwhile, the reader is killed with SIGBUS. This
/// is accepted because scans are written once and read afterwards.
class MappedFile {
public:
    /// `whole` loads all pages at once, for a file that is read completely. Otherwise only the pages that are read take
    /// memory.
    explicit MappedFile(const std::filesystem::path& path, bool whole = true);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const { return {static_cast<const char*>(data_), size_}; }

    /// Loads the pages of `part`, a part of bytes(), in one call. Use it right before reading them.
    void fetch(std::string_view part) const noexcept;
    /// Frees the pages of `part` and the pages that were mapped around it. Reading these pages again loads them again.
    /// Other threads may read them meanwhile.
    void release(std::string_view part) const noexcept;

private:
    friend class UnnamedFile;
    /// Maps an open, regular, non-empty file.
    MappedFile(int descriptor, bool whole);

    void* data_ = nullptr;
    std::size_t size_ = 0;
};

/// nullopt for a regular file, else an Error that states what the path leads to and what to do. Does not open the file,
/// because opening a pipe would wait for its writer. Does not check read permission.
std::optional<Error> why_no_file(const std::filesystem::path& path);

}  // namespace scanmill
