// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/diagnostics.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace scanmill {

void Diagnostics::error(Position position, std::string message) {
    add({Diagnostic::Severity::error, position, std::move(message)});
}

void Diagnostics::warning(Position position, std::string message) {
    add({Diagnostic::Severity::warning, position, std::move(message)});
}

void Diagnostics::add(Diagnostic diagnostic) {
    if (!known_.insert(diagnostic).second) return;
    if (diagnostic.severity == Diagnostic::Severity::error) ++errors_;
    items_.push_back(std::move(diagnostic));
}

std::vector<Diagnostic> Diagnostics::sorted() const {
    std::vector<Diagnostic> result = items_;
    std::ranges::stable_sort(result, {}, &Diagnostic::position);
    return result;
}

std::string text(const Diagnostic& diagnostic, const std::string& file) {
    const std::string place = diagnostic.position.line == 0
                                  ? file
                                  : fmt::format("{}:{}:{}", file, diagnostic.position.line, diagnostic.position.column);
    const bool warning = diagnostic.severity == Diagnostic::Severity::warning;
    return fmt::format("{}: {}{}", place, warning ? "warning: " : "", diagnostic.message);
}

}  // namespace scanmill
