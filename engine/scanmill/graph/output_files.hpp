// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The output files of a run, checked before it begins against each other, the inputs and the output folder.

#include <filesystem>
#include <set>
#include <string>

#include "scanmill/plan/output_names.hpp"

namespace scanmill {

class OutputFiles {
public:
    explicit OutputFiles(const std::filesystem::path& folder);

    /// No output may replace this file, nor create it if it does not exist yet. Pre: nothing was added yet.
    void protect(const std::filesystem::path& file);

    /// The absolute path of `name` (relative to the output folder, in normal form). `writer` names the cell in
    /// messages. Throws Error when another content has the same path, when one output's path is another's folder, when
    /// the file, or previous_of() it, is an input, and when a link leads it out of the output folder.
    std::filesystem::path add(const std::string& name, const OutputContent& content, const std::string& writer);

private:
    using Identity = std::pair<std::uintmax_t, std::uintmax_t>;  // device and inode

    static Identity identity(const std::filesystem::path& file);

    std::filesystem::path folder_;
    OutputNames names_;
    std::set<Identity> inputs_;
    std::set<std::filesystem::path> absent_inputs_;  // absolute, without links
};

/// Where an output of an earlier run is moved when its cell fails: `<output>.previous`.
std::filesystem::path previous_of(const std::filesystem::path& file);

/// Moves an output and its description to previous_of() and its description, and replaces what is there. Returns
/// whether there was such a file. Throws Error if it cannot be moved.
bool move_aside(const std::filesystem::path& file);

}  // namespace scanmill
