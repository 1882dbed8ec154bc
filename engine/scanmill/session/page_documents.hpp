// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The data of the report page, as report/src/data.ts declares them. Texts are for people: they have their units.

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scanmill/compare/comparison.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

struct PageRun {
    std::int64_t id = 0;
    std::string started, version, machine;
    unsigned threads = 0, jobs = 0;
    double seconds = 0;
};
constexpr auto fields(const PageRun*) {
    using R = PageRun;
    return std::tuple{field("id", &R::id),           field("started", &R::started), field("version", &R::version),
                      field("machine", &R::machine), field("threads", &R::threads), field("jobs", &R::jobs),
                      field("seconds", &R::seconds)};
}

inline PageRun page_run(const RunFacts& run) {
    return {run.id, run.started, run.version, run.machine, run.threads, run.jobs, run.seconds};
}

struct PageMetric {
    std::string name, unit;
    std::optional<std::string> better;  ///< "smaller" or "larger"
};
constexpr auto fields(const PageMetric*) {
    using R = PageMetric;
    return std::tuple{field("name", &R::name), field("unit", &R::unit), field("better", &R::better)};
}

struct PageRule {
    std::string metric, rule, variant;
    std::size_t cells = 0;
    std::string median, median_change;
    std::size_t regressed = 0;
};
constexpr auto fields(const PageRule*) {
    using R = PageRule;
    return std::tuple{field("metric", &R::metric),      field("rule", &R::rule),
                      field("variant", &R::variant),    field("cells", &R::cells),
                      field("median", &R::median),      field("median-change", &R::median_change),
                      field("regressed", &R::regressed)};
}

struct PageValue {
    std::string source, name;
    std::optional<double> value;  ///< empty: not finite
    std::string text;
    std::optional<std::string> accepted;
};
constexpr auto fields(const PageValue*) {
    using R = PageValue;
    return std::tuple{field("source", &R::source), field("name", &R::name), field("value", &R::value),
                      field("text", &R::text), field("accepted", &R::accepted)};
}

struct PageStep {
    std::string label, filter;
    int version = 0;
    double seconds = 0, cpu_seconds = 0;
    u64 memory = 0;
    std::string origin, outcome;
    std::vector<std::array<std::string, 2>> parameters;
};
constexpr auto fields(const PageStep*) {
    using R = PageStep;
    return std::tuple{
        field("label", &R::label),     field("filter", &R::filter),           field("version", &R::version),
        field("seconds", &R::seconds), field("cpu-seconds", &R::cpu_seconds), field("memory", &R::memory),
        field("origin", &R::origin),   field("outcome", &R::outcome),         field("parameters", &R::parameters)};
}

struct PageOutput {
    std::string file;
    u64 bytes = 0;
    std::string sha256;
};
constexpr auto fields(const PageOutput*) {
    using R = PageOutput;
    return std::tuple{field("file", &R::file), field("bytes", &R::bytes), field("sha256", &R::sha256)};
}

struct PageHistogram {
    double low = 0, high = 0;
    std::vector<double> shares;
    std::optional<std::array<double, 2>> tolerance;
};
constexpr auto fields(const PageHistogram*) {
    using R = PageHistogram;
    return std::tuple{field("low", &R::low), field("high", &R::high), field("shares", &R::shares),
                      field("tolerance", &R::tolerance)};
}

struct PageColumn {
    std::string name, help;
};
constexpr auto fields(const PageColumn*) {
    return std::tuple{field("name", &PageColumn::name), field("help", &PageColumn::help)};
}

struct PagePart {
    std::string part;
    std::vector<std::string> texts;
};
constexpr auto fields(const PagePart*) {
    return std::tuple{field("part", &PagePart::part), field("texts", &PagePart::texts)};
}

struct PageLimit {
    std::string name, limit;
    std::string value;  ///< empty: the step has no such number
    bool met = true;
};
constexpr auto fields(const PageLimit*) {
    using R = PageLimit;
    return std::tuple{field("name", &R::name), field("limit", &R::limit), field("value", &R::value),
                      field("met", &R::met)};
}

