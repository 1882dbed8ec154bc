// SPDX-License-Identifier: GPL-3.0-or-later
// A comparison as JSON.
#include <cmath>
#include <nlohmann/json.hpp>

#include "scanmill/compare/formats.hpp"

namespace scanmill {

using Json = nlohmann::ordered_json;

namespace {

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(); }
Json number(const std::optional<double>& value) { return value ? number(*value) : Json(); }
Json text_or_null(const std::string& text) { return text.empty() ? Json() : Json(text); }

Json to_json(const RunFacts& run) {
    return {{"id", run.id},           {"started", run.started}, {"outcome", run.outcome}, {"version", run.version},
            {"machine", run.machine}, {"threads", run.threads}, {"jobs", run.jobs},       {"seconds", run.seconds}};
}

Json to_json(const MetricChange& change) {
    return {{"source", change.source},
            {"metric", change.metric},
            {"unit", name_of(change.unit)},
            {"length-unit", change.lengths == LengthUnit::unknown ? Json() : Json(symbol(change.lengths))},
            {"accepted", number(change.accepted)},
            {"found", number(change.found)},
            {"share", number(change.share())},
            {"rule", text_or_null(change.rule)},
            {"effect", name_of(change.effect)}};
}

Json to_json(const OutputChange& change) {
    return {{"file", change.file},
            {"accepted", text_or_null(change.accepted)},
            {"found", text_or_null(change.found)},
            {"effect", name_of(change.effect)}};
}

Json to_json(const CostChange& change) {
    return {{"cost", change.cost},
            {"before", number(change.before)},
            {"now", number(change.now)},
            {"share", number(change.share())},
            {"passes-before", change.passes_before},
            {"passes", change.passes},
            {"probability", number(change.probability)},
            {"rule", text_or_null(change.rule)},
            {"effect", name_of(change.effect)}};
}

Json to_json(const CellComparison& cell);

template <class Changes>
Json list_of(const Changes& changes) {
    Json list = Json::array();
    for (const auto& change : changes) list.push_back(to_json(change));
    return list;
}

Json to_json(const CellComparison& cell) {
    Json json{{"workflow", cell.workflow},
              {"scan", cell.scan},
              {"variant", cell.variant},
              {"verdict", name_of(cell.verdict)},
              {"reasons", cell.reasons},
              {"causes", cell.causes},
              {"seconds", cell.seconds},
              {"metrics", list_of(cell.metrics)},
              {"outputs", list_of(cell.outputs)},
              {"costs", list_of(cell.costs)},
              {"moved", cell.moved},
              {"command", text_or_null(cell.command)},
              {"values", Json::object()}};
    for (const CellValue& value : cell.values) json["values"][value.full_name()] = number(value.metric.value);
    return json;
}

Json counts_json(const Comparison& comparison) {
    Json counts = Json::object();
    for (const Verdict verdict : all_verdicts) counts[std::string(name_of(verdict))] = comparison.count(verdict);
    return counts;
}

Json accepted_json(const Comparison& comparison) {
    if (!comparison.accepted) return {};
    Json json = to_json(*comparison.accepted);
    json["folder"] = text_or_null(comparison.accepted_folder);
    const auto& acceptance = comparison.acceptance;
    json["who"] = acceptance ? Json(acceptance->who) : Json();
    json["why"] = acceptance ? Json(acceptance->why) : Json();
    json["at"] = acceptance ? Json(acceptance->at) : Json();
    return json;
}

/// Where the cell, and the change in it, are in the report.
Json place_of(const RankedChange& change, const Comparison& comparison) {
    Json json{{"cell", change.cell - comparison.cells.data()}};
    if (change.metric) json["metric"] = change.metric - change.cell->metrics.data();
    if (change.output) json["output"] = change.output - change.cell->outputs.data();
    if (change.cost) json["cost"] = change.cost - change.cell->costs.data();
    return json;
}

}  // namespace

Json report_json(const Comparison& comparison) {
    Json rules = Json::object();
    for (const GateRule& rule : comparison.gate.rules) rules[rule.metric] = rule.text;
    Json report{{"batch", comparison.batch},
                {"file", comparison.file},
                {"verdict", name_of(comparison.verdict)},
                {"tripped", comparison.tripped()},
                {"run", to_json(comparison.run)},
                {"accepted", accepted_json(comparison)},
                {"gate", {{"rules", std::move(rules)}, {"repeats", comparison.gate.repeats}}},
                {"counts", counts_json(comparison)},
                {"filters", comparison.filters},
                {"notes", comparison.notes},
                {"cells", list_of(comparison.cells)},
                {"changes", Json::array()}};
    for (const RankedChange& change : what_changed(comparison))
        report["changes"].push_back(place_of(change, comparison));
    return {{"scanmill", 1}, {"report", std::move(report)}};
}

Json verdict_json(const Comparison& comparison) {
    Json json{{"verdict", name_of(comparison.verdict)},
              {"tripped", comparison.tripped()},
              {"run", comparison.run.id},
              {"accepted", comparison.accepted ? Json(comparison.accepted->id) : Json()},
              {"counts", counts_json(comparison)},
              {"cells", Json::array()}};
    for (const CellComparison& cell : comparison.cells)
        if (cell.verdict != Verdict::passed && cell.verdict != Verdict::is_new)
            json["cells"].push_back({{"workflow", cell.workflow},
                                     {"scan", cell.scan},
                                     {"variant", cell.variant},
                                     {"verdict", name_of(cell.verdict)},
                                     {"reasons", cell.reasons}});
    return json;
}

}  // namespace scanmill
