// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Checks the output files of a run before it begins: against each other, the inputs and the output folder.

#include <filesystem>
#include <map>
#include <set>
#include <string>

#include "scanmill/plan/output_names.hpp"

namespace scanmill {

class OutputFiles {
public:
    explicit OutputFiles(const std::filesystem::path& folder);

    /// Forbids outputs to replace this file, or to create it if it does not exist. Pre: add() was not called yet.
    void protect(const std::filesystem::path& file);

    /// Adds an output and returns its absolute path. `name` is relative to the output folder, in normal form. `writer`
    /// names the cell in messages, `values` are its placeholders. Throws Error if an output with other content has the
    /// same path, or if one output's path is the folder of another output; the paths of failed_of() count too. Throws
    /// Error if the path is an existing folder, if it, previous_of() or failed_of() it is an input, and if a symbolic
    /// link leads it out of the output folder.
    std::filesystem::path add(const std::string& name, const OutputContent& content, const std::string& writer,
                              const TemplateValues& values = {});

    /// The output folder: absolute, without links.
    const std::filesystem::path& folder() const { return folder_; }

private:
    using Identity = std::pair<std::uintmax_t, std::uintmax_t>;  // device and inode

    static Identity identity(const std::filesystem::path& file);
    void require_free(const std::filesystem::path& file);

    std::filesystem::path folder_;
    OutputNames names_;
    std::set<Identity> inputs_;
    std::set<std::filesystem::path> absent_inputs_;  // absolute, without links
    std::map<std::filesystem::path, std::filesystem::path> real_folders_;  // folders of outputs, without links
};

/// The path `<output>.previous`, to which an output of an earlier run is moved when its cell fails.
std::filesystem::path previous_of(const std::filesystem::path& file);

/// The folder below the output folder that gets the outputs of cells that failed by an expectation.
std::filesystem::path failed_folder(const std::filesystem::path& folder);

/// The path of an output below failed_folder(): `sub/name.ply` becomes `failed/sub/name.ply`. Pre: `file` lies below
/// the output folder `folder`.
std::filesystem::path failed_of(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Removes failed_of() the output and its description, if they exist, and then the folders up to failed_folder() that
/// are empty. Errors are ignored.
void remove_failed(const std::filesystem::path& folder, const std::filesystem::path& file);

/// Moves an output to previous_of() it, and its description beside it. Files already there are replaced. Returns
/// whether the output or its description existed. Throws Error if a file cannot be moved.
bool move_aside(const std::filesystem::path& file);

}  // namespace scanmill
