// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Comparisons of runs in records: which run, against which.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "scanmill/compare/comparison.hpp"

namespace scanmill {

/// A run in the records of an output folder.
struct RecordedRun {
    std::filesystem::path folder;
    std::optional<std::int64_t> run;  ///< nothing: see compare_recorded()

    /// "DIR" or "DIR:7". A folder whose name ends so is the folder.
    static RecordedRun parse(const std::string& text);
};

/// Compares a run, or the last that ended, with `against`: without a number the run that was accepted there for the
/// same batch, else the last one of the batch that ended; without `against` the accepted run in the same folder, if
/// there is one. Throws Error for a folder without records, without runs, an unknown run and one that has not ended.
Comparison compare_recorded(const RecordedRun& which, const std::optional<RecordedRun>& against,
                            const CommandFor& command);

/// The comparison at the end of a batch. Nothing: it has no gate, and no run was accepted.
std::optional<Comparison> verdict_of_batch(const std::filesystem::path& folder, std::int64_t run,
                                           const CommandFor& command);

/// The records of the folder, for acceptances. Throws Error for a folder without records.
RunRecords records_to_change(const std::filesystem::path& folder);

/// The number of the run, or of the last that ended. Throws Error as compare_recorded() does.
std::int64_t ended_run(const RunRecords& records, const RecordedRun& which);

/// RFC 4180: every number of every cell of the ended runs of this batch, or of one run, handed over run by run.
void write_csv(const RecordedRun& which, const std::function<void(const std::string&)>& write);

}  // namespace scanmill
