// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The states of the chunks of an exported batch.

#include <filesystem>

namespace scanmill::runner {

/// Prints the states of the chunks in the folder of an export, and the command that runs the failed ones again. Returns
/// some_failed if one failed.
int print_status(const std::filesystem::path& folder, bool json);

}  // namespace scanmill::runner
