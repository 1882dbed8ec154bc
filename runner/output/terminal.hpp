// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Text on stdout and stderr. Names of files, comments in files and keys of workflows may contain any byte. The
/// functions here escape bytes that would clear the screen, change its title or break a line in two.

#include <fmt/format.h>

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace scanmill::runner {

/// The text with control characters escaped, as "\x1b". Line ends are kept.
std::string printable(std::string_view text);
/// The text on one line: line ends are escaped too, as "\n".
std::string printable_line(std::string_view text);

/// Number of columns that the text takes on a terminal. Wide characters take two columns; an invalid byte takes one.
std::size_t columns_of(const std::string& text);
/// Cuts the beginning of the text so that whole characters in `width` columns remain, with "…" at the cut. The
/// beginning is cut because names differ at their end.
std::string cut_begin(const std::string& text, std::size_t width);
/// The same, but cuts the middle of the text.
std::string cut_middle(const std::string& text, std::size_t width);

/// The width of the terminal to which stdout is connected; empty if stdout is not a terminal.
std::optional<std::size_t> stdout_width();

/// Prints to stderr. Write errors, such as a full disk, are ignored.
template <class... Arguments>
void print_stderr(fmt::format_string<Arguments...> format, Arguments&&... arguments) {
    const std::string text = fmt::format(format, std::forward<Arguments>(arguments)...);
    [[maybe_unused]] const std::size_t ignored = std::fwrite(text.data(), 1, text.size(), stderr);
}
/// "warning: …" on one line of stderr.
void print_warning(std::string_view text);

/// Prints indented JSON on stdout. Replaces invalid UTF-8, which names of files may contain.
void print_json(const nlohmann::ordered_json& json);
/// The same for the members of a document, after the version of the language.
void print_document(const nlohmann::ordered_json& members);

/// The text as stdout and stderr of this process can show it: where the locale names a character set other than UTF-8,
/// "…", "²" and "³" become "~", "2" and "3".
std::string for_locale(std::string text);

/// Breaks lines at blanks so that none is longer than `width` columns, unless a single word is; further lines are
/// indented by two blanks.
std::string wrapped(const std::string& text, std::size_t width);
/// A message as stderr shows it: wrapped to the width of the terminal, if stderr is one, and for_locale().
std::string for_stderr(std::string text);

struct FittedTable {
    std::string text;
    std::size_t left_out = 0;  ///< columns
};

/// A plain text table. Columns are padded to their widest cell and separated by two blanks; numeric columns are
/// right-aligned. Cells are made printable lines.
class Table {
public:
    explicit Table(std::vector<std::string> headers) : rows_{std::move(headers)} {}
    void add(std::vector<std::string> row);
    /// Lets text() cut the cells of this column in the middle if the table is wider than the terminal. If several
    /// columns may be cut, the one that was named first is cut first, to 12 columns of the terminal at least. Before
    /// columns are left out, it is cut to `comfortable` at least.
    void may_cut(const std::string& header, std::size_t comfortable = 24);
    /// Lets fitted() leave out this column if the table is wider than the terminal and its columns that may be cut are
    /// at their comfortable widths. The one that was named first is left out first.
    void may_leave_out(const std::string& header);
    /// The text with a trailing newline, without blanks at line ends. `width`: columns of the terminal; empty: no
    /// limit.
    FittedTable fitted(std::optional<std::size_t> width) const;
    std::string text(std::optional<std::size_t> width = {}) const { return fitted(width).text; }

private:
    std::size_t column_of(const std::string& header) const;

    std::vector<std::vector<std::string>> rows_;
    std::vector<std::pair<std::size_t, std::size_t>> to_cut_;  ///< columns that may be cut, and comfortable widths
    std::vector<std::size_t> to_leave_out_;  ///< columns that may be left out
};

}  // namespace scanmill::runner
