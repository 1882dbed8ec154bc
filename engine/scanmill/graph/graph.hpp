// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The graph of everything that one run computes: plans applied to scans.
///
/// Nodes are files to read (leaves) and steps to run, identified by their plan key. Two files with equal content have
/// equal keys and are one node; so are equal steps of different workflows. A cell is one scan under one variant of one
/// workflow. The graph contains all output files before anything runs.

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/base/hash.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/plan/plan.hpp"
#include "scanmill/plan/refusal.hpp"
#include "scanmill/plugin/library.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

/// An input file, with properties that the file itself may lack.
struct ScanFile {
    ScanFile(std::filesystem::path file) : path(std::move(file)) {}

    /// A file, or the name of one of its views (see file_view()). The folder of an object.
    std::filesystem::path path;
    /// The views of an object, which feed the workflow's first input in one run.
    std::vector<ScanFile> views;
    LengthUnit unit = LengthUnit::unknown;  ///< unknown: from the request, the workflow or the file
    /// {stem} in it becomes the stem of the file, or of the view of a file that holds several; see with_stem(). Empty:
    /// from the workflow or the file.
    std::string frame;
    std::optional<RigidTransform> pose;  ///< applied after reading; `to` names the new frame
    Refusal refusal;  ///< as a refused pose; if not empty, reading fails with it
    InvalidRows invalid = InvalidRows::by_format;  ///< by_format: from the request, the workflow or the format
    /// The scan's own files for the workflow's other inputs.
    std::map<std::string, std::vector<ScanFile>> inputs{};
};

/// The files that a plan runs over, the part of the plan that runs, and the folder for its outputs.
struct RunRequest {
    /// For the first input: one per run, or all in one run if the input is a list. Objects need a list, and each is one
    /// run; all scans are objects or none is. In a list, a file of several views stands for all of them; otherwise its
    /// views are read as one value.
    std::vector<ScanFile> scans;
    /// Files for inputs other than the first, used in every run. An input that is absent here takes ScanFile::inputs of
    /// the scan, or of the first scan if the first input is a list.
    std::map<std::string, std::vector<std::filesystem::path>> inputs;
    std::vector<std::filesystem::path> protected_files;  ///< more files that no output may replace
    std::filesystem::path output_folder;
    LengthUnit unit = LengthUnit::unknown;  ///< unit of every file; unknown: from the workflow or the file
    InvalidRows invalid =
        InvalidRows::by_format;  ///< rule for every file of points; by_format: from the workflow or the format
    std::uint64_t seed = 0;
    std::vector<std::string> only;  ///< variants; empty: all
    std::string until;  ///< last step to run; variants without this step do not run. Empty: all steps
    std::vector<std::string> save;  ///< steps (or step.port) to write in addition to the outputs
};

/// Throws Error for inputs that are missing or unknown, for unknown variants and steps, and for a rule for invalid rows
/// without an input of points.
void require_fits(const RunRequest& request, const Plan& plan);

struct NodeInput {
    std::string port;
    std::size_t node;
    std::string from;  ///< the node's output port; empty for leaves
};

/// A file that a parameter names.
struct ParameterFile {
    std::filesystem::path path;
    std::string content;  ///< hash of its bytes at planning time
};
constexpr auto fields(const ParameterFile*) {
    using R = ParameterFile;
    return std::tuple{field("path", &R::path), field("content", &R::content)};
}

/// A file to read.
struct LeafSource {
    std::filesystem::path file;
    std::string content;  ///< hash of the file's bytes
    Kind kind = kind_of<PointCloud>();
    LengthUnit unit = LengthUnit::unknown;  ///< unknown: from the file
    std::string frame;  ///< empty: from the file
    std::optional<RigidTransform> pose;
    InvalidRows invalid = InvalidRows::by_format;  ///< only for points
    bool is_streamed = false;  ///< read in chunks if the file allows it; not in the key, because results are equal
    std::vector<Kind> also{};  ///< other kinds that the file may hold
    Refusal refusal{};  ///< ScanFile::refusal
    u32 view = 0;  ///< from 1, of a file that holds several; 0: the whole file

    /// The name of what is read, for messages and read_file(): the file, or FILE#2.
    std::string name() const { return view_name(file, view).string(); }
};
constexpr auto fields(const LeafSource*) {
    using R = LeafSource;
    return std::tuple{field("file", &R::file),       field("content", &R::content),
                      field("kind", &R::kind),       field("unit", &R::unit),
                      field("frame", &R::frame),     field("pose", &R::pose),
                      field("invalid", &R::invalid), field("is-streamed", &R::is_streamed),
                      field("also", &R::also),       field("refusal", &R::refusal),
                      field("view", &R::view)};
}

