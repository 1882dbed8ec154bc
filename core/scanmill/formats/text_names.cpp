// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/text_names.hpp"

#include <algorithm>
#include <cctype>

namespace scanmill {

namespace {

bool is_quote(char c) { return c == '"' || c == '\''; }
bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// Calls `action` for every character outside quotes with its place; stops when that returns true.
template <class Action>
void outside_quotes(std::string_view line, Action&& action) {
    char open = '\0';
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (open != '\0') {
            if (line[i] == open) open = '\0';
        } else if (is_quote(line[i])) {
            open = line[i];
        } else if (action(i)) {
            return;
        }
    }
}

char separator_of(std::string_view line) {
    for (const char candidate : {';', ',', '|', '\t'}) {
        bool found = false;
        outside_quotes(line, [&](std::size_t i) { return found = line[i] == candidate; });
        if (found) return candidate;
    }
    return ' ';
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && is_blank(text.front())) text.remove_prefix(1);
    while (!text.empty() && is_blank(text.back())) text.remove_suffix(1);
    return text;
}

std::string_view unquoted(std::string_view name) {
    if (name.size() >= 2 && is_quote(name.front()) && name.back() == name.front())
        return trimmed(name.substr(1, name.size() - 2));
    return name;
}

/// Lower case, without what people put between the words of a name.
std::string plain(std::string_view name) {
    std::string text;
    for (const char c : name)
        if (c != '_' && c != '-' && c != '.' && !is_blank(c))
            text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

std::optional<std::size_t> only_place(std::span<const std::string> names, std::string_view wanted) {
    std::optional<std::size_t> place;
    for (std::size_t i = 0; i < names.size(); ++i) {
        if (plain(names[i]) != wanted) continue;
        if (place) return std::nullopt;
        place = i;
    }
    return place;
}

/// The places of all of them, or none.
std::vector<std::size_t> places(std::span<const std::string> names, const std::vector<std::string_view>& wanted) {
    std::vector<std::size_t> found;
    for (const std::string_view name : wanted) {
        const auto place = only_place(names, name);
        if (!place) return {};
        found.push_back(*place);
    }
    return found;
}

}  // namespace

std::vector<std::string> split_names(std::string_view line, std::size_t most) {
    line = trimmed(line);
    const char separator = separator_of(line);
    std::vector<std::string> names;
    const auto add = [&](std::string_view name) {
        name = unquoted(trimmed(name));
        names.push_back(name.empty() ? "c" + std::to_string(names.size() + 1) : std::string(name));
    };
    std::size_t begin = 0;
    outside_quotes(line, [&](std::size_t i) {
        const bool ends = separator == ' ' ? is_blank(line[i]) : line[i] == separator;
        // Several blanks separate like one.
        if (ends && (separator != ' ' || i > begin)) add(line.substr(begin, i - begin));
        if (ends) begin = i + 1;
        return names.size() > most;
    });
    if (names.size() <= most && begin < line.size()) add(line.substr(begin));
    return names;
}

std::optional<std::array<std::size_t, 3>> axes_among(std::span<const std::string> names) {
    const std::vector<std::size_t> found = places(names, {"x", "y", "z"});
    if (found.empty()) return std::nullopt;
    return std::array{found[0], found[1], found[2]};
}

std::optional<std::string> repeated_axis(std::span<const std::string> names) {
    for (std::size_t i = 0; i < names.size(); ++i) {
        const std::string name = plain(names[i]);
        if (name != "x" && name != "y" && name != "z") continue;
        for (const std::string& earlier : names.first(i))
            if (plain(earlier) == name) return names[i];
    }
    return std::nullopt;
}

std::vector<NamedGroup> groups_among(std::span<const std::string> names) {
    using Words = std::vector<std::string_view>;
    std::vector<NamedGroup> groups;
    const auto add_first = [&](NamedGroup::Kind kind, const std::vector<Words>& spellings) {
        for (const Words& words : spellings)
            if (std::vector<std::size_t> found = places(names, words); !found.empty()) {
                groups.push_back({kind, std::move(found)});
                return;
            }
    };
    add_first(NamedGroup::Kind::normal, {{"nx", "ny", "nz"}, {"normalx", "normaly", "normalz"}});
    add_first(NamedGroup::Kind::colour,
              {{"r", "g", "b", "a"}, {"red", "green", "blue", "alpha"}, {"r", "g", "b"}, {"red", "green", "blue"}});
    return groups;
}

}  // namespace scanmill
