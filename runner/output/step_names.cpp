// SPDX-License-Identifier: GPL-3.0-or-later
#include "output/step_names.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill::runner {

bool has_several_workflows(const RunGraph& graph) {
    return std::ranges::any_of(
        graph.plans, [&](const auto& plan) { return plan->workflow.file != graph.plans.front()->workflow.file; });
}

bool has_several_variants(const RunGraph& graph) {
    return std::ranges::any_of(graph.plans, [](const auto& plan) { return plan->variants.size() > 1; });
}

StepNames::StepNames(const RunGraph& graph)
    : graph_(graph),
      several_workflows_(has_several_workflows(graph)),
      cells_of_node_(graph.nodes.size()),
      cells_of_scan_(graph.scan_names.size()) {
    for (std::size_t cell = 0; cell < graph.cells.size(); ++cell) {
        cells_of_scan_[graph.cells[cell].scan].push_back(cell);
        for (const std::size_t node : graph.cells[cell].nodes) cells_of_node_[node].push_back(cell);
    }
}

std::vector<std::size_t> StepNames::cells(std::size_t node, std::size_t scan) const {
    std::vector<std::size_t> cells = cells_of_node_[node];
    std::erase_if(cells, [&](std::size_t cell) { return graph_.cells[cell].scan != scan; });
    return cells;
}

std::string StepNames::variant(const RunCell& cell) const {
    const std::string& name = graph_.variant(cell).name;
    if (!several_workflows_) return name;
    const bool is_only_one = graph_.plans[cell.plan]->variants.size() == 1;
    return is_only_one ? graph_.workflow(cell) : fmt::format("{}: {}", graph_.workflow(cell), name);
}

std::string StepNames::in_brackets(const std::vector<std::size_t>& cells) const {
    const RunCell& first = graph_.cells[cells.front()];
    const std::vector<std::size_t>& all = cells_of_scan_[first.scan];
    if (cells.size() == all.size()) return {};
    if (cells.size() == 1) return " [" + variant(first) + "]";
    const auto is_of_first = [&](std::size_t cell) {
        return graph_.plans[graph_.cells[cell].plan]->workflow.file == graph_.plans[first.plan]->workflow.file;
    };
    const auto of_workflow = static_cast<std::size_t>(std::ranges::count_if(all, is_of_first));
    if (!several_workflows_ || !std::ranges::all_of(cells, is_of_first))
        return fmt::format(" [{} of {} variants]", cells.size(), all.size());
    if (cells.size() == of_workflow) return fmt::format(" [{}]", graph_.workflow(first));
    return fmt::format(" [{}: {} of {} variants]", graph_.workflow(first), cells.size(), of_workflow);
}

std::string StepNames::in_words(const std::vector<std::size_t>& cells) const {
    const std::size_t all = cells_of_scan_[graph_.cells[cells.front()].scan].size();
    if (all == 1) return {};
    if (cells.size() == all) return fmt::format("all {} variants", all);
    if (cells.size() == 1) return fmt::format("variant '{}'", variant(graph_.cells[cells.front()]));
    std::string names;
    for (const std::size_t cell : cells) names += (names.empty() ? "" : ", ") + variant(graph_.cells[cell]);
    return fmt::format("{} of {} variants: {}", cells.size(), all, names);
}

std::string StepNames::scan(const RunNode& node) const {
    return graph_.scan_names[node.scan] + in_brackets(cells(graph_.index(node), node.scan));
}

std::string StepNames::step(const RunNode& node) const {
    return node.step ? fmt::format("{}: {}", scan(node), graph_.label(node))
                     : fmt::format("{}: read", node.leaf.name());
}

}  // namespace scanmill::runner
