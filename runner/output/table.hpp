// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A plain text table: columns padded to their widest cell, numbers to the right, two blanks between.

#include <string>
#include <vector>

namespace scanmill::runner {

class Table {
public:
    explicit Table(std::vector<std::string> headers) : rows_{std::move(headers)} {}
    /// Control characters in it become '?'.
    void add(std::vector<std::string> row);
    /// With a trailing newline; no blanks at line ends.
    std::string text() const;

private:
    std::vector<std::vector<std::string>> rows_;
};

}  // namespace scanmill::runner
