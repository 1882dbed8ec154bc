// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A YAML file as a plain tree with the place of every node. The only file of the engine that meets the YAML library.
///
/// Refused beyond what YAML itself refuses: repeated keys, keys that are no plain text, more than one document, and
/// files whose anchors and aliases unfold to more than a million nodes, 64 MiB of text or 500 levels.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/workflow/diagnostics.hpp"

namespace scanmill {

struct YamlEntry;

struct YamlNode {
    enum class Type { null, scalar, sequence, map };

    Type type = Type::null;
    Position position;
    std::string text;                ///< of a scalar
    std::vector<YamlNode> items;     ///< of a sequence
    std::vector<YamlEntry> entries;  ///< of a map, in file order

    bool is_null() const { return type == Type::null; }
    bool is_scalar() const { return type == Type::scalar; }
    bool is_sequence() const { return type == Type::sequence; }
    bool is_map() const { return type == Type::map; }
    /// The value under `key`, or nullptr.
    const YamlNode* find(std::string_view key) const;
    /// "a list", "a map", "the text 'x'", "nothing": for messages.
    std::string described() const;
};

struct YamlEntry {
    std::string key;
    Position position;  ///< of the key
    YamlNode value;
};

/// Parses `text`; what is wrong goes to `diagnostics`, and the tree holds what could be read.
YamlNode parse_yaml(const std::string& text, Diagnostics& diagnostics);

// Workflow and batch files as text.

/// The file's bytes. Throws Error for a folder, a file that cannot be opened and one of more than 16 MiB, which no
/// workflow has.
std::string read_workflow_file(const std::filesystem::path& file);

}  // namespace scanmill
