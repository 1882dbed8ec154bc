// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The scans that a bench has open as streams: what it holds in place of their values.

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "scanmill/cache/value_file.hpp"
#include "scanmill/engine/graph.hpp"
#include "scanmill/formats/point_stream.hpp"
#include "scanmill/work/unchanged_file.hpp"

namespace scanmill {

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
