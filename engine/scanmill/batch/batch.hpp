// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What work on a scan may cost before it is stopped, and how often it may be tried again.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/data/array.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/plan/expand.hpp"

namespace scanmill {

/// Most attempts after the first, so that a step that always fails does not take all night.
inline constexpr int most_retries = 10;

/// A cell is one scan under one variant of a workflow. 0: no limit.
struct Limits {
    u64 cell_memory = 0, step_memory = 0;  ///< bytes
    double cell_seconds = 0, step_seconds = 0;
    unsigned retries = 0;  ///< after the first attempt

    bool operator==(const Limits&) const = default;
};

// A batch as its file says it: which scans, under which workflows, with which values, limits and truth.
//
// Paths are relative to the batch file. Scans are named by globs: `*`, `?` and `[…]` within a name, `**` for any
// number of folders, never what begins with a dot. What `scans` has found stands here, sorted, every file once.

struct BatchScan {
    std::filesystem::path file;
    Position position;  ///< of the path in the batch file
    LengthUnit unit = LengthUnit::unknown;
    std::string frame;                   ///< its {stem} replaced; empty: what the workflow or the file says
    std::optional<RigidTransform> pose;  ///< applies to the scan's world coordinates
    std::filesystem::path pose_file;     ///< empty: the pose stands in the batch
    std::filesystem::path truth;         ///< empty: there is none
    Settings settings;                   ///< the scan's own, before the batch's
};

struct BatchWorkflow {
    std::filesystem::path file;
    Position position;
};

/// In Settings a value's `position` is that of its name.
struct Batch {
    std::string file, name, summary;
    std::vector<BatchScan> scans;  ///< entry by entry, within one by path
    std::vector<BatchWorkflow> workflows;
    Settings settings;
    Limits limits;
};

/// The batch in `text`; `diagnostics` is that of its file, and what is wrong goes there: all of it, each with its
/// place. What is right is still returned. Looks for the files that it names and reads those of poses, but no scan. A
/// name in `set` that no workflow declares is not found here (see plan_batch.hpp).
Batch parse_batch(const std::string& text, Diagnostics& diagnostics);

/// Whether the text is a batch rather than a workflow: it has the key `batch`.
bool is_batch(const std::string& text);

}  // namespace scanmill