/// Declared unit, frame, pose and rule for invalid rows as (name, text).
std::vector<std::pair<std::string, std::string>> declared_of(const LeafSource& leaf);

struct RunNode {
    std::string key;  ///< plan key: identifies the result before anything runs
    std::string code;  ///< steps only: hash of filter, builds, seed and the content of files that parameters name
    std::size_t plan = 0;  ///< index into RunGraph::plans
    std::optional<std::size_t> step;  ///< index into Plan::steps; empty for a leaf
    LeafSource leaf;
    bool is_scan = false;  ///< leaves only: the file feeds the workflow's first input
    std::vector<ParameterFile> parameter_files;  ///< steps only
    bool is_uncacheable = false;  ///< the node or one upstream reads a folder or a file that cannot be hashed
    std::string unreadable;  ///< leaves only: why the content could not be hashed, or must not be read
    std::vector<NodeInput> inputs;
    std::size_t scan = 0;  ///< index into RunGraph::scan_names; the scan of the first cell that contains the node
};

struct RunOutput {
    std::filesystem::path file;  ///< absolute
    std::size_t node;
    std::string port;
};

struct RunCell {
    std::size_t plan;  ///< index into RunGraph::plans
    std::size_t scan;  ///< index into RunGraph::scan_names
    std::size_t variant;  ///< index into Plan::variants
    std::vector<std::size_t> nodes;  ///< inputs before the steps that need them
    std::vector<RunOutput> outputs;
    std::size_t place = 0;  ///< place among all cells of the batch; 0 in runs that are not shards
};

struct RunGraph {
    std::vector<std::shared_ptr<const Plan>> plans;
    std::vector<std::string> scan_names;  ///< paths as given; the workflow's name if it takes a list of scans or none
    std::vector<RunNode> nodes;
    std::vector<RunCell> cells;
    std::uint64_t seed = 0;
    std::filesystem::path output_folder;  ///< absolute, without links

    /// The step of a node; nullptr for a leaf.
    const PlannedStep* step(const RunNode& node) const {
        return node.step ? &plans[node.plan]->steps[*node.step] : nullptr;
    }
    /// The step's label; "read" for a leaf.
    const std::string& label(const RunNode& node) const;
    const PlannedVariant& variant(const RunCell& cell) const { return plans[cell.plan]->variants[cell.variant]; }
    std::string workflow(const RunCell& cell) const { return workflow_name(*plans[cell.plan]); }
    std::size_t index(const RunNode& node) const { return static_cast<std::size_t>(&node - nodes.data()); }
    std::size_t index(const RunCell& cell) const { return static_cast<std::size_t>(&cell - cells.data()); }
};

struct GraphPart {
    std::shared_ptr<const Plan> plan;
    RunRequest request;
};

using HashOfFile = std::function<std::string(const std::filesystem::path&)>;

/// Builds the graph of all parts. `hash` returns the hash of a file's bytes: content_hash() or Cache::file_hash(). It
/// is called at most once per file. An input that cannot be read only marks its node. A parameter's file that cannot be
/// read makes the step uncacheable; its filter reports the error.
///
/// Throws Error if a request does not fit its plan, or if two cells would write the same file. Throws Error if an
/// output would replace or create an input, or would lie outside the output folder. Pre: all parts have the same seed
/// and the same output folder.
RunGraph make_graph(const std::vector<GraphPart>& parts, FilterLibrary& library, const HashOfFile& hash = content_hash);
RunGraph make_graph(const Plan& plan, FilterLibrary& library, const RunRequest& request,
                    const HashOfFile& hash = content_hash);

// Streams. A scan is read in chunks, and never loaded whole, if all steps that read it can read a stream. Some files
// turn out not to allow streaming when they are opened; such a scan is loaded whole, with the same results.

/// Whether the step can read its scan as a stream. The filter must support streams, and the scan must be its only wired
/// value (`inputs` is 1). The parameters in StreamSpec::given must have values. No parameter may be in spacings,
/// because the spacing is computed from all points at once.
bool can_stream(const PlannedStep& step, std::size_t inputs);

/// Whether scans of this workflow input are streamed if their files allow it. They must be points, at least one step
/// must read them, every such step must be able to stream, and no output may be the scan itself.
bool is_streamed(const Plan& plan, std::size_t input);

/// Sets LeafSource::is_streamed of every leaf by the same rules, applied to the steps and outputs in the graph. Leaves
/// with a pose are not streamed. Files whose first bytes show that they cannot be streamed are not streamed either.
void mark_streams(RunGraph& graph);

}  // namespace scanmill
