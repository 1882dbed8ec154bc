// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The command that runs one recorded cell again.

#include <string>

#include "scanmill/records/run_records.hpp"

namespace scanmill::runner {

/// "scanmill batch nightly.yaml --scan scans/a.ply --only fine -o reproduced", or the same with `run` and those options
/// of the recorded command that affect results. Words are quoted for a shell. The command must be run in the folder
/// where the recorded command was run. `scan`: path of the scan, relative to the batch's folder.
std::string reproducing_command(const RunDetails& run, const CellRecord& cell, const std::string& scan);

/// The text as one word of a shell. Control characters and bytes that are not UTF-8 are written as in $'a\nb', so the
/// word is one line.
std::string quoted_word(const std::string& text);

}  // namespace scanmill::runner
