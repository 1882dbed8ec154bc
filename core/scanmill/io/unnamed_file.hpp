// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A temporary file without a name, for data that do not fit into memory.

#include <memory>
#include <string_view>

#include "scanmill/io/mapped_file.hpp"

namespace scanmill {

/// A file in the system's temporary folder (TMPDIR, else /tmp). It is gone with the object and its mapping, even if the
/// process is killed.
class UnnamedFile {
public:
    /// Throws Error if no file can be made in the folder.
    UnnamedFile();
    ~UnnamedFile();
    UnnamedFile(const UnnamedFile&) = delete;
    UnnamedFile& operator=(const UnnamedFile&) = delete;

    /// Throws Error if the disk is full or fails.
    void append(std::string_view bytes);
    /// All bytes. The mapping may outlive this object. Pre: the file is not empty.
    std::unique_ptr<MappedFile> map() const;

private:
    int descriptor_ = -1;
};

}  // namespace scanmill
