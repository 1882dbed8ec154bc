// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Makes one recorded run of the shards of a batch.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "scanmill/records/run_records.hpp"

namespace scanmill {

struct MergedRuns {
    std::int64_t run = 0;  ///< number of the new run
    std::size_t shards = 0, cells = 0, moved = 0, copied = 0;  ///< outputs that were moved or copied
};

/// Merges the last run that ended in each of `folders` into a new run in `target`, and moves the outputs there, with
/// their descriptions and the failed results; it copies them to another file system, and then removes the copied ones.
/// The record is the one that a single run of the batch would have written: the same cells in the same order, with
/// their steps, costs and machines. Results do not depend on the machines' clocks, which may disagree: the order is
/// that of the batch, the duration is that of the longest shard, and the start is the earliest one that any clock
/// showed.
///
/// Throws Error before it changes anything if a shard is missing, given twice, unfinished, or of another batch,
/// version, build of a filter, seed or gate, and if an output is missing or has changed. Throws FolderInUse while a run
/// writes into a folder. An interrupted call can be repeated: outputs that are in `target` already are not moved again.
/// Cost: hashes the outputs.
MergedRuns merge_runs(const std::vector<std::filesystem::path>& folders, const std::filesystem::path& target,
                      const std::vector<std::string>& command_line, const std::function<void(std::string)>& warn);

}  // namespace scanmill
