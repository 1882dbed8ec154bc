// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What `scanmill info` prints of a file: format, kind, counts, columns, size, unit, topology.

#include <nlohmann/json.hpp>
#include <string>

namespace scanmill {

/// An object with the members in the order in which they are shown; of a kind without positions those that apply.
/// Warnings of reading are its member `warnings`. Throws Error as read_file().
nlohmann::ordered_json file_info(const std::string& file);

}  // namespace scanmill
