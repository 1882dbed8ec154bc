// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Ready workflows and batches, which are installed with the program and found by name.

#include <filesystem>
#include <string>
#include <vector>

#include "scanmill/kinds/kind.hpp"

namespace scanmill {

/// The folders that may hold `name` of what is installed in share/scanmill, such as "workflows".
std::vector<std::filesystem::path> shared_places(const std::string& name);

/// The names of the ready workflows and batches that are installed with the program, sorted.
std::vector<std::string> ready_names();

/// Resolves the file or the name of a workflow or a batch. A relative path counts from `folder`; an empty `folder` is
/// the current one. An existing file is used as it is. Otherwise `file_or_name` may be the name of a ready workflow or
/// batch, whose path is returned; a folder does not hide it. Warns if it could mean both a file and a ready one. Throws
/// Error with a suggestion if there is neither. A path that contains `/` or is a folder is returned unchecked.
std::string workflow_file(const std::string& file_or_name, const OnWarning& warn,
                          const std::filesystem::path& folder = {});

}  // namespace scanmill
