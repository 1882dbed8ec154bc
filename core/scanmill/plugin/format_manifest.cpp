// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/format_manifest.hpp"

#include <nlohmann/json.hpp>

#include "scanmill/base/error.hpp"
#include "scanmill/filter/manifest_json.hpp"

namespace scanmill {

namespace {

constexpr int manifest_version = 1;

}  // namespace

std::string to_json_text(const FormatManifest& manifest) {
    const FormatSpec& spec = manifest.spec;
    Json json{{"scanmill-format", manifest_version},
              {"abi", manifest.abi},
              {"name", spec.name},
              {"extensions", spec.extensions},
              {"begins", spec.begins},
              {"writes", Json::array()},
              {"reads", spec.reads}};
    for (const Kind kind : spec.writes) json["writes"].push_back(name_of(kind));
    return json.dump(2) + "\n";
}

FormatManifest parse_format_manifest(std::string_view text) try {
    const Json json = Json::parse(text);
    require_manifest_version(json, "scanmill-format", manifest_version);
    FormatManifest manifest;
    manifest.abi = field(json, "abi");
    FormatSpec& spec = manifest.spec;
    spec.name = field(json, "name");
    spec.extensions = field(json, "extensions").get<std::vector<std::string>>();
    spec.begins = field(json, "begins").get<std::vector<std::string>>();
    for (const std::string name : field(json, "writes")) {
        const std::optional<Kind> kind = kind_named(name);
        if (!kind) throw Error("'{}' is no kind", name);
        spec.writes.push_back(*kind);
    }
    spec.reads = json.value("reads", true);
    if (spec.name.empty() || spec.extensions.empty()) throw Error("names no format, or no extension");
    return manifest;
} catch (const Json::parse_error&) {
    throw Error("is no manifest: invalid JSON");
} catch (const Json::exception&) {
    throw Error("is no manifest: a member is missing or has another type");
}

}  // namespace scanmill