struct PageLabel {
    std::string deviation;
    double value = 0;
    std::array<std::string, 3> position;
};
constexpr auto fields(const PageLabel*) {
    using R = PageLabel;
    return std::tuple{field("deviation", &R::deviation), field("value", &R::value), field("position", &R::position)};
}

struct PageFact {
    std::string name, text, help;
};
constexpr auto fields(const PageFact*) {
    using R = PageFact;
    return std::tuple{field("name", &R::name), field("text", &R::text), field("help", &R::help)};
}

struct PageInspection {
    std::string step, unit;
    std::array<double, 2> tolerance{};
    std::optional<PageHistogram> histogram;
    std::vector<PageLimit> expected;
    std::vector<PageColumn> columns;
    std::vector<PagePart> rows;
    std::vector<PageLabel> labels;
    std::vector<PageFact> facts;
};
constexpr auto fields(const PageInspection*) {
    using R = PageInspection;
    return std::tuple{
        field("step", &R::step),           field("unit", &R::unit),         field("tolerance", &R::tolerance),
        field("histogram", &R::histogram), field("expected", &R::expected), field("columns", &R::columns),
        field("rows", &R::rows),           field("labels", &R::labels),     field("facts", &R::facts)};
}

struct PageCell {
    std::size_t id = 0;
    std::string workflow, scan, variant;
    Verdict verdict = Verdict::passed;
    std::string outcome;
    double seconds = 0;
    std::vector<std::string> reasons, causes, doubts, warnings;
    std::optional<KnownDoubts> known;
    std::string command, error, log;
    std::vector<PageValue> values;
    std::vector<PageStep> steps;
    std::vector<PageOutput> outputs;
    std::map<std::string, std::string> pictures;  ///< keys of images by truth, scan, result, deviation, accepted
    std::optional<std::string> mesh;
    std::string deviation_unit;
    std::optional<PageHistogram> histogram;
    std::optional<PageInspection> inspection;
};
constexpr auto fields(const PageCell*) {
    using R = PageCell;
    return std::tuple{field("id", &R::id),
                      field("workflow", &R::workflow),
                      field("scan", &R::scan),
                      field("variant", &R::variant),
                      field("verdict", &R::verdict),
                      field("outcome", &R::outcome),
                      field("seconds", &R::seconds),
                      field("reasons", &R::reasons),
                      field("causes", &R::causes),
                      field("doubts", &R::doubts),
                      field("warnings", &R::warnings),
                      field("known", &R::known),
                      field("command", &R::command),
                      field("error", &R::error),
                      field("log", &R::log),
                      field("values", &R::values),
                      field("steps", &R::steps),
                      field("outputs", &R::outputs),
                      field("pictures", &R::pictures),
                      field("mesh", &R::mesh),
                      field("deviation-unit", &R::deviation_unit),
                      field("histogram", &R::histogram),
                      field("inspection", &R::inspection)};
}

struct PageChange {
    std::size_t cell = 0;
    std::string what, accepted, found, change;
    std::optional<double> share;
    std::string rule;
    Effect effect = Effect::listed;
};
constexpr auto fields(const PageChange*) {
    using R = PageChange;
    return std::tuple{field("cell", &R::cell),   field("what", &R::what),     field("accepted", &R::accepted),
                      field("found", &R::found), field("change", &R::change), field("share", &R::share),
                      field("rule", &R::rule),   field("effect", &R::effect)};
}

/// A run of the trends.
struct PageNight {
    std::int64_t id = 0;
    std::string started;
    bool accepted = false;
    std::string verdict;
};
constexpr auto fields(const PageNight*) {
    using R = PageNight;
    return std::tuple{field("id", &R::id), field("started", &R::started), field("accepted", &R::accepted),
                      field("verdict", &R::verdict)};
}

