// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/cache/step_result.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

using Json = nlohmann::json;

}  // namespace

const ResultOutput* StepResult::output(std::string_view port) const {
    const auto found = std::ranges::find(outputs, port, &ResultOutput::port);
    return found == outputs.end() ? nullptr : &*found;
}

std::string to_bytes(const StepResult& result) {
    Json json{{"metrics", rows_of(result.metrics)}, {"properties", rows_of(result.properties)},
              {"warnings", result.warnings},        {"seconds", result.seconds},
              {"outputs", Json::array()},           {"resolved", Json::array()}};
    for (const ResultOutput& output : result.outputs)
        json["outputs"].push_back({output.port, output.kind.name(), output.content, output.bytes});
    for (const auto& [name, value] : result.resolved) json["resolved"].push_back({name, value.items, value.list});
    std::string bytes;
    Json::to_cbor(json, bytes);
    return bytes;
}

StepResult step_result_from(std::string_view bytes) try {
    const Json json = Json::from_cbor(bytes);
    StepResult result;
    result.metrics = metrics_from(json.at("metrics"));
    result.properties = metrics_from(json.at("properties"));
    result.warnings = json.at("warnings").get<std::vector<std::string>>();
    result.seconds = json.at("seconds").get<double>();
    for (const Json& row : json.at("outputs")) {
        const std::optional<Kind> kind = kind_named(row.at(1).get<std::string>());
        if (!kind)
            throw Error("the cached result of a step contains the unknown kind {}", row.at(1).get<std::string>());
        result.outputs.push_back(
            {row.at(0).get<std::string>(), *kind, row.at(2).get<std::string>(), row.at(3).get<u64>()});
    }
    for (const Json& row : json.at("resolved"))
        result.resolved.emplace_back(
            row.at(0).get<std::string>(),
            WrittenParameter{row.at(1).get<std::vector<std::string>>(), row.at(2).get<bool>()});
    return result;
} catch (const Json::exception&) {
    throw Error("the cached result of a step is not one that Scanmill writes");
}

}  // namespace scanmill
