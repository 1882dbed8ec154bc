// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/output_schemas.hpp"
#include "support/folders.hpp"

#include <algorithm>
#include <filesystem>
#include <map>
#include <mutex>
#include <sstream>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

#include "support/temporary_folder.hpp"

namespace scanmill::test {

namespace {

using nlohmann::json;

const valijson::Schema& schema_named(const std::string& name) {
    static std::map<std::string, valijson::Schema> schemas;
    const auto [found, is_new] = schemas.try_emplace(name);
    if (is_new) {
        std::string file = source_folder() + "/schemas/output/" + name + ".schema.json";
        if (!std::filesystem::exists(file)) file = source_folder() + "/schemas/documents/" + name + ".schema.json";
        const json document = json::parse(content_of(file));
        valijson::SchemaParser(valijson::SchemaParser::kDraft7)
            .populateSchema(valijson::adapters::NlohmannJsonAdapter(document), found->second);
    }
    return found->second;
}

std::string schema_of(const std::vector<std::string>& arguments, const json& document) {
    const auto has = [&](const char* word) { return std::ranges::find(arguments, word) != arguments.end(); };
    const std::string& command = arguments.front();
    if (document.contains("error") && !document.contains("event")) return "error";
    if (command == "batch" && has("--status")) return "batch-status";
    if (command == "run" || command == "batch") {
        if (document.contains("files")) return "check";
        if (has("--dry-run")) return "dry-run";
        return command == "run" ? "run" : "batch-event";
    }
    if (command == "show" && has("--example")) return "show-example";
    if (command == "runs" && has("--prune")) return "runs-prune";
    if (command == "runs" && has("merge")) return "runs-merge";
    if (command == "runs" && has("show")) return "runs-show";
    if (command == "cache") return has("clear") ? "cache-clear" : "cache-info";
    return command;
}

}  // namespace

std::string schema_errors(const std::string& name, const json& document) {
    static std::mutex one_at_a_time;
    const std::scoped_lock lock(one_at_a_time);
    valijson::ValidationResults results;
    valijson::Validator(valijson::Validator::kStrongTypes)
        .validate(schema_named(name), valijson::adapters::NlohmannJsonAdapter(document), &results);
    std::string all;
    for (const valijson::ValidationResults::Error& error : results) {
        for (const std::string& step : error.context) all += step;
        all += ": " + error.description + "\n";
    }
    return all;
}

std::vector<OutputDocument> output_documents(const std::vector<std::string>& arguments, const std::string& out) {
    std::vector<OutputDocument> all;
    const auto add = [&](const std::string& text) {
        json document = json::parse(text, nullptr, false);
        if (!document.is_object()) return false;
        const std::string schema = schema_of(arguments, document);
        all.push_back({schema, std::move(document)});
        return true;
    };
    if (add(out)) return all;
    std::istringstream lines(out);
    for (std::string line; std::getline(lines, line);) add(line);
    return all;
}

}  // namespace scanmill::test
