// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/manifest.hpp"

#include <concepts>
#include <nlohmann/json.hpp>
#include <utility>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

using Json = nlohmann::ordered_json;

constexpr int manifest_version = 1;

template <class T>
concept HasName = Named<T> || std::same_as<T, Kind>;
template <class T>
concept List = std::same_as<T, std::vector<typename T::value_type>>;
template <class T>
concept Optional = std::same_as<T, std::optional<typename T::value_type>>;

std::optional<Kind> find_named(const std::string& name, Kind) { return kind_named(name); }
template <Named T>
std::optional<T> find_named(const std::string& name, T) {
    return value_named<T>(name);
}

/// Reads or writes the members of a JSON object.
class Archive {
public:
    enum class Mode { read, write };

    Archive(Json& json, Mode mode) : json_(json), reads_(mode == Mode::read) {}

    /// A required member.
    template <class T>
    Archive& operator()(const char* key, T& member) {
        if (reads_ && (!json_.is_object() || !json_.contains(key)))
            throw Error("is not a manifest: '{}' is missing", key);
        convert(json_[key], key, member);
        return *this;
    }
    /// A member that is absent if it has the value of a default-constructed one.
    template <class T>
    Archive& optional(const char* key, T& member) {
        return (reads_ ? json_.contains(key) : member != T{}) ? (*this)(key, member) : *this;
    }
    Archive& version(const char* key) {
        int version = manifest_version;
        (*this)(key, version);
        if (version != manifest_version)
            throw Error("is a manifest of version {}; this program reads version {}", version, manifest_version);
        return *this;
    }
    void default_value(const char* key, ParameterSpec& parameter) {
        if (reads_ ? !json_.contains(key) : std::holds_alternative<std::monostate>(parameter.default_value)) return;
        WrittenParameter value =
            reads_ ? WrittenParameter{{}, json_[key].is_array()} : written(parameter.default_value);
        if (!value.list) value.items.resize(1);
        value.list ? (*this)(key, value.items) : (*this)(key, value.items.front());
        if (reads_) parameter.default_value = parse(parameter, value);
    }

private:
    template <class T>
    void convert(Json& json, const char* key, T& value) {
        if constexpr (HasName<T>) {
            if (!reads_) {
                json = name_of(value);
                return;
            }
            const auto name = json.get<std::string>();
            const std::optional<T> found = find_named(name, T{});
            if (!found) throw Error("{}: '{}' is unknown", key, name);
            value = *found;
        } else if constexpr (List<T>) {
            if (reads_) value.resize(json.get_ref<const Json::array_t&>().size());
            if (!reads_) json = Json(value.size(), Json());
            for (std::size_t i = 0; i < value.size(); ++i) convert(json[i], key, value[i]);
        } else if constexpr (Optional<T>) {
            convert(json, key, reads_ ? value.emplace() : *value);
        } else if constexpr (requires(Archive& archive) { members(archive, value); }) {
            Archive archive(json, reads_ ? Mode::read : Mode::write);
            members(archive, value);
        } else if (!reads_) {
            json = value;
        } else {
            if constexpr (std::integral<T> && !std::same_as<T, bool>) {  // get() would convert 1.5 and 1e300
                const bool fits = json.is_number_unsigned()
                                      ? std::in_range<T>(json.get<std::uint64_t>())
                                      : json.is_number_integer() && std::in_range<T>(json.get<std::int64_t>());
                if (!fits) throw Error("is not a manifest: '{}' is not an integer, or too large", key);
            }
            value = json.get<T>();
        }
    }

    Json& json_;
    bool reads_;
};

void members(Archive& archive, Bound& bound) { archive("value", bound.value)("inclusive", bound.inclusive); }
void members(Archive& archive, Choice& choice) { archive("name", choice.name)("help", choice.help); }
void members(Archive& archive, StreamSpec& stream) { archive("given", stream.given); }
void members(Archive& archive, MeasureSpec& measure) { archive("value", measure.value)("truth", measure.truth); }
void members(Archive& archive, PortSpec& port) {
    archive("name", port.name)("kind", port.kind)("help", port.help);
    archive.optional("list", port.list).optional("optional", port.optional).optional("also", port.also);
    archive.optional("like", port.like).optional("maker", port.maker).optional("by-name", port.by_name);
}
void members(Archive& archive, MetricSpec& metric) {
    archive("name", metric.name)("unit", metric.unit)("help", metric.help);
    archive.optional("headline", metric.headline).optional("numbered", metric.numbered);
    archive.optional("better", metric.better);
}
void members(Archive& archive, ParameterSpec& parameter) {
    archive("name", parameter.name)("type", parameter.type)("help", parameter.help);
    archive.optional("list", parameter.list).optional("size", parameter.size);
    archive.optional("required", parameter.required).optional("word", parameter.word);
    archive.optional("low", parameter.low).optional("high", parameter.high).optional("choices", parameter.choices);
    archive.optional("unless-given", parameter.unless_given).optional("takes-spacings", parameter.takes_spacings);
    archive.default_value("default", parameter);
}
void members(Archive& archive, Manifest& manifest) {
    FilterSpec& spec = manifest.spec;
    archive.version("scanmill-manifest")("abi", manifest.abi)("name", spec.name)("version", spec.version);
    archive("summary", spec.summary)("source", spec.source)("ties", spec.ties)("not-finite", spec.not_finite);
    archive("inputs", spec.inputs)("outputs", spec.outputs)("parameters", spec.parameters)("metrics", spec.metrics);
    archive.optional("streams", spec.streams).optional("measures", spec.measures).optional("adds", spec.adds);
}
void members(Archive& archive, FormatManifest& manifest) {
    FormatSpec& spec = manifest.spec;
    archive.version("scanmill-format")("abi", manifest.abi)("name", spec.name)("extensions", spec.extensions);
    archive("begins", spec.begins)("writes", spec.writes)("reads", spec.reads);
}

std::string text_of(auto manifest) {
    Json json;
    Archive archive(json, Archive::Mode::write);
    members(archive, manifest);
    return json.dump(2) + "\n";
}

template <class AnyManifest>
AnyManifest parsed(std::string_view text) try {
    Json json = Json::parse(text);
    AnyManifest manifest;
    Archive archive(json, Archive::Mode::read);
    members(archive, manifest);
    return manifest;
} catch (const Json::parse_error&) {
    throw Error("is not a manifest: invalid JSON");
} catch (const Json::exception&) {
    throw Error("is not a manifest: a member is missing or has another type");
}

}  // namespace

std::string to_json_text(const Manifest& manifest) { return text_of(manifest); }
std::string to_json_text(const FormatManifest& manifest) { return text_of(manifest); }

Manifest parse_manifest(std::string_view text) { return parsed<Manifest>(text); }

FormatManifest parse_format_manifest(std::string_view text) {
    FormatManifest manifest = parsed<FormatManifest>(text);
    if (manifest.spec.name.empty() || manifest.spec.extensions.empty()) throw Error("names no format, or no extension");
    return manifest;
}

}  // namespace scanmill
