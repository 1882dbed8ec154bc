// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Batch files. A batch lists scans and the workflows that run on them, with their values, limits and further inputs.
/// It also states how results are measured by their truths, and by how much they may differ from the accepted run. A
/// batch is parsed, then checked together with its workflows.
///
/// Paths are relative to the batch file. A workflow may also be the name of a ready one; see workflow_file(). Scans are
/// named by paths with wildcards; see scan_files(). A parsed batch holds every file once. The files of one entry are
/// sorted.

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
#include "scanmill/plan/refusal.hpp"

namespace scanmill {

/// The most attempts after the first. The limit keeps a step that always fails from running all night.
inline constexpr int most_retries = 10;
/// The most `repeats` of a gate.
inline constexpr unsigned most_repeats = 20;

/// Limits for a cell, which is one scan under one variant of a workflow, and for a step. 0: no limit.
struct Limits {
    u64 cell_memory = 0, step_memory = 0;  ///< in bytes
    double cell_seconds = 0, step_seconds = 0;
    unsigned retries = 0;  ///< number of attempts after the first

    bool operator==(const Limits&) const = default;
};

/// The files of a scan for one workflow input other than the first; for a path with wildcards, those that match it.
/// They need not exist: a missing file fails only the cells that read it.
struct BatchInput {
    std::vector<std::filesystem::path> files;
    LengthUnit unit = LengthUnit::unknown;  ///< unknown: from the files
    std::string frame;  ///< with {stem} replaced; empty: from the files
    Position position;  ///< position of the input's name

    bool has_same_files(const BatchInput& other) const {
        return files == other.files && unit == other.unit && frame == other.frame;
    }
};

/// A scan, or an object of several views.
struct BatchScan {
    std::filesystem::path file;  ///< the folder, if this is an object
    std::vector<std::filesystem::path> views;  ///< the files of an object, sorted by name; empty for a scan
    Position position;  ///< position of the path in the batch file
    LengthUnit unit = LengthUnit::unknown;
    std::string frame;  ///< as written; {stem} is that of each view. Empty: from the workflow or the file
    std::optional<RigidTransform> pose;  ///< applies to the scan's world coordinates
    std::filesystem::path pose_file;  ///< empty: the pose is written in the batch
    Refusal refusal;  ///< why the cells of the scan fail in every workflow: its pose was refused; empty: they run
    /// By parameter: why a setting has no file. Fails the cells of workflows with this parameter.
    std::map<std::string, Refusal> missing_settings;
    /// The poses of an object's views: those that the batch names, else those beside the views. check_batch() uses the
    /// latter only where a workflow takes poses and no setting gives them.
    std::filesystem::path poses_file;
    Refusal poses_refusal;  ///< why the poses beside the views cannot be used
    std::string idle_poses;  ///< ObjectPoses::idle
    Position poses_position;  ///< position of the key `poses`; line 0: poses beside the views
    BatchInput truth;  ///< without files: the scan has no truth
    std::map<std::string, BatchInput> inputs;  ///< by name; check_batch() adds the truth if the batch measures
    InvalidRows invalid = InvalidRows::by_format;  ///< by_format: from the workflow or the format
    Position invalid_position;  ///< position of the key `invalid`
    Settings settings;  ///< values of this scan, which override Batch::settings

