// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Workflow and batch files as text.

#include <filesystem>
#include <string>

namespace scanmill {

/// The file's bytes. Throws Error for a folder, a file that cannot be opened and one of more than 16 MiB, which no
/// workflow has.
std::string read_workflow_file(const std::filesystem::path& file);

}  // namespace scanmill