struct PageTrend {
    std::size_t cell = 0;
    std::string metric;
    std::vector<std::optional<double>> values;  ///< by night
};
constexpr auto fields(const PageTrend*) {
    using R = PageTrend;
    return std::tuple{field("cell", &R::cell), field("metric", &R::metric), field("values", &R::values)};
}

struct PageMesh {
    std::array<double, 3> low{}, high{};
    std::string positions, triangles;
    std::size_t vertices = 0;
    std::optional<std::string> deviation;
    double deviation_low = 0, deviation_high = 0;
};
constexpr auto fields(const PageMesh*) {
    using R = PageMesh;
    return std::tuple{field("low", &R::low),
                      field("high", &R::high),
                      field("positions", &R::positions),
                      field("triangles", &R::triangles),
                      field("vertices", &R::vertices),
                      field("deviation", &R::deviation),
                      field("deviation-low", &R::deviation_low),
                      field("deviation-high", &R::deviation_high)};
}

struct PageDocument {
    std::string batch;
    Verdict verdict = Verdict::passed;
    std::string folder;
    std::map<std::string, std::size_t> counts;
    PageRun run;
    std::optional<PageRun> accepted;
    std::optional<KnownDoubts> acceptance;
    std::vector<std::array<std::string, 2>> facts;
    std::string default_metric;
    std::vector<PageMetric> metrics;
    std::vector<PageRule> rules;
    std::vector<PageCell> cells;
    std::vector<PageChange> changes;
    std::vector<PageNight> runs;
    std::vector<PageTrend> trends;
    std::map<std::string, std::string> images;  ///< data addresses of PNG
    std::map<std::string, PageMesh> meshes;
    std::vector<std::string> notes;
};
constexpr auto fields(const PageDocument*) {
    using R = PageDocument;
    return std::tuple{
        field("batch", &R::batch),           field("verdict", &R::verdict), field("folder", &R::folder),
        field("counts", &R::counts),         field("run", &R::run),         field("accepted", &R::accepted),
        field("acceptance", &R::acceptance), field("facts", &R::facts),     field("default-metric", &R::default_metric),
        field("metrics", &R::metrics),       field("rules", &R::rules),     field("cells", &R::cells),
        field("changes", &R::changes),       field("runs", &R::runs),       field("trends", &R::trends),
        field("images", &R::images),         field("meshes", &R::meshes),   field("notes", &R::notes)};
}

struct SheetPicture {
    std::string image, caption;
};
constexpr auto fields(const SheetPicture*) {
    return std::tuple{field("image", &SheetPicture::image), field("caption", &SheetPicture::caption)};
}

struct Sheet {
    std::string workflow, scan, variant;
    Verdict verdict = Verdict::passed;
    std::string outcome;
    std::vector<std::string> reasons, doubts;
    std::optional<KnownDoubts> known;
    std::vector<std::string> warnings;
    std::string error;
    std::vector<std::array<std::string, 2>> facts;
    std::optional<PageInspection> inspection;
    std::vector<SheetPicture> pictures;
};
constexpr auto fields(const Sheet*) {
    using R = Sheet;
    return std::tuple{
        field("workflow", &R::workflow), field("scan", &R::scan),       field("variant", &R::variant),
        field("verdict", &R::verdict),   field("outcome", &R::outcome), field("reasons", &R::reasons),
        field("doubts", &R::doubts),     field("known", &R::known),     field("warnings", &R::warnings),
        field("error", &R::error),       field("facts", &R::facts),     field("inspection", &R::inspection),
        field("pictures", &R::pictures)};
}

struct SheetDocument {
    std::string batch, folder;
    PageRun run;
    std::vector<Sheet> sheets;
    std::map<std::string, std::string> images;  ///< data addresses of PNG
    std::vector<std::string> notes;
};
constexpr auto fields(const SheetDocument*) {
    using R = SheetDocument;
    return std::tuple{field("batch", &R::batch),   field("folder", &R::folder), field("run", &R::run),
                      field("sheets", &R::sheets), field("images", &R::images), field("notes", &R::notes)};
}

}  // namespace scanmill
