// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Is a file still what it was when the run was planned? A key knows a file by its content of then; what it holds now
/// must not be kept under that key.

#include <sys/stat.h>
#include <filesystem>
#include <functional>
#include <future>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "scanmill/cache/value_file.hpp"
#include "scanmill/data/point_stream.hpp"
#include "scanmill/graph/graph.hpp"

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

// The scans that a bench has open as streams: what it holds in place of their values.

class OpenScans {
public:
    /// Opens the leaf's file; nullptr when it cannot be read piece by piece. `is_checked`: its content is known by a
    /// key, and require_unchanged() is to be called once it was read.
    std::shared_ptr<const PointStream> open(std::size_t node, const LeafSource& leaf, unsigned threads, bool is_checked,
                                            const std::function<void(std::string)>& on_warning,
                                            const OnWorldPositions& on_positions = {});
    /// nullptr when it is not open.
    std::shared_ptr<const PointStream> find(std::size_t node) const;
    /// Throws Error when a checked file is, or was while it was read, another than the one that was hashed. Pre: it is
    /// open.
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