    bool is_object() const { return !views.empty(); }
    /// The scan's stem, or the object's name.
    std::string name() const;
};

struct BatchWorkflow {
    std::filesystem::path file;
    Position position;
};

/// The input that `measure` adds to the workflows of scans with a truth.
inline constexpr const char* truth_input = "truth";

/// The key `measure` of a batch. It adds an input for the truth to the workflows of scans that have a truth. It also
/// adds a measuring step `measure-VALUE` for every measured value to the end of these workflows. The workflows must not
/// use the names of that input and of these steps.
struct BatchMeasure {
    Position position;
    std::string filter;  ///< empty: the only installed filter that measures
    Position filter_position;
    std::vector<Reference> of;  ///< values to measure; empty: the outputs that the filter accepts
    std::vector<NamedExpression> parameters;
};

/// A parsed batch file. In Settings, the position of a value is the position of its name.
struct Batch {
    std::string file, name, summary;
    bool has_scans = false;  ///< whether the key `scans` is given; a batch of workflows without inputs has no scans
    std::vector<BatchScan> scans;  ///< in the order of the entries; the scans of one entry are sorted by path
    std::vector<BatchWorkflow> workflows;
    Settings settings;
    Limits limits;
    std::optional<BatchMeasure> measure;
    std::optional<Gate> gate;
};

/// Parses the batch in `text`. `diagnostics` belongs to the batch file. Reports all errors and returns everything that
/// could be read. Looks for the files that the batch names and reads poses, but opens no scan. Warns about a missing
/// truth, about a missing file of another input, and about a scan that its file of poses refuses.
///
/// check_batch() finds the other errors: names in `set` and `in` that no workflow declares, and errors in `measure` and
/// `gate` that depend on filters.
Batch parse_batch(const std::string& text, Diagnostics& diagnostics);

/// The names of the filters that measure a value by a truth and need no other input.
std::vector<std::string> measuring_filters(const FilterLibrary& library);

/// Whether the text is a batch and not a workflow. A batch has the key `batch`.
bool is_batch(const std::string& text);

/// One workflow with one set of values, and the scans that it runs on. Either all these scans have a truth and their
/// results are measured, or no result is measured.
struct BatchPart {
    std::shared_ptr<const Plan> plan;
    std::size_t workflow = 0;  ///< index into Batch::workflows
    std::vector<std::size_t> scans;  ///< indices into Batch::scans, ascending; empty for a workflow without inputs
    std::vector<std::string> only{};  ///< names of the variants to run; empty: all
    /// By index into Batch::scans: why the cells of a scan fail in this workflow only, as poses that it cannot take.
    std::map<std::size_t, Refusal> refusals{};
    std::string shape{};  ///< equal for parts whose plans differ at most in the poses of their objects
};

struct CheckedBatch {
    Batch batch;
    /// Sorted by workflow, then by the first scan. All scans of a part are objects, or none is. A workflow whose first
    /// input is a list takes an object in one run, and all scans of a part in one run. These scans must have the same
    /// files for the other inputs. Results of the run are measured if the scans have the same truth. A workflow without
    /// inputs runs once.
    std::vector<BatchPart> parts;
    /// Errors and warnings about the batch file, then about each readable workflow. A workflow is checked with every
    /// set of values with which it runs.
    std::vector<Diagnostics> diagnostics;

    /// Whether there are errors. If so, no part must be run.
    bool has_errors() const;
    /// The number of variants of all workflows. A variant in several parts of a workflow counts once.
    std::size_t variants() const;
    /// The number of cells: for every part, its variants times its runs. A run takes one scan, one object, a list of
    /// scans, or no scan.
    std::size_t cells() const;
    /// Why the cells of a scan fail in this part; empty: they run. `scan`: index into Batch::scans.
    const Refusal& refusal(const BatchPart& part, std::size_t scan) const;
    /// Whether the part has one run for every scan or object.
    bool has_run_per_scan(const BatchPart& part) const;
};

/// Checks the batch in `text`, the content of `file`. A scan's values are those of the batch's `set` and of its own
/// `set`, which takes precedence, as far as the workflow declares their names. Scans with equal values share a part and
/// its plan.
///
/// Reports errors at their positions in the batch: wrong values, undeclared names, inputs without files, outputs of two
/// cells with the same name, measured values that do not exist, and gate rules that apply to no metric.
CheckedBatch check_batch(const std::string& text, const std::string& file, const FilterLibrary& library);

}  // namespace scanmill
