// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Batch files: which scans run under which workflows, with which values, limits and further inputs, how results are
/// measured by their truths, and by how much they may differ from the accepted run. A batch is parsed, then checked
/// together with its workflows.
///
/// Paths are relative to the batch file. Scans are named by globs: `*`, `?` and `[…]` within a name, `**` for any
/// number of folders, never a name that begins with a dot. A parsed batch holds the files found, sorted, every file
/// once.

#include <filesystem>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/gate/gate.hpp"
#include "scanmill/plan/plan.hpp"

namespace scanmill {

/// Most attempts after the first, so that a step that always fails does not take all night.
inline constexpr int most_retries = 10;
/// The most `repeats` of a gate.
inline constexpr unsigned most_repeats = 20;

/// A cell is one scan under one variant of a workflow. 0: no limit.
struct Limits {
    u64 cell_memory = 0, step_memory = 0;  ///< bytes
    double cell_seconds = 0, step_seconds = 0;
    unsigned retries = 0;  ///< after the first attempt

    bool operator==(const Limits&) const = default;
};

/// The files of a scan for one further input of the workflows that have it. They need not exist: a missing file fails
/// the cells that read it.
struct BatchInput {
    std::vector<std::filesystem::path> files;
    LengthUnit unit = LengthUnit::unknown;  ///< unknown: the files' own
    std::string frame;                      ///< {stem} replaced; empty: the files' own
    Position position;                      ///< of the input's name

    bool has_same_files(const BatchInput& other) const {
        return files == other.files && unit == other.unit && frame == other.frame;
    }
};

struct BatchScan {
    std::filesystem::path file;
    Position position;  ///< of the path in the batch file
    LengthUnit unit = LengthUnit::unknown;
    std::string frame;                   ///< {stem} replaced; empty: the workflow's or the file's own
    std::optional<RigidTransform> pose;  ///< applies to the scan's world coordinates
    std::filesystem::path pose_file;     ///< empty: the pose is written in the batch
    BatchInput truth;                          ///< no files: the scan has none
    std::map<std::string, BatchInput> inputs;  ///< by the inputs' names; a checked batch that measures has the truth
    InvalidRows invalid = InvalidRows::by_format;  ///< by_format: from the workflow or the format
    Position invalid_position;                     ///< of the key `invalid`
    Settings settings;                   ///< the scan's own, which override the batch's
};

struct BatchWorkflow {
    std::filesystem::path file;
    Position position;
};

/// The input that `measure` adds to the workflows of scans with a truth.
inline constexpr const char* truth_input = "truth";

/// `measure`: the workflows of scans with a truth get one more input, the truth, wired by `in` alone, and at their end
/// a measuring step for every value, `measure-VALUE`. The workflows must not use these names.
struct BatchMeasure {
    Position position;
    std::string filter;  ///< empty: the only installed one that measures
    Position filter_position;
    std::vector<Reference> of;  ///< the values; empty: the workflows' outputs that the filter accepts
    std::vector<NamedExpression> parameters;
};

/// In Settings a value's `position` is that of its name.
struct Batch {
    std::string file, name, summary;
    std::vector<BatchScan> scans;  ///< in the order of the entries, within one by path
    std::vector<BatchWorkflow> workflows;
    Settings settings;
    Limits limits;
    std::optional<BatchMeasure> measure;
    std::optional<Gate> gate;
};

/// The batch in `text`; `diagnostics` is that of its file. All errors are reported, and everything that could be read
/// is returned. Looks for the files that the batch names and reads poses, but opens no scan. A missing truth or file of
/// a further input is a warning. Names in `set` and `in` that no workflow declares, and everything about `measure` and
/// `gate` that depends on filters, are found by check_batch().
Batch parse_batch(const std::string& text, Diagnostics& diagnostics);

/// The names of the filters that measure a value by a truth and need nothing else.
std::vector<std::string> measuring_filters(const FilterLibrary& library);

/// Whether the text is a batch rather than a workflow: it has the key `batch`.
bool is_batch(const std::string& text);

/// One workflow under one set of values, and its scans: those with a truth, whose results are measured, or those
/// without.
struct BatchPart {
    std::shared_ptr<const Plan> plan;
    std::size_t workflow = 0;  ///< index into Batch::workflows
    std::vector<std::size_t> scans;  ///< indices into Batch::scans, ascending; none for a workflow without inputs
    std::vector<std::string> only{};  ///< names of the variants to run; empty: all
};

struct CheckedBatch {
    Batch batch;
    /// Workflow by workflow, within one in the order of the first scan. A workflow whose first input is a list takes
    /// all scans of a part at once; they must agree on the files of the other inputs, and are measured if they agree on
    /// the truth. A workflow without inputs runs once.
    std::vector<BatchPart> parts;
    /// Problems of the batch file, then of each readable workflow, checked with all values that it is run with.
    std::vector<Diagnostics> diagnostics;

    /// If true, no part must be run.
    bool has_errors() const;
    /// Variants of all workflows; a variant in several parts of a workflow counts once.
    std::size_t variants() const;
    /// Runs times variants, over all workflows: a run takes one scan, a list of scans, or none.
    std::size_t cells() const;
};

/// Checks the batch in `text`, the content of `file`. A scan's values are the batch's `set`, overridden by its own, for
/// the names that the workflow declares. Scans with equal values share a part and its plan. Wrong values, and names
/// that no workflow declares, are reported at their position in the batch, as are inputs that nothing feeds, outputs of
/// two cells with one name, measured values that do not exist, and rules of the gate that nothing can meet or break.
CheckedBatch check_batch(const std::string& text, const std::string& file, const FilterLibrary& library);

}  // namespace scanmill
