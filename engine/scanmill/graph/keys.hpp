// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Plan keys identify a node's result before anything runs.
///
/// A key contains filter, version, builds, parameters, unit, seed and the keys of everything upstream. It contains no
/// thread count, path, step name or order of a file's keys.

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scanmill/graph/graph.hpp"

namespace scanmill {

/// What is the same for all nodes of a graph.
struct KeyBase {
    std::string core;     ///< build of the core
    std::string readers;  ///< builds of everything that reads files
    std::uint64_t seed = 0;
};

/// Of this program. Reads the modules of all formats.
KeyBase key_base(std::uint64_t seed);

/// Of a file that is read, with what is declared of it.
std::string key_of_leaf(const LeafSource& leaf, const KeyBase& base);

struct StepKeys {
    std::string code;  ///< RunNode::code
    std::string plan;  ///< RunNode::key
};

/// `module` is the build of the step's filter, `content` gives the content of files that parameters name, `inputs` are
/// the ports with the keys of what feeds them.
StepKeys keys_of_step(const PlannedStep& step, const std::string& module, const KeyBase& base,
                      const std::function<std::string(const std::filesystem::path&)>& content,
                      const std::vector<std::pair<std::string, std::string>>& inputs);

}  // namespace scanmill
