// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parses a YAML file into a plain tree with the position of every node, and collects the file's errors and warnings.
/// Only document.cpp includes the YAML library.
///
/// The parser refuses invalid YAML, repeated keys, keys that are not plain text, and more than one document. It also
/// refuses files that expand to more than a million nodes, 64 MiB of text or 500 levels through anchors and aliases.

#include <fmt/format.h>

#include <compare>
#include <filesystem>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace scanmill {

/// Lines and columns count from 1; line 0 means the file as a whole.
struct Position {
    int line = 0;
    int column = 0;
    auto operator<=>(const Position&) const = default;
};

struct Diagnostic {
    enum class Severity { error, warning };
    Position position;
    Severity severity;
    std::string message;
    auto operator<=>(const Diagnostic&) const = default;
};

/// The errors and warnings about a file, sorted by position. A repeated message at the same position is dropped.
class Diagnostics {
public:
    explicit Diagnostics(std::string file) : file_(std::move(file)) {}

    void error(Position position, std::string message) {
        errors_ += add(position, Diagnostic::Severity::error, message);
    }
    void warning(Position position, std::string message) { add(position, Diagnostic::Severity::warning, message); }
    /// Formats `message` with `arguments` and reports it as an error.
    template <class... Arguments>
        requires(sizeof...(Arguments) > 0)
    void error(Position position, fmt::format_string<Arguments...> message, Arguments&&... arguments) {
        error(position, fmt::format(message, std::forward<Arguments>(arguments)...));
    }

    bool has_errors() const { return errors_ > 0; }
    std::size_t errors() const { return errors_; }
    std::vector<Diagnostic> sorted() const { return {all_.begin(), all_.end()}; }
    const std::string& file() const { return file_; }

private:
    bool add(Position position, Diagnostic::Severity severity, std::string& message) {
        return all_.insert({position, severity, std::move(message)}).second;
    }

    std::string file_;
    std::set<Diagnostic> all_;
    std::size_t errors_ = 0;
};

/// The end of a message about an unknown name: "it has a, b and c; did you mean 'a'?", or "it has none".
std::string it_has(std::span<const std::string> names, std::string_view unknown);
/// Lists the names of `items` in the same form.
template <class Items>
    requires requires(const Items& items) { items.begin()->name; }
std::string it_has(const Items& items, std::string_view unknown) {
    std::vector<std::string> names;
    for (const auto& item : items) names.push_back(item.name);
    return it_has(std::span<const std::string>(names), unknown);
}

/// "file:line:column: message", or "file:line:column: warning: message".
std::string text(const Diagnostic& diagnostic, const std::string& file);

struct YamlEntry;

struct YamlNode {
    enum class Type { null, scalar, sequence, map };

    Type type = Type::null;
    Position position;
    std::string text;                ///< only for a scalar
    std::vector<YamlNode> items;     ///< only for a sequence
    std::vector<YamlEntry> entries;  ///< only for a map, in file order

    bool is_null() const { return type == Type::null; }
    bool is_scalar() const { return type == Type::scalar; }
    bool is_sequence() const { return type == Type::sequence; }
    bool is_map() const { return type == Type::map; }
    /// The value under `key`, or nullptr.
    const YamlNode* find(std::string_view key) const;
    /// "a list", "a map", "'x'", "nothing": for messages.
    std::string described() const;
};

struct YamlEntry {
    std::string key;
    Position position;  ///< position of the key
    YamlNode value;
};

/// Parses `text`. Errors go to `diagnostics`; the tree holds everything that could be read.
YamlNode parse_yaml(const std::string& text, Diagnostics& diagnostics);

/// Returns the bytes of a workflow or batch file. Throws Error for a folder, a file that cannot be opened and a file of
/// more than 16 MiB.
std::string read_workflow_file(const std::filesystem::path& file);

}  // namespace scanmill
