// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/output_schemas.hpp"

#include <array>
#include <cassert>
#include <utility>

#include "scanmill/compare/documents.hpp"
#include "scanmill/describe/schema_parts.hpp"
#include "scanmill/kinds/document.hpp"
#include "scanmill/plugin/manifest.hpp"
#include "scanmill/report/documents.hpp"
#include "scanmill/session/chunks.hpp"

namespace scanmill {

namespace {

using namespace schema_parts;

Json bytes() { return described("In bytes.", count()); }
Json cell() { return object({{"scan", text()}, {"workflow", text()}, {"variant", text()}}); }

Json plan() {
    const Json input = object({{"name", text()}, {"kind", text()}, {"list", flag()}});
    const Json step = object({{"label", text()},
                              {"filter", text()},
                              {"version", count()},
                              {"key", text()},
                              {"line", count()},
                              {"column", count()},
                              {"in", described("Sources of values by input port.", map_of(list_of(text())))},
                              {"streams", described("Ports whose scan is read as a stream.", list_of(text()))},
                              {"parameters", map_of(text())},
                              {"expect?", list_of(text())},
                              {"measures?", described("The value that the step measures by the scan's truth.", text())},
                              {"file?", described("The batch file to which line and column refer.", text())}});
    const Json variant = object({{"name", text()},
                                 {"steps", described("Numbers of steps, from 0.", list_of(count()))},
                                 {"outputs", described("Sources of the outputs by file name.", map_of(text()))}});
    return object(
        {{"name", text()}, {"inputs", list_of(input)}, {"steps", list_of(step)}, {"variants", list_of(variant)}});
}

Json check_schema() {
    const Json diagnostic = object({{"severity", {{"enum", {"error", "warning"}}}},
                                    {"line", described("0: the message is about the whole file.", count())},
                                    {"column", count()},
                                    {"message", text()}});
    const Json file =
        object({{"file", text()},
                {"ok", flag()},
                {"diagnostics", list_of(diagnostic)},
                {"plan?", plan()},
                {"further-plans?",
                 described("Further plans of a workflow that a batch runs with different inputs.", list_of(plan()))}});
    return document("scanmill check, and run or batch of a file with errors", object({{"files", list_of(file)}}));
}

Json error_schema() {
    return document(
        "The error of any command",
        object({{"error",
                 object({{"message", text()},
                         {"where", described("Context of the error; the innermost part comes first.", list_of(text()))},
                         {"hint?", text()}})}}));
}

Json list_schema() {
    const Json unusable = object({{"name", text()}, {"manifest", text()}, {"reason", text()}});
    return document("scanmill list",
                    object({{"filters", list_of(declaration_schema())}, {"unusable", list_of(unusable)}}));
}

Json show_schema() { return document("scanmill show FILTER", object({{"filter", declaration_schema()}})); }

Json show_example_schema() {
    return document("scanmill show FILTER, the example",
                    object({{"filter", text()}, {"example", described("An example workflow.", text())}}));
}

/// The names of some members depend on the kind: those of its properties (`points`, `closed` …) and of its tables of
/// columns.
Json info_schema() {
    const Json position =
        described("x, y, z.", {{"type", "array"}, {"items", number()}, {"minItems", 3}, {"maxItems", 3}});
    const Json columns = list_of(object({{"name", text()}, {"type", text()}, {"components", count()}}));
    Json file = object({{"file", text()},
                        {"format?", text()},
                        {"encoding?", text()},
                        {"kind", text()},
                        {"views?", described("Number of views in the file; absent if there is one.", count())},
                        {"low?", position},
                        {"high?", position},
                        {"diagonal?", number()},
                        {"spacing?", number()},
                        {"stray?", described("Number of points that are far from all others.", count())},
                        {"robust-diagonal?", described("Diagonal without stray points; %diag refers to it.", number())},
                        {"stray-points?", list_of(object({{"number", count()}, {"position", position}}))},
                        {"not-finite?", count()},
                        {"unit?", length_unit_or_null()},
                        {"frame?", text()},
                        {"origin?", position},
                        {"comments?", list_of(text())},
                        {"warnings?", list_of(text())}});
    file["patternProperties"] = {{"columns$", columns}};
    file["additionalProperties"] = {{"type", {"integer", "boolean"}}, {"description", "A property of the kind."}};
    Json either{{"if", {{"required", Json::array({"error"})}}},
                {"then", object({{"file", text()}, {"error", text()}})},
                {"else", std::move(file)}};
    return document("scanmill info", object({{"files", list_of(std::move(either))}}));
}

Json measure_schema() {
    return document("scanmill measure", object({{"unit", length_unit_or_null()},
                                                {"metrics", metrics()},
                                                {"units", described("Units by metric.", map_of(unit()))},
                                                {"mesh", text()},
                                                {"truth", text()},
                                                {"warnings", list_of(text())}}));
}

Json cache_info_schema() {
    return document("scanmill cache info",
                    object({{"folder", text()},
                            {"steps", count()},
                            {"values", count()},
                            {"bytes", count()},
                            {"limit", bytes()},
                            {"by-filter", described("The largest first; (scans) and (other) are not filters.",
                                                    list_of(object({{"filter", text()}, {"bytes", bytes()}})))},
                            {"by-workflow", described("By the workflow that stored the results, the largest first.",
                                                      list_of(object({{"workflow", text()}, {"bytes", bytes()}})))},
                            {"by-age", described("By the time since the last use.",
                                                 list_of(object({{"used", text()}, {"bytes", bytes()}})))}}));
}

Json cache_clear_schema() { return document("scanmill cache clear", object({{"removed", bytes()}})); }

Json dry_run_schema() {
    const Json input = object({{"port", text()},
                               {"node", described("Number of the node that makes the value, from 0.", count())},
                               {"from", described("Output port of that node; empty: the node reads a file.", text())}});
    const Json node = object({{"key", text()},
                              {"step", text()},
                              {"in", list_of(input)},
                              {"file?", described("The file that the node reads; absent for other nodes.", text())},
                              {"streamed?", flag()},
                              {"parameter-files?", described("The files that the parameters of the step name, such as "
                                                             "one of poses; absent without any.",
                                                             list_of(text()))},
                              {"unreadable?", described("Why the file cannot be read.", text())},
                              {"cached", flag()},
                              {"why?", described("Why the node will run.", text())}});
    return document(
        "scanmill run or batch, the dry run",
        object(
            {{"nodes", list_of(node)},
             {"cells", list_of(joined(cell(), object({{"nodes", list_of(count())}, {"outputs", list_of(text())}})))}}));
}

template <class T>
Json document_of(const char* title) {
    return schema::document(title, JsonForm<T>::schema());
}

Json run_schema() { return document_of<RunDocument>("scanmill run"); }
Json runs_schema() { return document_of<RunsDocument>("scanmill runs DIR"); }
Json runs_prune_schema() { return document_of<PrunedDocument>("scanmill runs DIR, when it prunes"); }
Json runs_merge_schema() { return document_of<MergedDocument>("scanmill runs merge DIR…"); }
Json export_schema() { return document_of<ExportDocument>("scanmill export"); }
Json batch_status_schema() { return document_of<BatchStatusDocument>("scanmill batch, the states of chunks"); }
Json runs_show_schema() { return document_of<ShownRunDocument>("scanmill runs DIR show ID"); }

Json report_schema() {
    Json report = schema::object();
    schema::add(report, "report", JsonForm<ReportDocument>::schema());
    return schema::document("scanmill report DIR", report);
}

/// The schema of one line that a batch prints. The value of `event` decides which members the line has.
Json batch_event_schema() {
    const std::pair<const char*, Json> events[] = {{"run-started", JsonForm<RunStartedEvent>::schema()},
                                                   {"step-started", JsonForm<StepStartedEvent>::schema()},
                                                   {"step-progress", JsonForm<StepProgressEvent>::schema()},
                                                   {"warning", JsonForm<WarningEvent>::schema()},
                                                   {"step-ended", JsonForm<StepEndedEvent>::schema()},
                                                   {"output-written", JsonForm<OutputWrittenEvent>::schema()},
                                                   {"cell-ended", JsonForm<CellEndedEvent>::schema()},
                                                   {"pass-started", JsonForm<PassStartedEvent>::schema()},
                                                   {"verdict", JsonForm<VerdictEvent>::schema()},
                                                   {"run-ended", JsonForm<RunEndedEvent>::schema()}};
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                {"title", "One line of scanmill batch"},
                {"type", "object"},
                {"required", {"event", "at"}},
                {"properties", {{"event", {{"enum", Json::array()}}}}},
                {"allOf", Json::array()}};
    for (const auto& [name, members] : events) {
        schema["properties"]["event"]["enum"].push_back(name);
        const Json event =
            joined(object({{"event", text()}, {"at", described("Seconds since the start.", number())}}), members);
        schema["allOf"].push_back({{"if", {{"properties", {{"event", {{"const", name}}}}}}}, {"then", event}});
    }
    return schema;
}

constexpr std::array<std::pair<const char*, Json (*)()>, 19> outputs{{{"list", list_schema},
                                                                      {"show", show_schema},
                                                                      {"show-example", show_example_schema},
                                                                      {"check", check_schema},
                                                                      {"run", run_schema},
                                                                      {"batch-event", batch_event_schema},
                                                                      {"dry-run", dry_run_schema},
                                                                      {"runs", runs_schema},
                                                                      {"runs-prune", runs_prune_schema},
                                                                      {"runs-merge", runs_merge_schema},
                                                                      {"export", export_schema},
                                                                      {"batch-status", batch_status_schema},
                                                                      {"runs-show", runs_show_schema},
                                                                      {"info", info_schema},
                                                                      {"measure", measure_schema},
                                                                      {"cache-info", cache_info_schema},
                                                                      {"cache-clear", cache_clear_schema},
                                                                      {"report", report_schema},
                                                                      {"error", error_schema}}};

}  // namespace

const std::vector<std::string>& output_names() {
    static const std::vector<std::string> all = [] {
        std::vector<std::string> names;
        for (const auto& [name, make] : outputs) names.emplace_back(name);
        return names;
    }();
    return all;
}

std::string output_schema(std::string_view name) {
    for (const auto& [each, make] : outputs)
        if (name == each) return make().dump(2) + "\n";
    assert(false);
    return {};
}

}  // namespace scanmill
