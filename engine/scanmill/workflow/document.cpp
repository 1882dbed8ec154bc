// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/workflow/document.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>
#include <algorithm>
#include <fstream>
#include <map>
#include <sstream>
#include <string_view>
#include <unordered_map>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

std::string it_has(std::span<const std::string> names, std::string_view unknown) {
    return (names.empty() ? "it has none" : "it has " + enumerated(names)) + did_you_mean(unknown, names);
}

std::string text(const Diagnostic& diagnostic, const std::string& file) {
    const std::string position = diagnostic.position.line == 0 ? file
                                                               : fmt::format("{}:{}:{}", file, diagnostic.position.line,
                                                                             diagnostic.position.column);
    const bool warning = diagnostic.severity == Diagnostic::Severity::warning;
    return fmt::format("{}: {}{}", position, warning ? "warning: " : "", diagnostic.message);
}

namespace {

constexpr std::size_t most_nodes = 1'000'000;
constexpr std::size_t most_bytes = std::size_t(64) << 20;
/// Aliases can nest trees deeply. The limit keeps recursive functions from overflowing the stack.
constexpr std::size_t most_levels = 500;

struct TooMuch {
    Position position;
    std::string what;
};

/// The size of a tree: the cost to copy it and to walk over it.
struct Extent {
    std::size_t nodes = 0;   ///< number of nodes, including keys
    std::size_t bytes = 0;   ///< total size of the texts
    std::size_t levels = 0;  ///< depth of nesting
};

Position position_of(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }

Extent extent_of(const YamlNode& node) {
    Extent whole{1, node.text.size(), 1};
    const auto add = [&whole](const Extent& part) {
        whole.nodes += part.nodes;
        whole.bytes += part.bytes;
        whole.levels = std::max(whole.levels, part.levels + 1);
    };
    for (const YamlNode& item : node.items) add(extent_of(item));
    for (const YamlEntry& entry : node.entries) {
        add({1, entry.key.size(), 0});
        add(extent_of(entry.value));
    }
    return whole;
}

/// Explains syntax errors that unquoted placeholders and wildcards cause.
std::string quoting_hint(const std::string& message) {
    using namespace YAML::ErrorMsg;
    const auto is_one_of = [&](std::initializer_list<std::string_view> known) {
        return std::ranges::find(known, message) != known.end();
    };
    if (is_one_of({END_OF_MAP_FLOW, END_OF_SEQ_FLOW, FLOW_END}))
        return "; within { } and [ ] a text with braces, brackets or commas needs quotes, as \"{stem}.ply\"";
    if (is_one_of({ALIAS_NOT_FOUND, ANCHOR_NOT_FOUND, CHAR_IN_ALIAS, CHAR_IN_ANCHOR, UNKNOWN_ANCHOR, INVALID_ANCHOR,
                   INVALID_ALIAS, ALIAS_CONTENT, MULTIPLE_ANCHORS, MULTIPLE_ALIASES}))
        return "; a text that begins with * or & needs quotes, as \"*.ply\"";
    return "";
}

/// The column, from 1, of a tab that precedes the first word of a line, or follows the dashes of list items there; 0
/// without one.
int tab_in_indentation(std::string_view text, int line) {
    for (int skipped = 1; skipped < line; ++skipped) {
        const std::size_t end = text.find('\n');
        if (end == std::string_view::npos) return 0;
        text.remove_prefix(end + 1);
    }
    const std::size_t first = text.find_first_not_of(" -");
    return first != std::string_view::npos && text[first] == '\t' ? static_cast<int>(first) + 1 : 0;
}

/// Builds the tree from the parser's events, which deliver keys, values and items one by one.
class TreeBuilder : public YAML::EventHandler {
public:
    explicit TreeBuilder(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

    YamlNode root;
    Position begin;  ///< where the document begins

    void OnDocumentStart(const YAML::Mark& mark) override { begin = position_of(mark); }
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        finish(node_of(YamlNode::Type::null, mark), anchor);
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const auto found = anchors_.find(anchor);
        if (found == anchors_.end()) {
            diagnostics_.error(position_of(mark),
                               "the alias is inside the value that it refers to; write the value instead");
            finish({}, 0);
            return;
        }
        count(found->second.extent, position_of(mark));
        YamlNode copy = found->second.node;
        copy.position = position_of(mark);
        finish(std::move(copy), 0);
    }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        // An unquoted ~, null or empty value is null; in quotes (tag "!") it is text.
        const bool null = tag == "?" && (value.empty() || value == "~" || value == "null");
        finish(node_of(null ? YamlNode::Type::null : YamlNode::Type::scalar, mark, value), anchor);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        stack_.push_back({.node = node_of(YamlNode::Type::sequence, mark), .anchor = anchor});
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        stack_.push_back({.node = node_of(YamlNode::Type::map, mark), .anchor = anchor});
    }
    void OnMapEnd() override { close(); }

private:
    struct Open {
        YamlNode node;
        YAML::anchor_t anchor;
        bool has_key = false;
        std::string key{};
        Position key_position{};
        std::unordered_map<std::string, int> line_of_key{};
    };

    struct Anchored {
        YamlNode node;
        Extent extent;
    };

