// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/worker/report.hpp"

#include <algorithm>
#include <set>

namespace scanmill {

Error Failure::whole() const {
    Error all = error;
    if (!equal_scan.empty())
        all.add_frame(fmt::format("on scan '{}', which equals '{}'", scan, equal_scan));
    else if (!scan.empty())
        all.add_frame(fmt::format("on scan '{}'", scan));
    return all;
}

std::vector<std::string> unmet_by(const std::vector<std::size_t>& cells, const RunGraph& graph,
                                  const std::vector<NodeReport>& reports) {
    std::set<std::size_t> nodes;
    for (const std::size_t cell : cells) nodes.insert(graph.cells[cell].nodes.begin(), graph.cells[cell].nodes.end());
    std::vector<std::string> unmet;
    for (const std::size_t node : nodes)
        if (const Failure& failure = reports[node].failure; failure.cause == Cause::expectation)
            unmet.push_back(fmt::format("{}: {}", graph.label(graph.nodes[node]), failure.error.sentence()));
    return unmet;
}

std::vector<std::string> doubts_about(const std::vector<RunOutput>& outputs, const std::vector<std::size_t>& nodes,
                                      const RunGraph& graph, const std::vector<NodeReport>& reports) {
    std::set<std::pair<std::size_t, std::string>> used;  // node and port
    for (const RunOutput& output : outputs) used.emplace(output.node, output.port);
    for (const std::size_t node : nodes)
        for (const NodeInput& input : graph.nodes[node].inputs) used.emplace(input.node, input.from);
    std::vector<std::string> doubts;
    for (const std::size_t node : nodes)
        for (const Doubt& doubt : reports[node].doubts)
            if (doubt.port.empty() || used.contains({node, doubt.port}))
                doubts.push_back(fmt::format("{}: {}", graph.label(graph.nodes[node]), doubt.text));
    return doubts;
}

Outcome RunReport::outcome() const {
    Outcome worst = Outcome::ok;
    for (const CellReport& cell : cells) worst = std::max(worst, std::min(cell.outcome, Outcome::failed));
    return worst;
}

bool is_of_machine(const Failure& failure) {
    const Remedy remedy = failure.error.remedy();
    return failure && (remedy == Remedy::use_other_disk || remedy == Remedy::add_memory);
}

bool RunReport::has_machine_failure() const {
    return std::ranges::any_of(cells, [](const CellReport& cell) { return is_of_machine(cell.failure); });
}

bool RunReport::has_fault() const {
    return std::ranges::any_of(cells, [](const CellReport& cell) { return cell.failure.cause == Cause::fault; });
}

}  // namespace scanmill
