// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/document.hpp"

#include <fmt/format.h>
#include <yaml-cpp/eventhandler.h>
#include <yaml-cpp/exceptions.h>
#include <yaml-cpp/parser.h>

#include <algorithm>
#include <map>
#include <sstream>
#include <unordered_map>

namespace scanmill {

namespace {

constexpr std::size_t most_nodes = 1'000'000;

struct TooManyNodes {
    Position position;
};

Position position_of(const YAML::Mark& mark) { return {mark.line + 1, mark.column + 1}; }

std::size_t count_nodes(const YamlNode& node) {
    std::size_t count = 1;
    for (const YamlNode& item : node.items) count += count_nodes(item);
    for (const YamlEntry& entry : node.entries) count += 1 + count_nodes(entry.value);
    return count;
}

/// Builds the tree from the parser's events: keys, values and items arrive one after the other.
class TreeBuilder : public YAML::EventHandler {
public:
    explicit TreeBuilder(Diagnostics& diagnostics) : diagnostics_(diagnostics) {}

    YamlNode root;

    void OnDocumentStart(const YAML::Mark&) override {}
    void OnDocumentEnd() override {}
    void OnNull(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        finish({.type = YamlNode::Type::null, .position = position_of(mark), .text = "", .items = {}, .entries = {}},
               anchor);
    }
    void OnAlias(const YAML::Mark& mark, YAML::anchor_t anchor) override {
        const auto found = anchors_.find(anchor);
        if (found == anchors_.end()) {
            diagnostics_.error(position_of(mark), "an alias inside the node that it names; write the value out");
            finish({}, 0);
            return;
        }
        YamlNode copy = found->second;
        copy.position = position_of(mark);
        count(count_nodes(copy), copy.position);
        finish(std::move(copy), 0);
    }
    void OnScalar(const YAML::Mark& mark, const std::string& tag, YAML::anchor_t anchor,
                  const std::string& value) override {
        // An unquoted ~ or null or nothing is null; quoted ("!" tag) it is text.
        const bool null = tag == "?" && (value.empty() || value == "~" || value == "null");
        finish({.type = null ? YamlNode::Type::null : YamlNode::Type::scalar,
                .position = position_of(mark),
                .text = value,
                .items = {},
                .entries = {}},
               anchor);
    }
    void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                         YAML::EmitterStyle::value) override {
        open(YamlNode::Type::sequence, mark, anchor);
    }
    void OnSequenceEnd() override { close(); }
    void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t anchor,
                    YAML::EmitterStyle::value) override {
        open(YamlNode::Type::map, mark, anchor);
    }
    void OnMapEnd() override { close(); }

private:
    struct Open {
        YamlNode node;
        YAML::anchor_t anchor;
        bool has_key = false;
        std::string key;
        Position key_position;
        std::unordered_map<std::string, int> line_of_key;
    };

    void count(std::size_t nodes, Position position) {
        nodes_ += nodes;
        if (nodes_ > most_nodes) throw TooManyNodes{position};
    }
    void open(YamlNode::Type type, const YAML::Mark& mark, YAML::anchor_t anchor) {
        Open level{.node = {}, .anchor = anchor, .has_key = false, .key = {}, .key_position = {}, .line_of_key = {}};
        level.node.type = type;
        level.node.position = position_of(mark);
        stack_.push_back(std::move(level));
    }
    void close() {
        Open level = std::move(stack_.back());
        stack_.pop_back();
        finish(std::move(level.node), level.anchor);
    }
    void finish(YamlNode node, YAML::anchor_t anchor) {
        count(1, node.position);
        if (anchor != 0) anchors_[anchor] = node;
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
            diagnostics_.error(map.key_position,
                               fmt::format("the key '{}' stands here a second time; it is already at line {}", map.key,
                                           earlier->second));
            return;
        }
        map.node.entries.push_back({map.key, map.key_position, std::move(value)});
    }

    Diagnostics& diagnostics_;
    std::vector<Open> stack_;
    std::map<YAML::anchor_t, YamlNode> anchors_;
    std::size_t nodes_ = 0;
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
    TreeBuilder builder(diagnostics);
    try {
        std::istringstream stream(text);
        YAML::Parser parser(stream);
        parser.HandleNextDocument(builder);
        for (TreeBuilder next(diagnostics); parser.HandleNextDocument(next);)
            if (!next.root.is_null())
                diagnostics.error(next.root.position, "a second document begins here; expected one");
    } catch (const YAML::Exception& error) {
        diagnostics.error(position_of(error.mark), "is no YAML: " + error.msg);
    } catch (const TooManyNodes& too_many) {
        diagnostics.error(too_many.position,
                          fmt::format("unfolds to more than {} nodes; write fewer aliases", most_nodes));
    }
    return std::move(builder.root);
}

}  // namespace scanmill