    /// Adds the size of a tree that will be inserted below the open nodes. Throws TooMuch if a limit is exceeded.
    void count(const Extent& extent, Position position) {
        nodes_ += extent.nodes;
        bytes_ += extent.bytes;
        if (nodes_ > most_nodes)
            throw TooMuch{position, fmt::format("the file expands to more than {} nodes", most_nodes)};
        if (bytes_ > most_bytes)
            throw TooMuch{position, fmt::format("the file expands to more than {} bytes", most_bytes)};
        if (stack_.size() + extent.levels > most_levels)
            throw TooMuch{position, fmt::format("the file expands to more than {} levels", most_levels)};
    }
    static YamlNode node_of(YamlNode::Type type, const YAML::Mark& mark, std::string text = {}) {
        YamlNode node;
        node.type = type;
        node.position = position_of(mark);
        node.text = std::move(text);
        return node;
    }
    void close() {
        Open level = std::move(stack_.back());
        stack_.pop_back();
        finish(std::move(level.node), level.anchor);
    }
    void finish(YamlNode node, YAML::anchor_t anchor) {
        count({1, node.text.size(), 1}, node.position);
        if (anchor != 0) {
            const Extent extent = extent_of(node);
            count(extent, node.position);  // the anchor keeps a copy
            anchors_[anchor] = {node, extent};
        }
        if (stack_.empty()) {
            root = std::move(node);
            return;
        }
        Open& parent = stack_.back();
        if (parent.node.type == YamlNode::Type::sequence)
            parent.node.items.push_back(std::move(node));
        else if (parent.has_key)
            add_entry(parent, std::move(node));
        else
            take_key(parent, node);
    }
    void take_key(Open& map, const YamlNode& key) {
        if (!key.is_scalar()) diagnostics_.error(key.position, "a key must be a plain text; found " + key.described());
        map.key = key.text;
        map.key_position = key.position;
        map.has_key = true;
    }
    void add_entry(Open& map, YamlNode value) {
        map.has_key = false;
        const auto [earlier, is_new] = map.line_of_key.emplace(map.key, map.key_position.line);
        if (!is_new) {
            diagnostics_.error(map.key_position, "the key '{}' is repeated; it is already at line {}", map.key,
                               earlier->second);
            return;
        }
        map.node.entries.push_back({map.key, map.key_position, std::move(value)});
    }

    Diagnostics& diagnostics_;
    std::vector<Open> stack_;
    std::map<YAML::anchor_t, Anchored> anchors_;
    std::size_t nodes_ = 0, bytes_ = 0;
};

}  // namespace

const YamlNode* YamlNode::find(std::string_view key) const {
    const auto found = std::ranges::find(entries, key, &YamlEntry::key);
    return found == entries.end() ? nullptr : &found->value;
}

std::string YamlNode::described() const {
    switch (type) {
        case Type::null: return "nothing";
        case Type::scalar:
            return text.size() <= 60 ? "'" + text + "'" : "a text of " + std::to_string(text.size()) + " bytes";
        case Type::sequence: return "a list";
        case Type::map: return "a map";
    }
    return "";
}

YamlNode parse_yaml(const std::string& text, Diagnostics& diagnostics) {
    if (const std::size_t zero = text.find('\0'); zero != std::string::npos) {
        const auto before = std::string_view(text).substr(0, zero);
        const auto line = 1 + std::ranges::count(before, '\n');
        const auto column = zero - (before.rfind('\n') + 1) + 1;  // npos + 1 is 0
        diagnostics.error({static_cast<int>(line), static_cast<int>(column)},
                          "found a zero byte; expected a text file");
        return {};
    }
    TreeBuilder builder(diagnostics);
    try {
        std::istringstream stream(text);
        YAML::Parser parser(stream);
        parser.HandleNextDocument(builder);
        for (Position last = builder.begin;;) {
            TreeBuilder next(diagnostics);
            if (!parser.HandleNextDocument(next)) break;
            if (next.begin <= last) {  // the parser neither consumes nor refuses a `,` outside a list
                diagnostics.error(next.begin, "invalid YAML: unexpected token");
                break;
            }
            if (!next.root.is_null())
                diagnostics.error(next.root.position, "a second document begins here; expected one document");
            last = next.begin;
        }
    } catch (const YAML::Exception& error) {
        const Position position = position_of(error.mark);
        const std::string hint = quoting_hint(error.msg);
        const int tab = hint.empty() ? tab_in_indentation(text, position.line) : 0;
        if (tab > 0)
            diagnostics.error({position.line, tab}, "invalid YAML: found a tab; YAML indents with spaces");
        else
            diagnostics.error(position, "invalid YAML: " + error.msg + hint);
    } catch (const TooMuch& too_much) {
        diagnostics.error(too_much.position, too_much.what + "; use fewer anchors and aliases");
    }
    return std::move(builder.root);
}

std::string read_workflow_file(const std::filesystem::path& file) {
    constexpr std::size_t largest = 16u << 20;
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw Error("'{}' is a folder; expected a workflow file", file.string());
    std::ifstream stream(file, std::ios::binary);
    if (!stream) throw Error("'{}' cannot be opened; expected a workflow file", file.string());
    std::string text, block(1u << 16, '\0');
    while (stream.read(block.data(), static_cast<std::streamsize>(block.size())), stream.gcount() > 0) {
        text.append(block, 0, static_cast<std::size_t>(stream.gcount()));
        if (text.size() > largest)
            throw Error("'{}' has more than {} bytes, the largest size of a workflow", file.string(), largest);
    }
    return text;
}

}  // namespace scanmill
