// SPDX-License-Identifier: GPL-3.0-or-later
// Writes a comparison as JSON.
#include "scanmill/compare/documents.hpp"
#include "scanmill/compare/formats.hpp"

namespace scanmill {

namespace {

std::map<std::string, std::size_t> counts_of(const Comparison& comparison) {
    std::map<std::string, std::size_t> counts;
    for (const Verdict verdict : all_verdicts) counts.emplace(name_of(verdict), comparison.count(verdict));
    return counts;
}

std::optional<AcceptedRun> accepted_of(const Comparison& comparison) {
    if (!comparison.accepted) return std::nullopt;
    AcceptedRun accepted{*comparison.accepted, comparison.accepted_folder, {}, {}, {}};
    if (const auto& acceptance = comparison.acceptance) {
        accepted.who = acceptance->who;
        accepted.why = acceptance->why;
        accepted.at = acceptance->at;
    }
    return accepted;
}

/// The indices of the cell and of the change in the report.
ChangePlace place_of(const RankedChange& change, const Comparison& comparison) {
    const auto index = [](const auto* item, const auto& list) -> std::optional<std::size_t> {
        if (!item) return std::nullopt;
        return static_cast<std::size_t>(item - list.data());
    };
    return {*index(change.cell, comparison.cells), index(change.metric, change.cell->metrics),
            index(change.output, change.cell->outputs), index(change.cost, change.cell->costs)};
}

}  // namespace

Json report_json(const Comparison& comparison) {
    ReportDocument report{comparison.batch,
                          comparison.file,
                          comparison.verdict,
                          comparison.tripped(),
                          comparison.run,
                          accepted_of(comparison),
                          {},
                          counts_of(comparison),
                          comparison.filters,
                          comparison.notes,
                          comparison.cells,
                          {}};
    for (const GateRule& rule : comparison.gate.rules) report.gate.rules.emplace_back(rule.metric, rule.text);
    report.gate.repeats = comparison.gate.repeats;
    for (const RankedChange& change : what_changed(comparison)) report.changes.push_back(place_of(change, comparison));
    return {{"scanmill", 1}, {"report", json_of(report)}};
}

VerdictEvent verdict_event(const Comparison& comparison) {
    VerdictEvent event{comparison.verdict, comparison.tripped(), comparison.run.id, {}, counts_of(comparison), {}};
    if (comparison.accepted) event.accepted = comparison.accepted->id;
    for (const CellComparison& cell : comparison.cells)
        if (cell.verdict != Verdict::passed && cell.verdict != Verdict::is_new)
            event.cells.push_back({cell.workflow, cell.scan, cell.variant, cell.verdict, cell.reasons});
    return event;
}

}  // namespace scanmill
