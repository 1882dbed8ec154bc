// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The output of `scanmill info`: format, kind, counts, columns, size, unit, topology of a file.

#include <nlohmann/json.hpp>
#include <string>

#include "scanmill/io/memory.hpp"

namespace scanmill {

/// An object whose members are in the order of the output. Kinds without positions have fewer. Warnings of reading are
/// the member `warnings`. A scan that does not fit into `memory` bytes is read piece by piece if it can be streamed,
/// and then has no `spacing`, `encoding` and `comments`. Throws Error as read_file() and require_memory_to_read().
nlohmann::ordered_json file_info(const std::string& file, std::uint64_t memory = available_memory());

}  // namespace scanmill
