// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Names of steps and cells for messages. They contain the scan and, if there are several, the workflow and variant.

#include <string>
#include <vector>

#include "scanmill/graph/graph.hpp"

namespace scanmill::runner {

bool has_several_workflows(const RunGraph& graph);
bool has_several_variants(const RunGraph& graph);

class StepNames {
public:
    explicit StepNames(const RunGraph& graph);

    /// The cells of the scan that need the node.
    std::vector<std::size_t> cells(std::size_t node, std::size_t scan) const;
    /// The node's scan, followed by the cells of this scan that need the node, unless all of them do: "scan.ply
    /// [alpha=2]", "scan.ply [2 of 6 variants]", "scan.ply [wang: alpha=2]".
    std::string scan(const RunNode& node) const;
    /// scan() with the step's label, such as "scan.ply [alpha=2]: sculpt"; "scan.ply: read" for a file.
    std::string step(const RunNode& node) const;
    /// Cells of one scan as words for a sentence: "variant 'alpha=2'", "all 6 variants", "2 of 6 variants: alpha=2,
    /// alpha=3". Empty if the scan has only one cell. Pre: `cells` is not empty.
    std::string in_words(const std::vector<std::size_t>& cells) const;

private:
    std::string in_brackets(const std::vector<std::size_t>& cells) const;
    std::string variant(const RunCell& cell) const;

    const RunGraph& graph_;
    bool several_workflows_;
    std::vector<std::vector<std::size_t>> cells_of_node_, cells_of_scan_;
};

}  // namespace scanmill::runner
