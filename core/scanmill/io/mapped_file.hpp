// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A file's bytes, read-only, without copying them.

#include <filesystem>
#include <string_view>

namespace scanmill {

/// Maps a regular, non-empty file for the object's life. Throws Error for what is missing, a folder, another kind of
/// thing than a regular file, not readable for us, or empty. Whoever shortens the file meanwhile kills the reader with
/// SIGBUS: scans are written once and read afterwards.
class MappedFile {
public:
    /// `whole`: everything will be read, so all of it is fetched at once. Else what is not touched costs no memory.
    explicit MappedFile(const std::filesystem::path& path, bool whole = true);
    ~MappedFile();
    MappedFile(const MappedFile&) = delete;
    MappedFile& operator=(const MappedFile&) = delete;

    std::string_view bytes() const { return {static_cast<const char*>(data_), size_}; }

    /// These bytes will be read next: their pages are mapped in one call. `part` is a part of bytes().
    void fetch(std::string_view part) const noexcept;
    /// These bytes are not needed for now: their pages, and what touching them mapped around them, no longer count as
    /// memory of this process. Reading them, or what else lies in these pages, is allowed, also meanwhile.
    void release(std::string_view part) const noexcept;

private:
    void* data_ = nullptr;
    std::size_t size_ = 0;
};

}  // namespace scanmill
