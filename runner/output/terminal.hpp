// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Text on stdout and stderr. Names of files, comments in files and keys of workflows may contain any byte. The
/// functions here escape bytes that would clear the screen, change its title or break a line in two.

#include <fmt/format.h>

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <string_view>
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

/// A plain text table. Columns are padded to their widest cell and separated by two blanks; numeric columns are
/// right-aligned. Cells are made printable lines.
class Table {
public:
    explicit Table(std::vector<std::string> headers) : rows_{std::move(headers)} {}
    void add(std::vector<std::string> row);
    /// Lets text() cut the cells of this column in the middle if the table is wider than the terminal. If several
    /// columns may be cut, the one that was named first is cut first.
    void may_cut(const std::string& header);
    /// The text with a trailing newline, without blanks at line ends. `width`: columns of the terminal; empty: no
    /// limit.
    std::string text(std::optional<std::size_t> width = {}) const;

private:
    std::vector<std::vector<std::string>> rows_;
    std::vector<std::size_t> to_cut_;  ///< columns that may be cut
};

}  // namespace scanmill::runner
