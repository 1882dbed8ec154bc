// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plans laid out over actual scans: the graph of everything that one run computes.
///
/// Nodes are files to read (leaves) and steps to run, identified by their plan key: what two cells have in common, down
/// to two files of equal content, is one node, also when the cells belong to different workflows. A cell is one scan
/// under one variant of one workflow. The graph says what will be
/// written where before anything runs; an executor, or an export to another scheduler, only has to follow it.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/base/hash.hpp"
#include "scanmill/graph/request.hpp"

namespace scanmill {

struct NodeInput {
    std::string port;
    std::size_t node;
    std::string from;  ///< the node's output port; empty for leaves
};

/// A file that a parameter names, as it was when the run was planned.
struct ParameterFile {
    std::filesystem::path path;
    std::string content;
};

/// A file to read, and as what.
struct LeafSource {
    std::filesystem::path file;
    std::string content;  ///< hash of the file's bytes
    Kind kind = kind_of<PointCloud>();
    LengthUnit unit = LengthUnit::unknown;  ///< unknown: what the file says
    std::string frame;  ///< empty: what the file says
    std::optional<RigidTransform> pose;
    bool is_streamed = false;  ///< read piece by piece, if the file allows it; in no key: values are the same
};

/// What was declared of the file: unit, frame and pose, as far as there is something, as text.
std::vector<std::pair<std::string, std::string>> declared_of(const LeafSource& leaf);

struct RunNode {
    std::string key;  ///< plan key: what identifies the result before anything runs
    std::string code;  ///< of a step: hash of filter, builds, seed and the content of files that parameters name
    std::size_t plan = 0;  ///< index into RunGraph::plans
    std::optional<std::size_t> step;  ///< index into Plan::steps; nothing: a leaf
    LeafSource leaf;
    bool is_scan = false;  ///< of a leaf: it feeds the workflow's first input
    std::vector<ParameterFile> parameter_files;  ///< of a step
    /// It, or something before it, reads what has no content to be known by: a folder, a file that is not there.
    bool is_uncacheable = false;
    std::string unreadable;  ///< of a leaf: why its content could not be hashed
    std::vector<NodeInput> inputs;
    std::size_t scan = 0;  ///< the first cell's
};

struct RunOutput {
    std::filesystem::path file;  ///< absolute
    std::size_t node;
    std::string port;
};

struct RunCell {
    std::size_t plan;  ///< index into RunGraph::plans
    std::size_t scan;
    std::size_t variant;  ///< index into Plan::variants
    std::vector<std::size_t> nodes;  ///< in an order that can be run
    std::vector<RunOutput> outputs;
};

struct RunGraph {
    std::vector<std::shared_ptr<const Plan>> plans;
    std::vector<std::string> scan_names;  ///< as given; the workflow's name when scans are not fed one at a time
    std::vector<RunNode> nodes;
    std::vector<RunCell> cells;
    std::uint64_t seed = 0;

    /// nullptr for a leaf.
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

/// A workflow and what it is asked to do.
struct GraphPart {
    std::shared_ptr<const Plan> plan;
    RunRequest request;
};

using HashOfFile = std::function<std::string(const std::filesystem::path&)>;

/// Throws Error, before anything was computed, for a request that does not fit its plan (inputs that are not fed,
/// unknown variants or steps), for two cells that would write one file, and for outputs that would replace an input or
/// leave the output folder. Reads every file once, to hash it, also those that path parameters name: a step's key knows
/// their content and not their names. A scan that cannot be read only marks its node, another file is left to the
/// filter. `hash` gives the hash of a file's bytes: content_hash(), or one that remembers.
/// Pre: all parts have one seed and one output folder.
RunGraph make_graph(const std::vector<GraphPart>& parts, FilterLibrary& library, const HashOfFile& hash = content_hash);
RunGraph make_graph(const Plan& plan, FilterLibrary& library, const RunRequest& request,
                    const HashOfFile& hash = content_hash);

}  // namespace scanmill
