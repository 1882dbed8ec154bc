// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/common/text_columns.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <functional>
#include <ranges>

namespace scanmill {

namespace {

constexpr std::size_t most_columns = 1000;

using Indices = std::vector<std::size_t>;

bool is_blank(char c) { return c == ' ' || c == '\t' || c == '\v' || c == '\f'; }

/// The names in a line, in order.
std::vector<std::string> split_names(std::string_view line) {
    line = trimmed(line);
    char separator = ' ';
    for (const char candidate : {'\t', '|', ',', ';'})
        if (line.find(candidate) != line.npos) separator = candidate;
    std::vector<std::string> names;
    while (!line.empty()) {
        const std::size_t end = std::min(line.find(separator), line.size());
        std::string_view name = trimmed(line.substr(0, end));
        if (name.size() >= 2 && (name.front() == '"' || name.front() == '\'') && name.back() == name.front())
            name = trimmed(name.substr(1, name.size() - 2));
        // Several blanks separate like a single blank.
        if (separator != ' ' || end > 0)
            names.push_back(name.empty() ? "c" + std::to_string(names.size() + 1) : std::string(name));
        line.remove_prefix(std::min(end + 1, line.size()));
    }
    return names;
}

/// The name in lower case, without separators between its words.
std::string plain(std::string_view name) {
    std::string text;
    for (const char c : name)
        if (c != '_' && c != '-' && c != '.' && !is_blank(c))
            text += static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// The indices of the names for which is_name(name, wanted) holds, in the order of `wanted`; empty unless each of them
/// occurs exactly once.
Indices indices_of(std::span<const std::string> names, std::initializer_list<std::string_view> wanted, auto is_name) {
    Indices indices;
    for (const std::string_view name : wanted) {
        const auto has_name = [&](const std::string& candidate) { return is_name(candidate, name); };
        if (std::ranges::count_if(names, has_name) != 1) return {};
        indices.push_back(static_cast<std::size_t>(std::ranges::find_if(names, has_name) - names.begin()));
    }
    return indices;
}
/// The same for plain names.
Indices indices_of(std::span<const std::string> names, std::initializer_list<std::string_view> wanted) {
    return indices_of(names, wanted, [](const auto& candidate, auto name) { return plain(candidate) == name; });
}

std::vector<std::string_view> tokens_of_row(TextCursor row) {
    std::vector<std::string_view> tokens;
    while (row.more() && tokens.size() <= most_columns) tokens.push_back(row.token());
    return tokens;
}

bool is_number(std::string_view token) {
    double ignored = 0;
    return number_of_token(token, ignored);
}

class LayoutReader {
public:
    explicit LayoutReader(TextCursor& text) : text_(text) {}

    TextLayout read() {
        if (!text_.next_row()) throw Error("holds no points: only blanks and comments");
        const bool counted = read_count();
        if (read_names() && !counted) read_count();
        if (!text_.has_decimal_commas()) require_no_decimal_commas(text_.rest(), text_.line());
        layout_.width = tokens_of_row(text_).size();
        if (layout_.width > most_columns) throw Error("line {}: more than {} columns", text_.line(), most_columns);
        const std::string columns = count_text(layout_.width, "column", "columns");
        if (layout_.width < 3)
            throw Error("line {}: found {}; a point has at least the three numbers x, y and z", text_.line(), columns);
        if (layout_.names.empty()) {
            read_names_in_comments();
        } else if (layout_.names.size() != layout_.width) {
            Error error("line {}: {} for {} names", text_.line(), columns, layout_.names.size());
            // Decimal commas in a row with commas look like twice as many numbers.
            if (layout_.width == 2 * layout_.names.size())
                error.set_hint(
                    "if the commas are decimal commas, separate the numbers with semicolons or write points");
            throw error;
        }
        return std::move(layout_);
    }

private:
    bool read_count() {
        TextCursor row = text_;
        u64 count = 0;
        if (!row.number(count) || row.more()) return false;
        layout_.declared_points = count;
        layout_.declared_in_line = text_.line();
        if (!text_.next_row()) throw Error("holds no points: its last line is a count");
        return true;
    }

    bool read_names() {
        const std::vector<std::string_view> tokens = tokens_of_row(text_);
        std::vector<std::string> names = split_names({tokens.front().begin(), tokens.back().end()});
        const Indices axes = indices_of(names, {"x", "y", "z"});
        if (axes.empty()) {
            double ignored = 0;
            const auto is_decimal = [&](std::string_view token) { return number_with_decimal_comma(token, ignored); };
            if (std::ranges::any_of(tokens, is_number)) return false;
            if (text_.has_decimal_commas() && std::ranges::any_of(tokens, is_decimal)) return false;
            throw Error("line {}: {} is neither a row of numbers nor a row of names with x, y and z once each",
                        text_.line(), quote(tokens.front()))
                .hint(
                    "if it is a title, remove the line or begin it with #; if it has names, call three of them x, y "
                    "and z");
        }
        std::ranges::copy(axes, layout_.axes.begin());
        layout_.names = std::move(names);
        if (!text_.next_row()) throw Error("holds no points: its only line has the names of columns");
        return true;
    }

    /// Most programs treat "//X Y Z Intensity" and "# x y z nx ny nz" as comments, some as names.
    void read_names_in_comments() {
        for (const std::string& comment : std::views::reverse(text_.comments().texts())) {
            std::vector<std::string> names = split_names(comment);
            const Indices axes = indices_of(names, {"x", "y", "z"});
            if (axes.empty()) continue;
            if (names.size() == layout_.width && axes == Indices{0, 1, 2}) {
                layout_.ignored_names.clear();
                layout_.names = std::move(names);
                return;
            }
            layout_.ignored_names = comment;
        }
    }

    TextCursor& text_;
    TextLayout layout_;
};

/// Columns of one number each. Several columns can be united into one column with several components.
class TextTable {
public:
    TextTable(std::vector<std::string> names, std::vector<Array<double>> values,
              const std::function<void(std::string)>& on_warning)
        : names_(std::move(names)),
          on_warning_(on_warning) {
        for (std::size_t i = 0; i < names_.size(); ++i)
            columns_.emplace_back(Column(names_[i], 1, Buffer(std::move(values[i]))));
    }

    bool has_unit_normals() const { return are_unit_normals(values(0), values(1), values(2)); }

    void unite_normal(const Indices& parts) {
        if (parts.empty() || has_column("normal")) return;
        if (!are_unit_normals(values(parts[0]), values(parts[1]), values(parts[2])))
            warn(on_warning_, "not all normals ({}) have unit length", list(parts));
        unite<double>("normal", parts);
    }

    void unite_approach(const Indices& parts) {
        if (parts.empty() || has_column("approach")) return;
        if (!are_unit_normals(values(parts[0]), values(parts[1]), values(parts[2])))
            warn(on_warning_, "not all directions ({}) have unit length", list(parts));
        unite<double>("approach", parts);
    }

    void unite_colour(const Indices& parts) {
        if (parts.empty() || has_column("colour")) return;
        const auto is_byte = [](double value) { return value >= 0 && value <= 255 && value == std::trunc(value); };
        double highest = 0;
        bool are_bytes = true;
        for (const std::size_t part : parts) {
            are_bytes = are_bytes && std::ranges::all_of(values(part), is_byte);
            for (const double value : values(part)) highest = std::max(highest, value);
        }
        // If the highest number is 1, it may be the byte 1 or a full channel.
        if (are_bytes && highest != 1) return unite<u8>("colour", parts);
        warn(on_warning_, "the columns {} are not colours of whole numbers from 0 to 255; they are kept as they are",
             list(parts));
    }

    ColumnTable finished() {
        ColumnTable table;
        for (std::optional<Column>& column : columns_)
            if (column) table.add(std::move(*column));
        return table;
    }

private:
    bool has_column(std::string_view name) const { return std::ranges::find(names_, name) != names_.end(); }
    std::span<const double> values(std::size_t column) const { return columns_[column]->values<double>(); }

    std::string list(const Indices& parts) const {
        const auto name = [&](std::size_t part) { return names_[part]; };
        return fmt::format("{}", fmt::join(parts | std::views::transform(name), ", "));
    }

    /// Replaces the first of the columns `parts` with a column of all parts, and removes the other parts.
    template <class T>
    void unite(const char* name, const Indices& parts) {
        const std::size_t width = parts.size(), rows = columns_[parts[0]]->rows();
        Array<T> united(width * rows);
        for (std::size_t i = 0; i < width; ++i)
            for (std::size_t row = 0; row < rows; ++row)
                united[row * width + i] = static_cast<T>(values(parts[i])[row]);
        for (const std::size_t part : parts) columns_[part].reset();
        columns_[std::ranges::min(parts)] = Column(name, static_cast<u32>(width), Buffer(std::move(united)));
    }

    std::vector<std::string> names_;
    const std::function<void(std::string)>& on_warning_;
    std::vector<std::optional<Column>> columns_;
};

}  // namespace

void require_no_decimal_commas(std::string_view rest, std::size_t line) {
    const std::string_view row = rest.substr(0, rest.find_first_of("\r\n"));
    if (row.find(',') == std::string_view::npos) return;
    TextCursor text(row, decimal_comma_rules);
    std::size_t numbers = 0;
    for (double ignored = 0; text.more(); ++numbers)
        if (!text.number(ignored)) return;
    if (numbers >= 3 && !text.mixes_separators() && !text.has_empty_field()) throw DecimalCommas{line};
}

TextLayout read_text_layout(TextCursor& text) { return LayoutReader(text).read(); }

bool is_row_of_numbers(TextCursor row) { return std::ranges::all_of(tokens_of_row(std::move(row)), is_number); }

ColumnTable text_columns(std::vector<std::string> names, std::vector<Array<double>> values, bool is_pts,
                         const std::function<void(std::string)>& on_warning) {
    using Spellings = std::initializer_list<std::initializer_list<std::string_view>>;
    const auto first_of = [&names](Spellings spellings) {
        Indices indices;
        for (auto words = spellings.begin(); words != spellings.end() && indices.empty(); ++words)
            indices = indices_of(names, *words);
        return indices;
    };
    const Indices named_normal = first_of({{"nx", "ny", "nz"}, {"normalx", "normaly", "normalz"}});
    const Indices named_colour =
        first_of({{"r", "g", "b", "a"}, {"red", "green", "blue", "alpha"}, {"r", "g", "b"}, {"red", "green", "blue"}});
    const Indices named_approach = indices_of(names, {"i", "j", "k"}, std::equal_to<>());
    const std::size_t width = values.size();
    const bool is_named = !names.empty();
    for (std::size_t i = names.size(); i < width; ++i) names.push_back("c" + std::to_string(i + 4));
    if (!is_named && is_pts && (width == 1 || width == 4)) names[0] = "intensity";

    TextTable table(std::move(names), std::move(values), on_warning);
    if (is_named) {
        table.unite_normal(named_normal);
        table.unite_approach(named_approach);
        table.unite_colour(named_colour);
    } else if (width == 3 && table.has_unit_normals()) {
        table.unite_normal({0, 1, 2});
    } else if (is_pts && (width == 3 || width == 4)) {
        table.unite_colour(width == 3 ? Indices{0, 1, 2} : Indices{1, 2, 3});
    } else if (width == 3) {
        warn(on_warning, "columns 4 to 6 are not unit normals; they are kept as c4, c5 and c6");
    }
    return table.finished();
}

bool are_unit_normals(std::span<const double> x, std::span<const double> y, std::span<const double> z) {
    constexpr double tolerance = 0.1;
    std::size_t unknown = 0;
    for (std::size_t row = 0; row < x.size(); ++row) {
        const double length = std::sqrt(x[row] * x[row] + y[row] * y[row] + z[row] * z[row]);
        if (std::isnan(length))
            ++unknown;
        else if (std::abs(length - 1) > tolerance && length != 0)
            return false;
    }
    return unknown == 0 || unknown < x.size();
}

}  // namespace scanmill
