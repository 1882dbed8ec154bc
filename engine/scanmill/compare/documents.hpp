// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The documents of `scanmill report --json` and of the verdict of a batch.

#include <map>

#include "scanmill/compare/comparison.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

/// Values as a JSON object: numbers by CellValue::full_name().
template <>
struct JsonForm<std::vector<CellValue>> {
    static Json write(const std::vector<CellValue>& values) {
        Json json = Json::object();
        for (const CellValue& value : values) json[value.full_name()] = json_of(value.metric.value);
        return json;
    }
    static Json schema() { return schema::map_of(schema::or_null(JsonForm<double>::schema())); }
};

struct AcceptedRun {
    RunFacts run;
    std::string folder, who, why, at;
};
constexpr auto fields(const AcceptedRun*) {
    using R = AcceptedRun;
    return std::tuple{
        field("run", &R::run).flat(),
        field("folder", &R::folder, "Output folder of the accepted run; null: the folder of this run.").nullable(),
        field("who", &R::who).nullable(), field("why", &R::why).nullable(),
        field("at", &R::at, "Time of the acceptance; null: the run was not accepted.").nullable()};
}

struct GateDocument {
    Texts rules;
    unsigned repeats = 1;
};
constexpr auto fields(const GateDocument*) {
    using R = GateDocument;
    return std::tuple{field("rules", &R::rules, "Rules by metric."),
                      field("repeats", &R::repeats, "Number of times that a run measures its costs.")};
}

/// The position of a change in a ReportDocument: index of the cell, and index into one of the cell's lists.
struct ChangePlace {
    std::size_t cell = 0;
    std::optional<std::size_t> metric, output, cost;
};
constexpr auto fields(const ChangePlace*) {
    using R = ChangePlace;
    return std::tuple{field("cell", &R::cell), field("metric", &R::metric).optional(),
                      field("output", &R::output).optional(), field("cost", &R::cost).optional()};
}

struct ReportDocument {
    std::string batch, file;
    Verdict verdict = Verdict::passed;
    bool tripped = false;
    RunFacts run;
    std::optional<AcceptedRun> accepted;
    GateDocument gate;
    std::map<std::string, std::size_t> counts;
    std::vector<std::string> filters, notes;
    std::vector<CellComparison> cells;
    std::vector<ChangePlace> changes;
};
constexpr auto fields(const ReportDocument*) {
    using R = ReportDocument;
    return std::tuple{field("batch", &R::batch),
                      field("file", &R::file),
                      field("verdict", &R::verdict),
                      field("tripped", &R::tripped, "A cell regressed or is missing."),
                      field("run", &R::run),
                      field("accepted", &R::accepted, "null: no run was accepted."),
                      field("gate", &R::gate),
                      field("counts", &R::counts, "Number of cells by verdict."),
                      field("filters", &R::filters, "Filters whose version or build changed."),
                      field("notes", &R::notes),
                      field("cells", &R::cells),
                      field("changes", &R::changes,
                            "The most important change first; indices into `cells` and into the lists of the cell.")};
}

struct JudgedCell {
    std::string workflow, scan, variant;
    Verdict verdict = Verdict::passed;
    std::vector<std::string> reasons;
};
constexpr auto fields(const JudgedCell*) {
    using R = JudgedCell;
    return std::tuple{field("workflow", &R::workflow), field("scan", &R::scan), field("variant", &R::variant),
                      field("verdict", &R::verdict), field("reasons", &R::reasons)};
}

/// The event with the verdict of a batch, the counts, and the cells that are neither passed nor new.
struct VerdictEvent {
    Verdict verdict = Verdict::passed;
    bool tripped = false;
    std::int64_t run = 0;
    std::optional<std::int64_t> accepted;
    std::map<std::string, std::size_t> counts;
    std::vector<JudgedCell> cells;
};
constexpr auto fields(const VerdictEvent*) {
    using R = VerdictEvent;
    return std::tuple{field("verdict", &R::verdict), field("tripped", &R::tripped, "A cell regressed or is missing."),
                      field("run", &R::run),         field("accepted", &R::accepted),
                      field("counts", &R::counts),   field("cells", &R::cells)};
}
VerdictEvent verdict_event(const Comparison& comparison);

}  // namespace scanmill
