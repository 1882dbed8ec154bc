// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A plan laid out over actual scans: the graph of everything that one run computes.
///
/// Nodes are files to read (leaves) and steps to run, identified by their plan key: what two cells have in common, down
/// to two files of equal content, is one node. A cell is one scan under one variant. The graph says what will be
/// written where before anything runs; an executor, or an export to another scheduler, only has to follow it.

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "scanmill/engine/request.hpp"
#include "scanmill/filter/module.hpp"

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

struct RunNode {
    std::string key;  ///< plan key: what identifies the result before anything runs
    std::string code;  ///< of a step: hash of filter, builds, seed and the content of files that parameters name
    std::optional<std::size_t> step;  ///< index into Plan::steps; nothing: a leaf
    std::filesystem::path file;  ///< of a leaf
    std::size_t input = 0;  ///< of a leaf: index into Workflow::inputs
    std::string content;  ///< of a leaf: hash of the file's bytes
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
    std::size_t scan;
    std::size_t variant;  ///< index into Plan::variants
    std::vector<std::size_t> nodes;  ///< in an order that can be run
    std::vector<RunOutput> outputs;
};

struct RunGraph {
    std::vector<std::string> scan_names;  ///< as given; the workflow's name when scans are not fed one at a time
    std::vector<RunNode> nodes;
    std::vector<RunCell> cells;
};

/// Throws Error, before anything was computed, for a request that does not fit the plan (inputs that are not fed,
/// unknown variants or steps), for two cells that would write one file, and for outputs that would replace an input or
/// leave the output folder. Reads every file once, to hash it, also those that path
/// parameters name: a step's key knows their content and not their names. A scan that cannot be read only marks its
/// node, another file is left to the filter.
/// `hash` gives the hash of a file's bytes: content_hash(), or one that remembers.
RunGraph make_graph(const Plan& plan, FilterLibrary& library, const RunRequest& request,
                    const std::function<std::string(const std::filesystem::path&)>& hash = content_hash);

}  // namespace scanmill
