// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/describe/output_schemas.hpp"

#include <array>
#include <cassert>
#include <utility>

#include "scanmill/compare/comparison.hpp"
#include "scanmill/describe/schema_parts.hpp"
#include "scanmill/filter/parameter.hpp"
#include "scanmill/worker/report.hpp"

namespace scanmill {

namespace {

using namespace schema_parts;

Json outcome() { return names(Outcome::ok, Outcome::skipped); }
Json cause() { return names(Cause::refused, Cause::output); }
Json seconds() { return number(); }
Json bytes() { return described("In bytes.", count()); }
/// Of a cell or a step.
Json failure(const char* code) {
    return object({{"error?", described("The sentence, its frames and the hint.", text())},
                   {"cause?", cause()},
                   {"signal?", count()},
                   {code, count()}});
}
Json cell() { return object({{"scan", text()}, {"workflow", text()}, {"variant", text()}}); }

/// FilterSpec, as manifests contain it.
Json declaration() {
    const Json port = object({{"name", text()},
                              {"kind", text()},
                              {"help", text()},
                              {"list?", flag()},
                              {"optional?", flag()},
                              {"also?", described("Other kinds that it takes.", list_of(text()))},
                              {"like?", described("The input whose kind it has.", text())},
                              {"maker?", described("The filter that usually makes its value.", text())},
                              {"by-name?", described("No later step takes it unless it names it.", flag())}});
    const Json bound = object({{"value", number()}, {"inclusive", flag()}});
    const Json parameter =
        object({{"name", text()},
                {"type", names(ParameterType::boolean, ParameterType::ratio)},
                {"help", text()},
                {"list?", flag()},
                {"size?", count()},
                {"required?", flag()},
                {"word?", described("Accepted in place of a value.", text())},
                {"low?", bound},
                {"high?", bound},
                {"choices?", list_of(object({{"name", text()}, {"help", text()}}))},
                {"unless-given?", described("The default is not used if this parameter is given.", text())},
                {"takes-spacings?", flag()},
                {"default?",
                 described("As it is written in a workflow.", {{"type", {"string", "array"}}, {"items", text()}})}});
    const Json metric = object({{"name", text()},
                                {"unit", unit()},
                                {"help", text()},
                                {"headline?", flag()},
                                {"numbered?", described("Reported once per item: NAME, NAME@2, …", flag())},
                                {"better?", names(Better::larger, Better::smaller)}});
    return object({{"name", text()},
                   {"version", count()},
                   {"summary", text()},
                   {"source", text()},
                   {"ties", text()},
                   {"not-finite", text()},
                   {"inputs", list_of(port)},
                   {"outputs", list_of(port)},
                   {"parameters", list_of(parameter)},
                   {"metrics", list_of(metric)},
                   {"streams?", object({{"given", list_of(text())}})},
                   {"measures?", described("It measures the value at one input by the truth at another.",
                                           object({{"value", text()}, {"truth", text()}}))},
                   {"adds?", described("Columns that it may add.", list_of(text()))}});
}

Json plan() {
    const Json input = object({{"name", text()}, {"kind", text()}, {"list", flag()}});
    const Json step = object({{"label", text()},
                              {"filter", text()},
                              {"version", count()},
                              {"key", text()},
                              {"line", count()},
                              {"column", count()},
                              {"in", described("By port.", map_of(list_of(text())))},
                              {"streams", described("Ports whose scan is read as a stream.", list_of(text()))},
                              {"parameters", map_of(text())},
                              {"expect?", list_of(text())},
                              {"measures?", described("What it measures by the scan's truth.", text())},
                              {"file?", described("The batch that line and column are in.", text())}});
    const Json variant = object({{"name", text()},
                                 {"steps", described("Numbers of steps, from 0.", list_of(count()))},
                                 {"outputs", described("By file name.", map_of(text()))}});
    return object(
        {{"name", text()}, {"inputs", list_of(input)}, {"steps", list_of(step)}, {"variants", list_of(variant)}});
}

Json check_schema() {
    const Json diagnostic = object({{"severity", {{"enum", {"error", "warning"}}}},
                                    {"line", described("0: of the whole file.", count())},
                                    {"column", count()},
                                    {"message", text()}});
    const Json file = object(
        {{"file", text()},
         {"ok", flag()},
         {"diagnostics", list_of(diagnostic)},
         {"plan?", plan()},
         {"further-plans?", described("Of a workflow that a batch runs with different inputs.", list_of(plan()))}});
    return document("scanmill check --json, and run or batch of a file with errors",
                    object({{"files", list_of(file)}}));
}

Json error_schema() {
    return document("The error of any command with --json",
                    object({{"error", object({{"message", text()},
                                              {"where", described("The innermost first.", list_of(text()))},
                                              {"hint?", text()}})}}));
}

Json list_schema() {
    const Json unusable = object({{"name", text()}, {"manifest", text()}, {"reason", text()}});
    return document("scanmill list --json",
                    object({{"filters", list_of(declaration())}, {"unusable", list_of(unusable)}}));
}

Json show_schema() { return document("scanmill show FILTER --json", object({{"filter", declaration()}})); }

Json show_example_schema() {
    return document("scanmill show FILTER --example --json",
                    object({{"filter", text()}, {"example", described("A workflow.", text())}}));
}

/// A kind's properties (`points`, `closed` …) and the tables of its columns have names of their own.
Json info_schema() {
    const Json position =
        described("x, y, z.", {{"type", "array"}, {"items", number()}, {"minItems", 3}, {"maxItems", 3}});
    const Json columns = list_of(object({{"name", text()}, {"type", text()}, {"components", count()}}));
    Json file = object({{"file", text()},
                        {"format?", text()},
                        {"encoding?", text()},
                        {"kind", text()},
                        {"low?", position},
                        {"high?", position},
                        {"diagonal?", number()},
                        {"spacing?", number()},
                        {"stray?", described("Points far from all others.", count())},
                        {"robust-diagonal?", described("Without stray points: what %diag refers to.", number())},
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
    return document("scanmill info --json", object({{"files", list_of(std::move(either))}}));
}

Json measure_schema() {
    return document("scanmill measure --json", object({{"unit", length_unit_or_null()},
                                                       {"metrics", metrics()},
                                                       {"units", described("By metric.", map_of(unit()))},
                                                       {"mesh", text()},
                                                       {"truth", text()},
                                                       {"warnings", list_of(text())}}));
}

Json cache_info_schema() {
    return document(
        "scanmill cache info --json",
        object({{"folder", text()}, {"steps", count()}, {"values", count()}, {"bytes", count()}, {"limit", bytes()}}));
}

Json cache_clear_schema() { return document("scanmill cache clear --json", object({{"removed", bytes()}})); }

Json dry_run_schema() {
    const Json input = object({{"port", text()},
                               {"node", described("The number of another node, from 0.", count())},
                               {"from", described("Its output port; empty: the file.", text())}});
    const Json node = object({{"key", text()},
                              {"step", text()},
                              {"in", list_of(input)},
                              {"file?", described("Of a node that reads one.", text())},
                              {"streamed?", flag()},
                              {"unreadable?", described("Why the file cannot be read.", text())},
                              {"cached", flag()},
                              {"why?", described("Why it will run.", text())}});
    return document(
        "scanmill run or batch --dry-run --json",
        object(
            {{"nodes", list_of(node)},
             {"cells", list_of(joined(cell(), object({{"nodes", list_of(count())}, {"outputs", list_of(text())}})))}}));
}

/// Bytes and hash of a written file, and what became of the one of an earlier run.
Json file_members() {
    return object({{"sha256?", described("Of a written file.", text())},
                   {"bytes?", count()},
                   {"moved-to?", described("Where the file of an earlier run is, whose cell failed now.", text())}});
}

Json run_schema() {
    const Json step = joined(object({{"key", text()},
                                     {"step", text()},
                                     {"outcome", outcome()},
                                     {"origin", names(Origin::ran, Origin::same_inputs)},
                                     {"seconds", seconds()},
                                     {"why?", text()},
                                     {"peak-memory?", bytes()},
                                     {"filter?", text()},
                                     {"file?", described("Of a step that reads one.", text())},
                                     {"parameters?", map_of(text())},
                                     {"metrics?", metrics()},
                                     {"properties?", metrics()},
                                     {"warnings?", list_of(text())},
                                     {"log?", list_of(text())}}),
                             failure("exit-code?"));
    const Json file =
        joined(object({{"file", text()},
                       {"outcome", outcome()},
                       {"kind", text()},
                       {"properties", metrics()},
                       {"warnings?", list_of(text())},
                       {"not-moved?", described("Why the file of an earlier run is still there.", text())}}),
               file_members());
    const Json of_cell = joined(joined(cell(), object({{"outcome", outcome()},
                                                       {"seconds", seconds()},
                                                       {"steps", list_of(count())},
                                                       {"outputs", list_of(file)},
                                                       {"doubts?", list_of(text())}})),
                                failure("exit-code?"));
    return document(
        "scanmill run --json",
        object({{"workflow", text()}, {"interrupted", flag()}, {"steps", list_of(step)}, {"cells", list_of(of_cell)}}));
}

Json gate() {
    return object({{"rules", described("By metric.", map_of(text()))},
                   {"repeats", described("How often a run measures its costs.", count())}});
}

Json or_null(Json schema) {
    schema["type"] = Json::array({schema["type"], "null"});
    return schema;
}
Json count_or_null() { return or_null(count()); }
Json number_or_null() { return described("null: there is none, or it is infinite.", or_null(number())); }
Json verdict() { return names(Verdict::failed, Verdict::passed); }
Json effect() { return names(Effect::regression, Effect::listed); }

/// The verdict of a run, with the number of cells of every verdict.
Json verdict_of_run() {
    Json counts = object({});
    for (const Verdict each : all_verdicts) {
        counts["properties"][std::string(name_of(each))] = count();
        counts["required"].push_back(name_of(each));
    }
    return object({{"verdict", verdict()},
                   {"tripped", described("A cell regressed or is missing.", flag())},
                   {"counts", std::move(counts)}});
}

/// A cell with its verdict and the sentences that give reasons.
Json judged_cell() { return joined(cell(), object({{"verdict", verdict()}, {"reasons", list_of(text())}})); }

Json report_schema() {
    const Json run = object({{"id", count()},
                             {"started", text()},
                             {"outcome", text()},
                             {"version", text()},
                             {"machine", text()},
                             {"threads", count()},
                             {"jobs", count()},
                             {"seconds", seconds()}});
    Json accepted = joined(run, object({{"folder", described("null: the run's own.", or_null(text()))},
                                        {"who", or_null(text())},
                                        {"why", or_null(text())},
                                        {"at", described("null: it was not accepted.", or_null(text()))}}));
    accepted["type"] = Json::array({"object", "null"});
    const Json metric =
        object({{"source", described("A step, or an output's file.", text())},
                {"metric", text()},
                {"unit", unit()},
                {"length-unit", length_unit_or_null()},
                {"accepted", number_or_null()},
                {"found", number_or_null()},
                {"share", described("The difference as a share of the accepted value.", number_or_null())},
                {"rule", described("null: there is none.", or_null(text()))},
                {"effect", effect()}});
    const Json output = object({{"file", text()},
                                {"accepted", described("SHA-256; null: not written.", or_null(text()))},
                                {"found", described("SHA-256; null: not written.", or_null(text()))},
                                {"effect", effect()}});
    const Json cost = object({{"cost", {{"enum", {"seconds", "cpu-seconds", "memory"}}}},
                              {"before", described("The median of the earlier passes.", number_or_null())},
                              {"now", described("The median of this run's passes.", number_or_null())},
                              {"share", number_or_null()},
                              {"passes-before", count()},
                              {"passes", count()},
                              {"probability", described("Of the ranks, if nothing changed.", number_or_null())},
                              {"rule", or_null(text())},
                              {"effect", effect()}});
    const Json of_cell =
        joined(judged_cell(), object({{"causes", described("What differs in its files and steps.", list_of(text()))},
                                      {"seconds", seconds()},
                                      {"metrics", list_of(metric)},
                                      {"outputs", list_of(output)},
                                      {"costs", list_of(cost)},
                                      {"moved", described("Earlier outputs that were moved aside.", list_of(text()))},
                                      {"command", described("Reproduces the cell; null: it passed.", or_null(text()))},
                                      {"values", metrics()}}));
    const Json change = object({{"cell", count()}, {"metric?", count()}, {"output?", count()}, {"cost?", count()}});
    const Json report =
        joined(object({{"batch", text()},
                       {"file", text()},
                       {"run", run},
                       {"accepted", described("null: no run was accepted.", accepted)},
                       {"gate", gate()},
                       {"filters", list_of(text())},
                       {"notes", list_of(text())},
                       {"cells", list_of(of_cell)},
                       {"changes", described("Indices into the cells and their lists: the most important change first.",
                                             list_of(change))}}),
               verdict_of_run());
    return document("scanmill report DIR --json", object({{"report", report}}));
}

/// One line of a batch: `event` decides on the members.
Json batch_event_schema() {
    const Json about_step =
        object({{"node", described("The step's number, from 0.", count())},
                {"scan", text()},
                {"workflow", text()},
                {"variants?", described("That use it; absent if there is only one.", list_of(text()))},
                {"step", text()}});
    const std::pair<const char*, Json> events[] = {
        {"run-started", object({{"scanmill", {{"const", 1}}},
                                {"name", text()},
                                {"run?", described("Its number in the records.", count())},
                                {"jobs", count()},
                                {"threads", count()},
                                {"steps", count()},
                                {"cells", count()}})},
        {"step-started", joined(about_step, object({{"worker", count()}}))},
        {"step-progress", joined(about_step, object({{"percent", count()}}))},
        {"warning", joined(about_step, object({{"text", text()}}))},
        {"step-ended", joined(joined(about_step, object({{"outcome", outcome()},
                                                         {"origin", names(Origin::ran, Origin::same_inputs)},
                                                         {"why?", text()},
                                                         {"seconds", seconds()},
                                                         {"cpu-seconds", seconds()},
                                                         {"peak-memory", bytes()},
                                                         {"metrics?", metrics()},
                                                         {"log?", list_of(text())}})),
                              failure("exit-code?"))},
        {"output-written", object({{"scan", text()},
                                   {"file", text()},
                                   {"outcome", outcome()},
                                   {"sha256?", text()},
                                   {"bytes?", count()},
                                   {"properties", metrics()},
                                   {"warnings?", list_of(text())}})},
        {"cell-ended",
         joined(joined(cell(), object({{"cell", described("Its number, from 0.", count())},
                                       {"outcome", outcome()},
                                       {"seconds", seconds()},
                                       {"doubts?", list_of(text())},
                                       {"moved?", described("Files of an earlier run.",
                                                            list_of(object({{"file", text()}, {"to", text()}})))},
                                       {"not-moved?", list_of(object({{"file", text()}, {"why", text()}}))}})),
                failure("exit-code?"))},
        {"pass-started",
         described("Steps run again for their costs.", object({{"pass", count()}, {"passes", count()}}))},
        {"verdict", joined(object({{"run", count()}, {"accepted", count_or_null()}, {"cells", list_of(judged_cell())}}),
                           verdict_of_run())},
        {"run-ended", object({{"interrupted", flag()},
                              {"ok", count()},
                              {"doubtful", count()},
                              {"failed", count()},
                              {"skipped", count()}})}};
    Json schema{{"$schema", "http://json-schema.org/draft-07/schema#"},
                {"title", "One line of scanmill batch --json"},
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

Json run_summary() {
    const Json acceptance = object({{"at", text()},
                                    {"who", text()},
                                    {"why", text()},
                                    {"baseline", described("Later runs are compared with this one.", flag())},
                                    {"revoked?", object({{"at", text()}, {"who", text()}, {"why", text()}})}});
    return object({{"id", count()},
                   {"started", text()},
                   {"workflow", text()},
                   {"outcome", {{"enum", {"ok", "doubtful", "failed", "interrupted", "running"}}}},
                   {"killed?", described("It has no end.", flag())},
                   {"accepted?", list_of(acceptance)},
                   {"cells", count()},
                   {"doubtful", count()},
                   {"failed", count()},
                   {"ran", described("Steps that were computed.", count())},
                   {"cached", count()},
                   {"seconds", seconds()}});
}

Json runs_schema() { return document("scanmill runs DIR --json", object({{"runs", list_of(run_summary())}})); }

Json runs_show_schema() {
    const Json run = joined(run_summary(), object({{"file", text()},
                                                   {"arguments", list_of(text())},
                                                   {"seed", count()},
                                                   {"threads", count()},
                                                   {"version", text()},
                                                   {"jobs", count()},
                                                   {"machine", text()},
                                                   {"libraries", text()},
                                                   {"gate?", gate()}}));
    const Json failed = object(
        {{"error?", text()}, {"cause?", cause()}, {"number?", described("Of the signal, or the exit code.", count())}});
    const Json file =
        joined(object({{"file", text()}, {"kind", text()}, {"outcome", outcome()}, {"properties", metrics()}}),
               file_members());
    const Json pass = object({{"seconds", seconds()}, {"cpu-seconds", seconds()}, {"peak-memory", bytes()}});
    const Json of_cell = joined(
        joined(cell(), object({{"outcome", outcome()},
                               {"seconds", seconds()},
                               {"steps", list_of(count())},
                               {"outputs", list_of(file)},
                               {"doubts?", list_of(text())},
                               {"truth?", text()},
                               {"costs?", described("One per pass in which all of its steps ran.", list_of(pass))}})),
        failed);
    const Json step = joined(object({{"node", count()},
                                     {"workflow", text()},
                                     {"step", text()},
                                     {"filter", text()},
                                     {"version", count()},
                                     {"build", text()},
                                     {"scan", text()},
                                     {"variants", described("That use it.", list_of(text()))},
                                     {"measures?", described("What it measures by the cell's truth.", text())},
                                     {"key", text()},
                                     {"origin", text()},
                                     {"why", text()},
                                     {"outcome", outcome()},
                                     {"seconds", seconds()},
                                     {"cpu-seconds", seconds()},
                                     {"peak-memory", bytes()},
                                     {"threads", count()},
                                     {"attempts", count()},
                                     {"authored", map_of(text())},
                                     {"parameters", map_of(text())},
                                     {"metrics", metrics()},
                                     {"properties", metrics()},
                                     {"log?", list_of(text())},
                                     {"warnings?", list_of(text())}}),
                             failed);
    return document("scanmill runs DIR show ID --json",
                    object({{"run", run}, {"cells", list_of(of_cell)}, {"steps", list_of(step)}}));
}

constexpr std::array<std::pair<const char*, Json (*)()>, 15> outputs{{{"list", list_schema},
                                                                      {"show", show_schema},
                                                                      {"show-example", show_example_schema},
                                                                      {"check", check_schema},
                                                                      {"run", run_schema},
                                                                      {"batch-event", batch_event_schema},
                                                                      {"dry-run", dry_run_schema},
                                                                      {"runs", runs_schema},
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
