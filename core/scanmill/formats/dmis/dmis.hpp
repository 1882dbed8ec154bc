// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// DMIS: the reader of results and the writer of programs. built_in.hpp describes the format.

#include "scanmill/formats/common/format.hpp"

namespace scanmill::dmis {

/// Writes a probe plan as a program.
void write_program(const Value& value, OutputBuffer& out, const WriteOptions& options);

/// Whether the text begins with DMISMN or FILNAM, after blank lines and comments.
Recognition recognise(std::string_view head, u64 file_size);

/// Reads the measured points of a machine's output.
LoadedFile read_results(const FileBytes& file, const ReadOptions& options);

}  // namespace scanmill::dmis
