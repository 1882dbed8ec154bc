// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/compare/recorded.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <limits>

#include "scanmill/base/error.hpp"
#include "scanmill/compare/formats.hpp"

namespace scanmill {

namespace {

namespace fs = std::filesystem;

fs::path file_in(const fs::path& folder) {
    if (std::error_code ignored; !fs::exists(folder / records_file, ignored))
        throw Error("there are no records in '{}'", folder.string()).hint("name the output folder of a run or batch");
    return folder / records_file;
}

RunRecords records_in(const fs::path& folder) { return RunRecords::read(file_in(folder)); }

Error no_ended_run(const std::string& what, const fs::path& folder) {
    return Error("no run{} in '{}' has ended", what, folder.string()).hint("scanmill runs " + folder.string());
}

/// The last run of the batch that ended; the last run of any batch if `batch` is empty.
std::optional<RunSummary> last_ended(const std::vector<RunSummary>& runs, const std::string& batch) {
    for (auto run = runs.rbegin(); run != runs.rend(); ++run)
        if (run->outcome && (batch.empty() || run->workflow == batch)) return *run;
    return std::nullopt;
}

std::int64_t ended_run(const std::vector<RunSummary>& runs, const RecordedRun& which) {
    if (runs.empty()) throw Error("no run is recorded in '{}'", which.folder.string());
    if (!which.run) {
        const std::optional<RunSummary> last = last_ended(runs, "");
        if (!last) throw no_ended_run("", which.folder);
        return last->id;
    }
    const auto found = std::ranges::find(runs, *which.run, &RunSummary::id);
    if (found == runs.end())
        throw Error("there is no run {} in '{}'; the runs are {} to {}", *which.run, which.folder.string(),
                    runs.front().id, runs.back().id);
    if (!found->outcome)
        throw Error("run {} in '{}' has not ended: it still runs, or it was killed", *which.run, which.folder.string());
    return *which.run;
}

/// The run with which `run` is compared. `run` is recorded in `records` of `folder`.
std::optional<Baseline> baseline_for(const RunDetails& run, const RunRecords& records, const fs::path& folder,
                                     const std::optional<RecordedRun>& against) {
    const std::string& batch = run.start.workflow;
    Baseline baseline;
    std::optional<RunRecords> others;
    if (against) others.emplace(records_in(against->folder));
    const RunRecords& source = others ? *others : records;
    if (against && against->run) {
        baseline.run = source.run(ended_run(source, *against));
    } else if (std::optional<Acceptance> accepted = source.baseline(batch)) {
        baseline.run = source.run(accepted->run);
        baseline.acceptance = std::move(accepted);
    } else if (against) {
        const std::optional<RunSummary> last = last_ended(source.runs(), batch);
        if (!last) throw no_ended_run(fmt::format(" of '{}'", batch), against->folder);
        baseline.run = source.run(last->id);
    } else {
        return std::nullopt;
    }
    const bool is_same_folder = !against || fs::weakly_canonical(against->folder) == fs::weakly_canonical(folder);
    if (!is_same_folder) baseline.folder = against->folder.string();
    // If the compared run is older than the baseline, only the costs of the baseline itself count.
    const std::int64_t first = baseline.run.summary.id;
    const std::int64_t end = !is_same_folder          ? std::numeric_limits<std::int64_t>::max()
                             : run.summary.id > first ? run.summary.id
                                                      : first + 1;
    if (run.summary.id != first || !is_same_folder) baseline.costs = source.past_costs(run.start, first, end);
    return baseline;
}

}  // namespace

RunRecords records_to_change(const fs::path& folder) { return RunRecords::append_to(file_in(folder)); }

RecordedRun RecordedRun::parse(const std::string& text) {
    const std::size_t colon = text.rfind(':');
    std::error_code ignored;
    if (colon == std::string::npos || colon == 0 || fs::is_directory(text, ignored)) return {text, std::nullopt};
    const char *begin = text.data() + colon + 1, *end = text.data() + text.size();
    std::int64_t run = 0;
    const auto [rest, error] = std::from_chars(begin, end, run);
    if (error != std::errc() || rest != end || run < 0)
        throw Error("'{}' is not the number of a run; expected DIR or DIR:RUN", std::string(begin, end));
    return {text.substr(0, colon), run};
}

std::int64_t ended_run(const RunRecords& records, const RecordedRun& which) { return ended_run(records.runs(), which); }

Comparison compare_recorded(const RecordedRun& which, const std::optional<RecordedRun>& against,
                            const CommandFor& command) {
    const RunRecords records = records_in(which.folder);
    const std::vector<RunSummary> runs = records.runs();
    const std::int64_t id = ended_run(runs, which);
    const RunDetails run = records.run(id);
    const std::optional<Baseline> baseline = baseline_for(run, records, which.folder, against);
    Comparison comparison =
        compare(run, baseline ? &*baseline : nullptr, command, records.acknowledgements(run.start.workflow));
    if (!which.run)
        for (const RunSummary& later : runs)
            if (later.id > id)
                comparison.notes.push_back(fmt::format("run {} of {} has not ended: it still runs, or it was killed",
                                                       later.id, later.started));
    return comparison;
}

std::optional<Comparison> verdict_of_batch(const fs::path& folder, std::int64_t run, const CommandFor& command) {
    Comparison comparison = compare_recorded({folder, run}, std::nullopt, command);
    if (!comparison.accepted && comparison.gate.rules.empty() && comparison.known() == 0) return std::nullopt;
    return comparison;
}

void write_csv(const RecordedRun& which, const std::function<void(const std::string&)>& write) {
    const RunRecords records = records_in(which.folder);
    const std::vector<RunSummary> runs = records.runs();
    const std::int64_t id = ended_run(runs, which);
    write(csv_header());
    if (which.run) {
        write(csv_rows(records.run(id)));
        return;
    }
    const std::string batch = std::ranges::find(runs, id, &RunSummary::id)->workflow;
    for (const RunSummary& run : runs)
        if (run.outcome && run.workflow == batch) write(csv_rows(records.run(run.id)));
}

}  // namespace scanmill
