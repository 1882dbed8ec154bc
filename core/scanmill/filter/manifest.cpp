// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/manifest.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/filter/manifest_json.hpp"

namespace scanmill {

namespace {

constexpr int manifest_version = 1;

Json to_json(const PortSpec& port) {
    Json json{{"name", port.name}, {"kind", name_of(port.kind)}, {"help", port.help}};
    if (port.list) json["list"] = true;
    if (port.optional) json["optional"] = true;
    for (const Kind kind : port.also) json["also"].push_back(name_of(kind));
    if (!port.like.empty()) json["like"] = port.like;
    if (!port.maker.empty()) json["maker"] = port.maker;
    return json;
}

Json to_json(const Bound& bound) { return {{"value", bound.value}, {"inclusive", bound.inclusive}}; }

Json to_json(const ParameterSpec& parameter) {
    Json json{{"name", parameter.name}, {"type", name_of(parameter.type)}, {"help", parameter.help}};
    if (parameter.list) json["list"] = true;
    if (parameter.size) json["size"] = *parameter.size;
    if (parameter.required) json["required"] = true;
    if (!parameter.word.empty()) json["word"] = parameter.word;
    if (parameter.low) json["low"] = to_json(*parameter.low);
    if (parameter.high) json["high"] = to_json(*parameter.high);
    for (const Choice& choice : parameter.choices)
        json["choices"].push_back({{"name", choice.name}, {"help", choice.help}});
    if (!std::holds_alternative<std::monostate>(parameter.default_value)) {
        const WrittenParameter value = written(parameter.default_value);
        json["default"] = value.list ? Json(value.items) : Json(value.items.front());
    }
    return json;
}

Json to_json(const MetricSpec& metric) {
    Json json{{"name", metric.name}, {"unit", name_of(metric.unit)}, {"help", metric.help}};
    if (metric.headline) json["headline"] = true;
    if (metric.numbered) json["numbered"] = true;
    return json;
}

template <class Items>
Json list_of(const Items& items) {
    Json json = Json::array();
    for (const auto& item : items) json.push_back(to_json(item));
    return json;
}

template <class T>
T required_name(const std::optional<T>& named, std::string_view what, const std::string& name) {
    if (!named) throw Error("'{}' is no {}", name, what);
    return *named;
}

Kind kind_from(const std::string& name) { return required_name(kind_named(name), "kind", name); }

PortSpec port_from(const Json& json) {
    PortSpec port{field(json, "name"), kind_from(field(json, "kind")), field(json, "help"), json.value("list", false),
                  json.value("optional", false)};
    for (const auto& also : json.value("also", Json::array())) port.also.push_back(kind_from(also));
    port.like = json.value("like", "");
    port.maker = json.value("maker", "");
    return port;
}

std::optional<Bound> bound_from(const Json& json, const char* key) {
    if (!json.contains(key)) return std::nullopt;
    return Bound{field(json[key], "value"), field(json[key], "inclusive")};
}

ParameterSpec parameter_from(const Json& json) {
    ParameterSpec parameter;
    const std::string type = field(json, "type");
    parameter.name = field(json, "name");
    parameter.type = required_name(parameter_type_named(type), "parameter type", type);
    parameter.help = field(json, "help");
    parameter.list = json.value("list", false);
    if (json.contains("size")) parameter.size = whole_number<std::size_t>(json, "size");
    parameter.required = json.value("required", false);
    parameter.word = json.value("word", "");
    parameter.low = bound_from(json, "low");
    parameter.high = bound_from(json, "high");
    if (json.contains("choices"))
        for (const Json& choice : json["choices"]) parameter.choices.push_back({choice.at("name"), choice.at("help")});
    if (json.contains("default")) {
        const Json& value = json["default"];
        WrittenParameter default_text;
        default_text.list = value.is_array();
        if (value.is_array())
            default_text.items = value.get<std::vector<std::string>>();
        else
            default_text.items = {value.get<std::string>()};
        parameter.default_value = parse(parameter, default_text);
    }
    return parameter;
}

MetricSpec metric_from(const Json& json) {
    const std::string unit = field(json, "unit");
    return {field(json, "name"), required_name(unit_named(unit), "unit", unit), field(json, "help"),
            json.value("headline", false), json.value("numbered", false)};
}

}  // namespace

std::string to_json_text(const Manifest& manifest) {
    const FilterSpec& spec = manifest.spec;
    Json json{{"scanmill-manifest", manifest_version},
              {"abi", manifest.abi},
              {"name", spec.name},
              {"version", spec.version},
              {"summary", spec.summary},
              {"source", spec.source},
              {"ties", spec.ties},
              {"not-finite", spec.not_finite},
              {"inputs", list_of(spec.inputs)},
              {"outputs", list_of(spec.outputs)},
              {"parameters", list_of(spec.parameters)},
              {"metrics", list_of(spec.metrics)}};
    if (spec.streams) json["streams"] = {{"given", spec.streams->given}};
    return json.dump(2) + "\n";
}

Manifest parse_manifest(std::string_view text) try {
    const Json json = Json::parse(text);
    require_manifest_version(json, "scanmill-manifest", manifest_version);
    Manifest manifest;
    manifest.abi = field(json, "abi");
    FilterSpec& spec = manifest.spec;
    spec.name = field(json, "name");
    spec.version = whole_number<int>(json, "version");
    spec.summary = field(json, "summary");
    spec.source = field(json, "source");
    spec.ties = field(json, "ties");
    spec.not_finite = field(json, "not-finite");
    for (const Json& port : field(json, "inputs")) spec.inputs.push_back(port_from(port));
    for (const Json& port : field(json, "outputs")) spec.outputs.push_back(port_from(port));
    for (const Json& parameter : field(json, "parameters")) spec.parameters.push_back(parameter_from(parameter));
    for (const Json& metric : field(json, "metrics")) spec.metrics.push_back(metric_from(metric));
    if (json.contains("streams"))
        spec.streams = StreamSpec{field(json["streams"], "given").get<std::vector<std::string>>()};
    return manifest;
} catch (const Json::parse_error&) {
    throw Error("is no manifest: invalid JSON");
} catch (const Json::exception&) {
    throw Error("is no manifest: a member is missing or has another type");
}

}  // namespace scanmill
