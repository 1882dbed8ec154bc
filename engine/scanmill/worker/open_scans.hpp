// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Scans that a worker reads as streams, and checks that files did not change since the run was planned: keys contain
/// the content hash of that time, so results of changed content must not be stored under them.

#include <sys/stat.h>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "scanmill/data/point_stream.hpp"
#include "scanmill/graph/graph.hpp"

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

class OpenScans {
public:
    /// Opens the leaf's file; nullptr if it cannot be streamed. `is_checked`: require_unchanged() compares its content
    /// with the hash in its key.
    std::shared_ptr<const PointStream> open(std::size_t node, const LeafSource& leaf, unsigned threads, bool is_checked,
                                            const OnWarning& on_warning, const OnWorldPositions& on_positions = {});
    /// nullptr if it is not open.
    std::shared_ptr<const PointStream> find(std::size_t node) const;
    /// Throws Error if a checked file changed since it was hashed. Pre: it is open.
    void require_unchanged(std::size_t node);
    void forget(std::size_t node) { scans_.erase(node); }
    bool empty() const { return scans_.empty(); }

private:
    struct Scan {
        std::shared_ptr<const PointStream> stream;
        std::optional<UnchangedWhileRead> check;
    };
    std::map<std::size_t, Scan> scans_;  // by node
};

}  // namespace scanmill
