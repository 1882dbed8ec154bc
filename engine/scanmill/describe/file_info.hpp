// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The output of `scanmill info`: format, kind, counts, columns, size, unit, topology of a file.

#include <nlohmann/json.hpp>
#include <string>

namespace scanmill {

/// An object whose members are in the order of the output. Kinds without positions have fewer. Warnings of reading are
/// the member `warnings`. Throws Error as read_file().
nlohmann::ordered_json file_info(const std::string& file);

}  // namespace scanmill
