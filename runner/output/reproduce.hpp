// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The command that runs one recorded cell again.

#include <string>

#include "scanmill/records/run_records.hpp"

namespace scanmill::runner {

/// "scanmill batch nightly.yaml --scan scans/a.ply --only fine -o reproduced", or the same with `run` and the options
/// of the recorded command that decide results, quoted for a shell. To be run where the recorded command was run.
/// `scan`: the scan's name from the batch's folder.
std::string reproducing_command(const RunDetails& run, const CellRecord& cell, const std::string& scan);

/// The text as one word of a shell. Control characters and bytes that are not UTF-8 are written as in
/// $'a\nb', so that the word is one line.
std::string quoted_word(const std::string& text);

}  // namespace scanmill::runner
