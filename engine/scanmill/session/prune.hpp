// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Removes old runs from the records of an output folder, with the files that only they wrote.

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "scanmill/records/run_records.hpp"

namespace scanmill {

/// What pruning removes, or would remove.
struct Pruned {
    std::vector<std::int64_t> runs;
    std::vector<std::filesystem::path> files;
    std::uint64_t bytes = 0;        ///< size of the files
    std::uint64_t preview_bytes = 0;  ///< size of the previews of files that no run that stays wrote or read
    std::size_t changed = 0;        ///< files of removed runs that stay, because something else wrote them anew
    std::size_t read = 0;  ///< files of removed runs that stay, because runs that stay read files of their names
    std::size_t outside = 0;  ///< files of removed runs that stay, because they are outside the folder
    std::uint64_t records_before = 0, records_after = 0;  ///< sizes of the file with the records
};

/// How many bytes of the folder each run takes: the files that it wrote, that are still there, and that no later run
/// names. A file that is gone counts in `gone`.
struct RunBytes {
    std::uint64_t bytes = 0;
    std::size_t gone = 0;
};
std::map<std::int64_t, RunBytes> bytes_by_run(const RunRecords& records);

/// Removes runs from the records of `folder`, and from `folder` the output files, their JSON and the failed results
/// that no other run names. Of every workflow or batch, the newest `keep` runs that ended stay, those that were
/// interrupted since, and every accepted run. A file stays if it is outside the folder, if its bytes are not those that
/// a removed run wrote, or if a run that stays reads a file of its name. Previews of files that no run that stays wrote
/// or read are removed, too. With `dry_run`, nothing is removed.
///
/// Throws FolderInUse while a run writes into the folder, and Error for a folder without records or if a file cannot be
/// removed. Files are removed before the records, so that a repeated call goes on after an interruption. Warns if a run
/// that stays lacks files. Pre: keep > 0. Cost: reads the bytes of the removed files.
Pruned prune(const std::filesystem::path& folder, std::size_t keep, bool dry_run,
             const std::vector<std::string>& command_line, const std::function<void(std::string)>& warn);

}  // namespace scanmill
