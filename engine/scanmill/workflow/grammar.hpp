// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Helpers for reading a YAML tree against a grammar: known keys, texts, lists, all errors collected with their place.

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "scanmill/data/frame.hpp"
#include "scanmill/workflow/diagnostics.hpp"
#include "scanmill/workflow/document.hpp"

namespace scanmill {

/// A map whose keys are looked up by name; complain_of_others() reports what nobody asked for.
class MapReader {
public:
    /// `what` names the map in messages: "a step", "the workflow".
    MapReader(const YamlNode& node, std::string what, Diagnostics& diagnostics);

    /// The entry under `key`, or nullptr. Asking makes the key a known one.
    const YamlEntry* find(std::string_view key);
    /// The text under `key`; empty (after an error, if it is there but no text).
    std::string text(std::string_view key);
    /// Reports every key that was not asked for, with the closest known one.
    void complain_of_others();

private:
    const YamlNode& node_;
    std::string what_;
    Diagnostics& diagnostics_;
    std::vector<std::string> known_;
};

/// Reports anything but `scanmill: 1`.
void require_grammar_version(MapReader& root, Diagnostics& diagnostics);

/// `node` must be of this type; otherwise reports what was found and `expected`.
bool require_map(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);
bool require_list(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);
/// The scalar's text; nothing after reporting when it is none.
std::optional<std::string> require_text(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics);

/// The unit that a scan is in; unknown after reporting when it is none.
LengthUnit require_unit(const YamlNode& node, Diagnostics& diagnostics);

/// Names of inputs, parameters, steps and variants: letters, digits, `-`, `_`; begins with a letter.
bool require_name(const std::string& name, Position position, std::string_view what, Diagnostics& diagnostics);

// The name that a workflow gives to the frame of what it reads: a fixed text, or one that holds {stem}, the file's
// name without folder and extension. So every scan of a list can have a frame of its own, by which its pose is found.

/// Reports braces that are not `{stem}`. `what` begins the message: "the frame".
void check_stem_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics);
void check_frame_template(const std::string& frame, Position position, Diagnostics& diagnostics);

/// The text with the file's stem for every {stem}.
std::string with_stem(std::string text, const std::filesystem::path& file);
std::string frame_of_file(std::string frame, const std::filesystem::path& file);

}  // namespace scanmill
