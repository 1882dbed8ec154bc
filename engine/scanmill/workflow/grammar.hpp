// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Reads mappings of a YAML tree by tables of allowed keys. An error is reported with its position; reading continues.

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

/// Calls Key::read for every key in `keys` that the mapping has, in the order of `keys`. Reports missing keys. Reports
/// unknown keys with the closest known name. `what` names the mapping in messages: "a step".
void read_mapping(const YamlNode& node, std::string_view what, const std::vector<Key>& keys, Diagnostics& diagnostics);

/// A reader that stores a text in `target`.
ReadEntry text_into(std::string& target, Diagnostics& diagnostics);
/// A reader that stores a name in `target`; see require_name() for `what`.
ReadEntry name_into(std::string& target, std::string what, Diagnostics& diagnostics);
/// A reader that stores the unit of a scan in `target`; LengthUnit::unknown after an error.
ReadEntry unit_into(LengthUnit& target, Diagnostics& diagnostics);
/// A reader that stores the rule for a scan's invalid rows in `target`; InvalidRows::by_format after an error.
ReadEntry invalid_into(InvalidRows& target, Diagnostics& diagnostics);

/// The key `scanmill: 1`, which every workflow and batch file must have.
Key grammar_version_key(Diagnostics& diagnostics);

/// Whether `node` is a mapping. If not, reports what it is and what was `expected`.
bool require_map(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);
/// Whether `node` is a list. If not, reports what it is and what was `expected`.
bool require_list(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);
/// The text of a scalar. Reports any other node and returns nothing.
std::optional<std::string> require_text(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);

/// Whether `name` begins with a letter and consists of letters, digits, `-` and `_`. If not, reports that it is not a
/// valid name for `what`: "a step".
bool require_name(const std::string& name, Position position, std::string_view what, Diagnostics& diagnostics);

// Texts with placeholders in braces, as "{scan}-{variant}.stl".

/// Reports braces that do not enclose one of `placeholders`. `what` begins the message: "the frame".
void check_placeholders(const std::string& text, std::string_view what, std::span<const std::string> placeholders,
                        Position position, Diagnostics& diagnostics);
/// The text with every placeholder replaced by its `value_of`.
std::string with_placeholders(const std::string& text, const std::function<std::string(const std::string&)>& value_of);

/// The frames of a list of scans may contain {stem}, the scan's file name without folder and extension; see stem_of().
void check_stem_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics);
/// The text with {stem} replaced. Other braces stay, because they are part of a file's name.
std::string with_stem(const std::string& text, const std::filesystem::path& file);

/// The paths of poses, truths and inputs of a list of scans may contain {stem} and {folder}; see folder_name().
void check_path_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics);

/// The name of the folder that contains the file; "root" for the root folder.
std::string folder_name(const std::filesystem::path& file);

}  // namespace scanmill
