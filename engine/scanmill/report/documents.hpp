// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The JSON that `run`, `batch` and `runs` print with --json, composed of the records of a run.

#include "scanmill/report/run_report.hpp"

namespace scanmill {

/// The document that `scanmill run --json` prints.
struct RunDocument {
    std::string workflow;
    bool interrupted = false;
    std::vector<StepRecord> steps;
    std::vector<CellRecord> cells;
};
constexpr auto fields(const RunDocument*) {
    using R = RunDocument;
    return std::tuple{field("workflow", &R::workflow), field("interrupted", &R::interrupted), field("steps", &R::steps),
                      field("cells", &R::cells)};
}

// The documents that `scanmill runs` prints.

struct RevocationDocument {
    std::string at, who, why;
};
constexpr auto fields(const RevocationDocument*) {
    using R = RevocationDocument;
    return std::tuple{field("at", &R::at), field("who", &R::who), field("why", &R::why)};
}

struct AcceptanceDocument {
    std::string at, who, why;
    bool baseline = false;
    std::optional<RevocationDocument> revoked;
};
constexpr auto fields(const AcceptanceDocument*) {
    using R = AcceptanceDocument;
    return std::tuple{field("at", &R::at), field("who", &R::who), field("why", &R::why),
                      field("baseline", &R::baseline, "Later runs are compared with this one."),
                      field("revoked", &R::revoked, "null: the acceptance is valid.")};
}

struct ListedRun {
    RunSummary summary;
    bool killed = false;
    std::vector<AcceptanceDocument> accepted;
    std::uint64_t bytes = 0;
    std::size_t gone = 0;
};
constexpr auto fields(const ListedRun*) {
    using R = ListedRun;
    return std::tuple{
        field("summary", &R::summary).flat(),
        field("killed", &R::killed, "The run ended without an outcome.").optional(),
        field("accepted", &R::accepted).optional(),
        field("bytes", &R::bytes,
              "Bytes of the files that the run wrote, that are there, and that no later run names."),
        field("gone", &R::gone, "Files that the run wrote, that are gone, and that no later run names.").optional()};
}

/// What `scanmill runs DIR --prune` removed, or would remove.
struct PrunedDocument {
    std::vector<std::int64_t> runs;
    std::vector<std::string> files;
    std::uint64_t bytes = 0, preview_bytes = 0, records_before = 0, records_after = 0;
};
constexpr auto fields(const PrunedDocument*) {
    using R = PrunedDocument;
    return std::tuple{field("runs", &R::runs, "Numbers of the removed runs."),
                      field("files", &R::files),
                      field("bytes", &R::bytes, "Size of the removed files."),
                      field("preview-bytes", &R::preview_bytes, "Size of the removed previews."),
                      field("records-before", &R::records_before, "Size of the file with the records before."),
                      field("records-after", &R::records_after, "Size of the file with the records now.")};
}

struct MergedDocument {
    std::int64_t run = 0;
    std::size_t shards = 0, cells = 0, moved = 0, copied = 0;
};
constexpr auto fields(const MergedDocument*) {
    using R = MergedDocument;
    return std::tuple{field("run", &R::run, "Number of the new run."), field("shards", &R::shards),
                      field("cells", &R::cells), field("moved", &R::moved, "Files that were moved."),
                      field("copied", &R::copied, "Files that were copied to another file system.")};
}

struct ExportDocument {
    std::size_t chunks = 0, cells = 0;
    double core_seconds = 0, longest = 0;
    unsigned minutes = 0, megabytes = 0;
    std::size_t estimated = 0;
};
constexpr auto fields(const ExportDocument*) {
    using R = ExportDocument;
    return std::tuple{
        field("chunks", &R::chunks),
        field("cells", &R::cells),
        field("core-seconds", &R::core_seconds, "Expected time of all cells on one core."),
        field("longest-seconds", &R::longest, "Expected time of the longest chunk."),
        field("minutes", &R::minutes, "Time limit of a chunk."),
        field("megabytes", &R::megabytes, "Memory of a chunk."),
        field("estimated-units", &R::estimated, "Units whose time is estimated from the sizes of files.")};
}

struct RunsDocument {
    std::vector<ListedRun> runs;
};
constexpr auto fields(const RunsDocument*) { return std::tuple{field("runs", &RunsDocument::runs)}; }

struct ShownRun {
    ListedRun run;
    RunStart start;
};
constexpr auto fields(const ShownRun*) {
    return std::tuple{field("run", &ShownRun::run).flat(), field("start", &ShownRun::start).flat()};
}

struct ShownRunDocument {
    ShownRun run;
    std::vector<CellRecord> cells;
    std::vector<StepRecord> steps;
};
constexpr auto fields(const ShownRunDocument*) {
    using R = ShownRunDocument;
    return std::tuple{field("run", &R::run), field("cells", &R::cells), field("steps", &R::steps)};
}

// Events of a batch. These structs hold the members that follow `event` and `at`.

struct RunStartedEvent {
    int scanmill = 1;
    std::string name;
    std::int64_t run = 0;
    unsigned jobs = 0, threads = 0;
    std::size_t steps = 0, cells = 0;
};
constexpr auto fields(const RunStartedEvent*) {
    using R = RunStartedEvent;
    return std::tuple{field("scanmill", &R::scanmill, "Version of the format."),
                      field("name", &R::name),
                      field("run", &R::run, "Number of the run in the records; absent: not recorded.").optional(),
                      field("jobs", &R::jobs),
                      field("threads", &R::threads),
                      field("steps", &R::steps),
                      field("cells", &R::cells)};
}

struct StepName {
    std::size_t node = 0;
    std::string scan, workflow, step;
    std::vector<std::string> variants;
};
constexpr auto fields(const StepName*) {
    using R = StepName;
    return std::tuple{
        field("node", &R::node, "Number of the step, from 0."), field("scan", &R::scan),
        field("workflow", &R::workflow), field("step", &R::step),
        field("variants", &R::variants, "Variants that use the step; absent if the workflow has only one.").optional()};
}

struct StepStartedEvent {
    StepName step;
    std::size_t worker = 0;
};
constexpr auto fields(const StepStartedEvent*) {
    using R = StepStartedEvent;
    return std::tuple{field("step", &R::step).flat(), field("worker", &R::worker)};
}

struct StepProgressEvent {
    StepName step;
    int percent = 0;
};
constexpr auto fields(const StepProgressEvent*) {
    using R = StepProgressEvent;
    return std::tuple{field("step", &R::step).flat(), field("percent", &R::percent)};
}

struct WarningEvent {
    StepName step;
    std::string text;
};
constexpr auto fields(const WarningEvent*) {
    using R = WarningEvent;
    return std::tuple{field("step", &R::step).flat(), field("text", &R::text)};
}

struct StepEndedEvent {
    std::vector<std::string> variants;
    StepRecord record;
};
constexpr auto fields(const StepEndedEvent*) {
    using R = StepEndedEvent;
    return std::tuple{
        field("variants", &R::variants, "Variants that use the step; absent if the workflow has only one.").optional(),
        field("record", &R::record).flat()};
}

struct OutputWrittenEvent {
    std::string scan;
    OutputRecord record;
};
constexpr auto fields(const OutputWrittenEvent*) {
    using R = OutputWrittenEvent;
    return std::tuple{field("scan", &R::scan), field("record", &R::record).flat()};
}

struct CellEndedEvent {
    std::size_t cell = 0;
    CellRecord record;
};
constexpr auto fields(const CellEndedEvent*) {
    using R = CellEndedEvent;
    return std::tuple{field("cell", &R::cell, "Number of the cell, from 0."), field("record", &R::record).flat()};
}

struct PassStartedEvent {
    unsigned pass = 0, passes = 0;
};
constexpr auto fields(const PassStartedEvent*) {
    using R = PassStartedEvent;
    return std::tuple{
        field("pass", &R::pass, "Number of the pass, in which the steps run again to measure their costs."),
        field("passes", &R::passes)};
}

struct RunEndedEvent {
    bool interrupted = false;
    std::size_t ok = 0, doubtful = 0, failed = 0, skipped = 0;
};
constexpr auto fields(const RunEndedEvent*) {
    using R = RunEndedEvent;
    return std::tuple{field("interrupted", &R::interrupted), field("ok", &R::ok, "Number of cells."),
                      field("doubtful", &R::doubtful, "Number of cells."),
                      field("failed", &R::failed, "Number of cells."),
                      field("skipped", &R::skipped, "Number of cells.")};
}

}  // namespace scanmill
