// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Reads a YAML tree against a grammar. Every error is reported with its position, and reading goes on.

#include <filesystem>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

using ReadEntry = std::function<void(const YamlEntry&)>;

/// A key that a mapping may have.
struct Key {
    std::string name;
    ReadEntry read;
    std::string when_missing{};  ///< the error when the key is absent; empty: the key is optional
};

/// Calls `read` for every key of the table that the mapping has, in the table's order. Reports missing keys, and
/// unknown ones with the closest name. `what` names the mapping in messages: "a step".
void read_mapping(const YamlNode& node, std::string_view what, const std::vector<Key>& keys, Diagnostics& diagnostics);

/// Readers of plain values: a text, and the name of `what` (see require_name).
ReadEntry text_into(std::string& target, Diagnostics& diagnostics);
ReadEntry name_into(std::string& target, std::string what, Diagnostics& diagnostics);
/// The unit of a scan; after an error `target` is unknown.
ReadEntry unit_into(LengthUnit& target, Diagnostics& diagnostics);
/// The rule for a scan's invalid rows; after an error `target` is by_format.
ReadEntry invalid_into(InvalidRows& target, Diagnostics& diagnostics);

/// The key `scanmill: 1`, which every file has.
Key grammar_version_key(Diagnostics& diagnostics);

/// Whether `node` is a mapping, or a list; otherwise reports the node found and `expected`.
bool require_map(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);
bool require_list(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);
/// The scalar's text; nothing after an error.
std::optional<std::string> require_text(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);

/// Whether `name` is a valid name of an input, parameter, step or variant: letters, digits, `-`, `_`; a letter first.
bool require_name(const std::string& name, Position position, std::string_view what, Diagnostics& diagnostics);

// Texts with placeholders in braces, as "{scan}-{variant}.stl".

/// Reports braces that do not enclose one of `placeholders`. `what` begins the message: "the frame".
void check_placeholders(const std::string& text, std::string_view what, std::span<const std::string> placeholders,
                        Position position, Diagnostics& diagnostics);
/// The text with every placeholder replaced by its `value_of`.
std::string with_placeholders(const std::string& text, const std::function<std::string(const std::string&)>& value_of);

/// The frames of a list of scans may contain {stem}, the scan's file name without folder and extension; see stem_of().
void check_stem_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics);
std::string with_stem(const std::string& text, const std::filesystem::path& file);

/// The paths of poses, truths and inputs of a list of scans may also contain {folder}, see folder_name().
void check_path_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics);
std::string with_stem_and_folder(const std::string& text, const std::filesystem::path& file);

/// The name of the folder that contains the file; "root" for the root folder.
std::string folder_name(const std::filesystem::path& file);

}  // namespace scanmill
