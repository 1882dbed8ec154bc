// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Text on stdout and stderr. Names of files, comments in them and keys of workflows may contain any byte; none of them
/// may clear the screen, change its title or break a line in two.

#include <fmt/format.h>

#include <nlohmann/json_fwd.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace scanmill::runner {

/// The text with control characters other than line ends escaped, as "\x1b".
std::string printable(std::string_view text);
/// The text on one line: line ends are escaped too, as "\n".
std::string printable_line(std::string_view text);

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
    /// With a trailing newline; no blanks at line ends.
    std::string text() const;

private:
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace scanmill::runner
