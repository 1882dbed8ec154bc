// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// A JSON Schema as an editor uses it on YAML.

#include <yaml-cpp/yaml.h>

#include <charconv>
#include <nlohmann/json.hpp>
#include <string>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

namespace scanmill::test {

/// YAML as editors see it: plain scalars are numbers, booleans and null where they look like it.
inline nlohmann::json to_json(const YAML::Node& node) {
    if (node.IsSequence()) {
        nlohmann::json list = nlohmann::json::array();
        for (const YAML::Node& item : node) list.push_back(to_json(item));
        return list;
    }
    if (node.IsMap()) {
        nlohmann::json map = nlohmann::json::object();
        for (const auto& entry : node) map[entry.first.Scalar()] = to_json(entry.second);
        return map;
    }
    if (node.IsNull() || !node.IsDefined()) return nullptr;
    const std::string& text = node.Scalar();
    if (node.Tag() == "!") return text;  // it was in quotes
    if (text == "true" || text == "false") return text == "true";
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size()) return text;
    if (number == static_cast<double>(static_cast<std::int64_t>(number)) && text.find('.') == std::string::npos)
        return static_cast<std::int64_t>(number);
    return number;
}

class Schema {
public:
    explicit Schema(std::string text) : text_(std::move(text)) {
        const nlohmann::json document = nlohmann::json::parse(text_);
        valijson::SchemaParser(valijson::SchemaParser::kDraft7)
            .populateSchema(valijson::adapters::NlohmannJsonAdapter(document), schema_);
    }
    bool accepts(const std::string& workflow) { return complaints(workflow).empty(); }

    /// Every error as "position: text", where the position is the keys on the way: "steps 0 thin count".
    std::string complaints(const std::string& workflow) {
        const nlohmann::json document = to_json(YAML::Load(workflow));
        valijson::ValidationResults results;
        valijson::Validator(valijson::Validator::kStrongTypes)
            .validate(schema_, valijson::adapters::NlohmannJsonAdapter(document), &results);
        std::string all;
        for (const valijson::ValidationResults::Error& error : results) {
            for (std::size_t i = 1; i < error.context.size(); ++i)
                all += (i > 1 ? " " : "") + error.context[i].substr(1, error.context[i].size() - 2);
            all += ": " + error.description + "\n";
        }
        return all;
    }
    const std::string& text() const { return text_; }

private:
    std::string text_;
    valijson::Schema schema_;
};

/// The validator's error about an unknown key, without the key.
inline const std::string known_only =
    " that could not be validated using 'properties' or 'additionalProperties' constraints: ";

}  // namespace scanmill::test
