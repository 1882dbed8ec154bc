// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Chooses two recorded runs and compares them.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>

#include "scanmill/compare/comparison.hpp"

namespace scanmill {

/// A run in the records of an output folder.
struct RecordedRun {
    std::filesystem::path folder;
    std::optional<std::int64_t> run;  ///< number of the run; empty: see compare_recorded()

    /// Parses "DIR" or "DIR:7". If a folder with the name "DIR:7" exists, the text names that folder.
    static RecordedRun parse(const std::string& text);
};

/// Compares the run `which` with the run `against`. If `which` has no number, it is the last run that ended. If
/// `against` has no number, it is the accepted run of the same batch in that folder, or else the last run of the batch
/// that ended. Without `against`, compares with the accepted run in the folder of `which`, if there is one.
///
/// Throws Error for a folder without records or without runs, for an unknown run, and for a run that has not ended.
Comparison compare_recorded(const RecordedRun& which, const std::optional<RecordedRun>& against,
                            const CommandFor& command);

/// The comparison at the end of a batch; empty if the batch has no gate, no run was accepted and no doubt is known.
std::optional<Comparison> verdict_of_batch(const std::filesystem::path& folder, std::int64_t run,
                                           const CommandFor& command);

/// Opens the records of the folder for new acceptances. Throws Error for a folder without records.
RunRecords records_to_change(const std::filesystem::path& folder);

/// The number of the run `which`; without a number, that of the last run that ended. Throws Error as compare_recorded()
/// does.
std::int64_t ended_run(const RunRecords& records, const RecordedRun& which);

/// Writes a CSV file (RFC 4180) with every number of every cell. If `which` has a number, the file contains that run;
/// if not, all ended runs of the batch whose run ended last. `write` is called once for the header and once per run.
void write_csv(const RecordedRun& which, const std::function<void(const std::string&)>& write);

}  // namespace scanmill
