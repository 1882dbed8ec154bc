// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The output of `scanmill info`: format, kind, counts, columns, size, unit and topology of a file.

#include <nlohmann/json.hpp>
#include <string>

#include "scanmill/io/memory.hpp"

namespace scanmill {

/// A JSON object with its members in the order of the output. Kinds without positions have fewer members. The member
/// `warnings` contains warnings about reading the file. A scan that does not fit into `memory` bytes is read in chunks
/// if it can be streamed; the object then lacks `spacing`, `format`, `encoding` and `comments`. Throws Error as
/// read_file() and require_memory_to_read() do.
nlohmann::ordered_json file_info(const std::string& file, std::uint64_t memory = available_memory());

}  // namespace scanmill
