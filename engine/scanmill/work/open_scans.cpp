// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/work/open_scans.hpp"

#include "scanmill/engine/step_runner.hpp"

namespace scanmill {

std::shared_ptr<const PointStream> OpenScans::open(std::size_t node, const LeafSource& leaf, unsigned threads,
                                                   bool is_checked, const std::function<void(std::string)>& on_warning,
                                                   const OnWorldPositions& on_positions) {
    Scan scan;
    if (is_checked) scan.check.emplace(leaf.file, leaf.content, threads > 1);
    scan.stream = open_leaf(leaf, threads, on_warning, on_positions);
    if (!scan.stream) return nullptr;
    return scans_.insert_or_assign(node, std::move(scan)).first->second.stream;
}

std::shared_ptr<const PointStream> OpenScans::find(std::size_t node) const {
    const auto found = scans_.find(node);
    return found == scans_.end() ? nullptr : found->second.stream;
}

void OpenScans::require_unchanged(std::size_t node) {
    if (std::optional<UnchangedWhileRead>& check = scans_.at(node).check) check->require();
}

}  // namespace scanmill
