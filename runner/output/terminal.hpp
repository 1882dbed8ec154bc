// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Text on stdout and stderr. Names of files, comments in them and keys of workflows may contain any byte; none of them
/// may clear the screen, change its title or break a line in two.

#include <fmt/format.h>

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace scanmill::runner {

/// The text with control characters other than line ends escaped, as "\x1b".
std::string printable(std::string_view text);
/// The text on one line: line ends are escaped too, as "\n".
std::string printable_line(std::string_view text);

/// The columns that the text takes on a terminal. Wide characters of UTF-8 take two; an invalid byte takes one.
std::size_t columns_of(const std::string& text);
/// Cuts to `width` columns of whole characters; "…" marks the cut. The beginning is cut off, because
/// names differ at their end.
std::string cut_begin(const std::string& text, std::size_t width);
/// The same, cut in the middle.
std::string cut_middle(const std::string& text, std::size_t width);

/// The width of the terminal that stdout is; nothing: it is not a terminal.
std::optional<std::size_t> stdout_width();

/// Write errors on stderr, such as a full disk, are ignored.
template <class... Arguments>
void print_stderr(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
    [[maybe_unused]] const std::size_t ignored = std::fwrite(text.data(), 1, text.size(), stderr);
}
/// "warning: …" on one line of stderr.
void print_warning(std::string_view text);

/// Indented JSON on stdout. Invalid UTF-8, which names of files may contain, is replaced.
void print_json(const nlohmann::ordered_json& json);

/// A plain text table: columns padded to their widest cell, numbers to the right, two blanks between. Cells are
/// printable lines.
class Table {
public:
    explicit Table(std::vector<std::string> headers) : rows_{std::move(headers)} {}
    void add(std::vector<std::string> row);
    /// The cells of this column are cut in the middle if the table is wider than the terminal. With several such
    /// columns, the first named is cut first.
    void may_cut(const std::string& header);
    /// The text with a trailing newline; no blanks at line ends. `width`: the terminal's; empty: any.
    std::string text(std::optional<std::size_t> width = {}) const;

private:
    std::vector<std::vector<std::string>> rows_;
    std::vector<std::size_t> to_cut_;  // columns
};

}  // namespace scanmill::runner
