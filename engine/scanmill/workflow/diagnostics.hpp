// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Everything that is wrong with a file, found in one go, each with its place.

#include <compare>
#include <set>
#include <string>
#include <vector>

namespace scanmill {

/// Both count from 1; line 0 means the file as a whole.
struct Position {
    int line = 0;
    int column = 0;
    auto operator<=>(const Position&) const = default;
};

struct Diagnostic {
    enum class Severity { error, warning };
    Severity severity;
    Position position;
    std::string message;
    auto operator<=>(const Diagnostic&) const = default;
};

class Diagnostics {
public:
    explicit Diagnostics(std::string file) : file_(std::move(file)) {}

    /// A message that was already given for the same place is not repeated.
    void error(Position position, std::string message);
    void warning(Position position, std::string message);

    bool has_errors() const { return errors_ > 0; }
    std::size_t errors() const { return errors_; }
    /// In the order of the file.
    std::vector<Diagnostic> sorted() const;
    const std::string& file() const { return file_; }

private:
    void add(Diagnostic diagnostic);

    std::string file_;
    std::vector<Diagnostic> items_;
    std::set<Diagnostic> known_;
    std::size_t errors_ = 0;
};

/// "file:line:column: message"; a warning says so.
std::string text(const Diagnostic& diagnostic, const std::string& file);

}  // namespace scanmill
