// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/grammar.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "scanmill/base/text.hpp"

namespace scanmill {

MapReader::MapReader(const YamlNode& node, std::string what, Diagnostics& diagnostics)
    : node_(node),
      what_(std::move(what)),
      diagnostics_(diagnostics) {}

const YamlEntry* MapReader::find(std::string_view key) {
    known_.emplace_back(key);
    const auto found = std::ranges::find(node_.entries, key, &YamlEntry::key);
    return found == node_.entries.end() ? nullptr : &*found;
}

std::string MapReader::text(std::string_view key) {
    const YamlEntry* entry = find(key);
    if (!entry) return {};
    return require_text(entry->value, fmt::format("a text for '{}'", key), diagnostics_).value_or("");
}

void MapReader::complain_of_others() {
    for (const YamlEntry& entry : node_.entries)
        if (std::ranges::find(known_, entry.key) == known_.end())
            diagnostics_.error(entry.position, fmt::format("{} has no key '{}'; it has {}{}", what_, entry.key,
                                                           enumerated(known_), did_you_mean(entry.key, known_)));
}

void require_grammar_version(MapReader& root, Diagnostics& diagnostics) {
    constexpr std::string_view version = "1";
    const YamlEntry* entry = root.find("scanmill");
    if (!entry)
        diagnostics.error({1, 1}, "does not say its grammar; expected `scanmill: 1` as the first line");
    else if (entry->value.text != version)
        diagnostics.error(entry->value.position, fmt::format("the grammar is {}; this program reads grammar {}",
                                                             entry->value.described(), version));
}

bool require_map(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics) {
    if (node.is_map()) return true;
    diagnostics.error(node.position, fmt::format("found {}; expected {}", node.described(), expected));
    return false;
}

bool require_list(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics) {
    if (node.is_sequence()) return true;
    diagnostics.error(node.position, fmt::format("found {}; expected {}", node.described(), expected));
    return false;
}

std::optional<std::string> require_text(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics) {
    if (node.is_scalar()) return node.text;
    diagnostics.error(node.position, fmt::format("found {}; expected {}", node.described(), expected));
    return std::nullopt;
}

LengthUnit require_unit(const YamlNode& node, Diagnostics& diagnostics) {
    const std::optional<LengthUnit> known = length_unit(node.text);
    if (!known)
        diagnostics.error(node.position,
                          fmt::format("{} is no unit; expected one of {}", node.described(), length_unit_symbols()));
    return known.value_or(LengthUnit::unknown);
}

bool require_name(const std::string& name, Position position, std::string_view what, Diagnostics& diagnostics) {
    const auto letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    const auto plain = [&](char c) { return letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_'; };
    if (!name.empty() && letter(name.front()) && std::ranges::all_of(name, plain)) return true;
    diagnostics.error(
        position,
        fmt::format("'{}' is no name for {}; expected letters, digits, '-' and '_', a letter first", name, what));
    return false;
}

namespace {
const std::string placeholder = "{stem}";
}

void check_stem_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics) {
    for (std::size_t at = 0; (at = text.find_first_of("{}", at)) != std::string::npos; at += placeholder.size())
        if (text.compare(at, placeholder.size(), placeholder) != 0) {
            diagnostics.error(position, fmt::format("{} '{}' has a brace that is not part of {}, the only placeholder "
                                                    "that it may hold",
                                                    what, text, placeholder));
            return;
        }
}

void check_frame_template(const std::string& frame, Position position, Diagnostics& diagnostics) {
    check_stem_template(frame, "the frame", position, diagnostics);
}

std::string with_stem(std::string text, const std::filesystem::path& file) {
    const std::string stem = file.stem().string();
    for (std::size_t at = 0; (at = text.find(placeholder, at)) != std::string::npos; at += stem.size())
        text.replace(at, placeholder.size(), stem);
    return text;
}

std::string frame_of_file(std::string frame, const std::filesystem::path& file) {
    return with_stem(std::move(frame), file);
}

}  // namespace scanmill
