// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/grammar.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>

#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/format.hpp"

namespace scanmill {

namespace {

void report_unexpected(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics) {
    diagnostics.error(node.position, "found {}; expected {}", node.described(), expected);
}

}  // namespace

void read_mapping(const YamlNode& node, std::string_view what, const std::vector<Key>& keys, Diagnostics& diagnostics) {
    for (const Key& key : keys) {
        const auto entry = std::ranges::find(node.entries, key.name, &YamlEntry::key);
        if (entry != node.entries.end())
            key.read(*entry);
        else if (!key.when_missing.empty())
            diagnostics.error(node.position, key.when_missing);
    }
    for (const YamlEntry& entry : node.entries)
        if (std::ranges::find(keys, entry.key, &Key::name) == keys.end())
            diagnostics.error(entry.position, "{} has no key '{}'; {}", what, entry.key, it_has(keys, entry.key));
}

ReadEntry text_into(std::string& target, Diagnostics& diagnostics) {
    return [&](const YamlEntry& entry) {
        target = require_text(entry.value, fmt::format("a text for '{}'", entry.key), diagnostics).value_or("");
    };
}

ReadEntry name_into(std::string& target, std::string what, Diagnostics& diagnostics) {
    return [&, what](const YamlEntry& entry) {
        text_into(target, diagnostics)(entry);
        if (entry.value.is_scalar()) require_name(target, entry.value.position, what, diagnostics);
    };
}

ReadEntry unit_into(LengthUnit& target, Diagnostics& diagnostics) {
    return [&](const YamlEntry& entry) {
        const std::optional<LengthUnit> unit = length_unit(entry.value.text);
        target = unit.value_or(LengthUnit::unknown);
        if (!unit)
            diagnostics.error(entry.value.position, "{} is not a unit; expected one of {}", entry.value.described(),
                              length_unit_symbols());
    };
}

ReadEntry invalid_into(InvalidRows& target, Diagnostics& diagnostics) {
    return [&](const YamlEntry& entry) {
        const std::optional<InvalidRows> rule = invalid_rows_named(entry.value.text);
        target = rule.value_or(InvalidRows::by_format);
        if (!rule) report_unexpected(entry.value, "drop or refuse", diagnostics);
    };
}

Key grammar_version_key(Diagnostics& diagnostics) {
    const auto read = [&](const YamlEntry& entry) {
        if (entry.value.text != "1")
            diagnostics.error(entry.value.position, "the grammar is {}; this program reads grammar 1",
                              entry.value.described());
    };
    return {"scanmill", read, "has no grammar version; expected `scanmill: 1` as the first line"};
}

bool require_map(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics) {
    if (!node.is_map()) report_unexpected(node, expected, diagnostics);
    return node.is_map();
}

bool require_list(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics) {
    if (!node.is_sequence()) report_unexpected(node, expected, diagnostics);
    return node.is_sequence();
}

std::optional<std::string> require_text(const YamlNode& node, std::string_view expected, Diagnostics& diagnostics) {
    if (node.is_scalar()) return node.text;
    report_unexpected(node, expected, diagnostics);
    return std::nullopt;
}

bool require_name(const std::string& name, Position position, std::string_view what, Diagnostics& diagnostics) {
    const auto is_letter = [](char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z'); };
    const auto is_allowed = [&](char c) { return is_letter(c) || (c >= '0' && c <= '9') || c == '-' || c == '_'; };
    if (!name.empty() && is_letter(name.front()) && std::ranges::all_of(name, is_allowed)) return true;
    diagnostics.error(position, "'{}' is not a name for {}; expected a letter, then letters, digits, '-' or '_'", name,
                      what);
    return false;
}

void check_placeholders(const std::string& text, std::string_view what, std::span<const std::string> placeholders,
                        Position position, Diagnostics& diagnostics) {
    for (std::size_t at = 0; (at = text.find_first_of("{}", at)) != std::string::npos; ++at) {
        const std::size_t end = text.find('}', at);
        if (text[at] == '}' || end == std::string::npos) {
            diagnostics.error(position, "{} '{}' has a {} without its {}", what, text, text[at],
                              text[at] == '}' ? '{' : '}');
            continue;
        }
        const std::string name = text.substr(at + 1, end - at - 1);
        if (std::ranges::find(placeholders, name) == placeholders.end()) {
            std::vector<std::string> in_braces;
            for (const std::string& each : placeholders) in_braces.push_back("{" + each + "}");
            diagnostics.error(position, "{} '{}' has the unknown placeholder {{{}}}; it takes {}{}", what, text, name,
                              enumerated(in_braces), did_you_mean(name, placeholders));
        }
        at = end;
    }
}

std::string with_placeholders(const std::string& text, const std::function<std::string(const std::string&)>& value_of) {
    std::string result;
    std::size_t begin = 0, open, close;
    while ((open = text.find('{', begin)) != std::string::npos && (close = text.find('}', open)) != std::string::npos) {
        result.append(text, begin, open - begin).append(value_of(text.substr(open + 1, close - open - 1)));
        begin = close + 1;
    }
    return result.append(text, begin);
}

void check_stem_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics) {
    const std::string stem = "stem";
    check_placeholders(text, what, {&stem, 1}, position, diagnostics);
}

std::string with_stem(const std::string& text, const std::filesystem::path& file) {
    return with_placeholders(
        text, [&](const std::string& name) { return name == "stem" ? stem_of(file) : "{" + name + "}"; });
}

void check_path_template(const std::string& text, std::string_view what, Position position, Diagnostics& diagnostics) {
    const std::array<std::string, 2> placeholders{"stem", "folder"};
    check_placeholders(text, what, placeholders, position, diagnostics);
}

std::string folder_name(const std::filesystem::path& file) {
    std::error_code gone;
    const std::string name = std::filesystem::absolute(file, gone).lexically_normal().parent_path().filename().string();
    return name.empty() ? "root" : name;
}

}  // namespace scanmill
