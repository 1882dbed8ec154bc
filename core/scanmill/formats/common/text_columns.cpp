// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_columns.hpp"

#include <algorithm>
#include <cctype>
#include <cmath>
#include <map>
#include <set>

#include "scanmill/formats/common/reading.hpp"

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

namespace {

using Components = std::vector<const Array<double>*>;

class TextTable {
public:
    TextTable(std::vector<std::string> names, std::vector<Array<double>> values,
              const std::function<void(std::string)>& on_warning)
        : names_(std::move(names)),
          values_(std::move(values)),
          on_warning_(on_warning) {}

    ColumnTable named() {
        std::map<std::size_t, Column> whole;  // by the place of the first of its components
        std::set<std::size_t> taken;
        for (const NamedGroup& group : groups_among(names_)) {
            std::optional<Column> column = united(group);
            if (!column) continue;
            whole.emplace(*std::ranges::min_element(group.columns), std::move(*column));
            taken.insert(group.columns.begin(), group.columns.end());
        }
        for (std::size_t i = 0; i < names_.size(); ++i) {
            if (const auto found = whole.find(i); found != whole.end())
                table_.add(found->second);
            else if (!taken.contains(i))
                add(i);
        }
        return std::move(table_);
    }

    ColumnTable numbered(bool is_pts) {
        for (std::size_t i = 0; i < values_.size(); ++i) names_.push_back("c" + std::to_string(i + 4));
        if (is_pts && (values_.size() == 1 || values_.size() == 4)) {
            names_[0] = "intensity";
            add(0);
            if (values_.size() == 4) add_colour({1, 2, 3});
            return std::move(table_);
        }
        if (values_.size() == 3) {
            if (are_unit_normals(components({0, 1, 2}))) {
                table_.add(joined("normal", components({0, 1, 2})));
                return std::move(table_);
            }
            if (is_pts) {
                add_colour({0, 1, 2});
                return std::move(table_);
            }
            warn(on_warning_, "columns 4 to 6 are no unit normals; they are kept as c4, c5 and c6");
        }
        for (std::size_t i = 0; i < values_.size(); ++i) add(i);
        return std::move(table_);
    }

private:
    Components components(const std::vector<std::size_t>& columns) const {
        Components found;
        for (const std::size_t column : columns) found.push_back(&values_[column]);
        return found;
    }

    /// A column as it is.
    void add(std::size_t column) { table_.add(Column(names_[column], 1, Buffer(std::move(values_[column])))); }

    void add_colour(const std::vector<std::size_t>& columns) {
        if (const auto colour = as_colour(components(columns))) {
            table_.add(*colour);
            return;
        }
        warn_no_colour(columns);
        for (const std::size_t column : columns) add(column);
    }

    void warn_no_colour(const std::vector<std::size_t>& columns) const {
        warn(on_warning_, "the columns {} are no colours of whole numbers from 0 to 255; they are kept as they are",
             list(columns));
    }

    std::string list(const std::vector<std::size_t>& columns) const {
        std::string text;
        for (const std::size_t column : columns) text.append(text.empty() ? "" : ", ").append(names_[column]);
        return text;
    }

    /// The group as one column; nothing when it is none, or when another column has the name already.
    std::optional<Column> united(const NamedGroup& group) const {
        const bool is_normal = group.kind == NamedGroup::Kind::normal;
        const Components parts = components(group.columns);
        if (std::ranges::find(names_, is_normal ? "normal" : "colour") != names_.end()) return std::nullopt;
        if (!is_normal) {
            std::optional<Column> colour = as_colour(parts);
            if (!colour) warn_no_colour(group.columns);
            return colour;
        }
        if (!are_unit_normals(parts)) warn(on_warning_, "not all normals ({}) have unit length", list(group.columns));
        return joined("normal", parts);
    }

    std::vector<std::string> names_;
    std::vector<Array<double>> values_;
    const std::function<void(std::string)>& on_warning_;
    ColumnTable table_;
};

template <class T>
Column side_by_side(std::string name, std::span<const Array<double>* const> components) {
    const std::size_t width = components.size(), rows = components.front()->size();
    Array<T> values(width * rows);
    for (std::size_t i = 0; i < width; ++i)
        for (std::size_t row = 0; row < rows; ++row) values[row * width + i] = static_cast<T>((*components[i])[row]);
    return Column(std::move(name), static_cast<u32>(width), Buffer(std::move(values)));
}

}  // namespace

ColumnTable text_columns(std::vector<std::string> names, std::vector<Array<double>> values, bool is_pts,
                         const std::function<void(std::string)>& on_warning) {
    const bool headerless = names.empty();
    TextTable table(std::move(names), std::move(values), on_warning);
    return headerless ? table.numbered(is_pts) : table.named();
}

bool are_unit_normals(std::span<const Array<double>* const> components) {
    constexpr double tolerance = 0.1;
    for (std::size_t row = 0; row < components[0]->size(); ++row) {
        const double length = std::hypot((*components[0])[row], (*components[1])[row], (*components[2])[row]);
        if (!(std::abs(length - 1) <= tolerance) && length != 0) return false;
    }
    return true;
}

Column joined(std::string name, std::span<const Array<double>* const> components) {
    return side_by_side<double>(std::move(name), components);
}

std::optional<Column> as_colour(std::span<const Array<double>* const> components) {
    double highest = 0;
    for (const Array<double>* component : components)
        for (const double value : *component) {
            if (!(value >= 0 && value <= 255) || value != std::trunc(value)) return std::nullopt;
            highest = std::max(highest, value);
        }
    if (highest == 1) return std::nullopt;  // the faintest, or of a scale that ends at 1
    return side_by_side<u8>("colour", components);
}

}  // namespace scanmill
