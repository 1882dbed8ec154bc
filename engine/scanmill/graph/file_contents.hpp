// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The content of the files that a graph is made over, each read once.

#include <map>

#include "scanmill/graph/graph.hpp"

namespace scanmill {

struct FileContent {
    std::string hash;  ///< of the file's bytes; a file that cannot be read stands for itself alone
    std::string why_unreadable;  ///< with the way out; empty: it can be read
};

class FileContents {
public:
    /// `hash` gives the hash of a file's bytes, and must outlive this.
    explicit FileContents(const HashOfFile& hash) : hash_(hash) {}

    const FileContent& of(const std::filesystem::path& file);

private:
    const HashOfFile& hash_;
    std::map<std::string, FileContent> known_;  // by path
};

}  // namespace scanmill
