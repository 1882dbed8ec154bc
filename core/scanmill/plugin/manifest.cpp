// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plugin/manifest.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

/// The JSON form contains the default value as it is written in a workflow: a text, or a list of texts.
template <>
struct JsonForm<ParameterSpec> : FieldsForm<ParameterSpec> {
    static Json write(const ParameterSpec& spec) {
        Json json = FieldsForm::write(spec);
        if (std::holds_alternative<std::monostate>(spec.default_value)) return json;
        const WrittenParameter value = written(spec.default_value);
        json["default"] = value.list ? json_of(value.items) : json_of(value.items.front());
        return json;
    }
    static void read(const Json& json, ParameterSpec& spec) {
        require_object(json);
        require_known(json, names({"default"}));
        read_members(json, spec);
        const auto found = json.find("default");
        if (found == json.end()) return;
        WrittenParameter value{{}, found->is_array()};
        if (value.list)
            scanmill::read_member(*found, "default", value.items);
        else
            scanmill::read_member(*found, "default", value.items.emplace_back());
        spec.default_value = parse(spec, value);
    }
    static Json schema() {
        Json object = FieldsForm::schema();
        const Json text{{"type", {"string", "array"}}, {"items", schema::type("string")}};
        schema::add(object, "default", schema::described("The default value as it is written in a workflow.", "", text),
                    false);
        return object;
    }
};

namespace {

constexpr int manifest_version = 1;
constexpr const char *filter_key = "scanmill-manifest", *format_key = "scanmill-format";

template <class AnyManifest>
std::string text_of(const AnyManifest& manifest, const char* version_key) {
    Json json{{version_key, manifest_version}};
    JsonForm<AnyManifest>::write_members(json, manifest);
    return json.dump(2) + "\n";
}

template <class AnyManifest>
AnyManifest parsed(std::string_view text, const char* version_key) try {
    const Json json = Json::parse(text);
    if (!json.is_object() || !json.contains(version_key))
        throw Error("is not a manifest: '{}' is missing", version_key);
    int version = 0;
    read_member(json[version_key], version_key, version);
    if (version != manifest_version)
        throw Error("is a manifest of version {}; this program reads version {}", version, manifest_version);
    AnyManifest manifest;
    require_known(json, JsonForm<AnyManifest>::names({version_key}));
    JsonForm<AnyManifest>::read_members(json, manifest);
    return manifest;
} catch (const Json::parse_error&) {
    throw Error("is not a manifest: invalid JSON");
} catch (const JsonMismatch& mismatch) {
    throw_mismatch(mismatch, "is not a manifest");
}

/// The bytes as a text in which each byte is the character of its number, because JSON has texts only.
std::string text_of_bytes(std::string_view bytes) {
    std::string text;
    for (const char each : bytes) {
        const auto byte = static_cast<unsigned char>(each);
        if (byte < 0x80) {
            text += each;
        } else {
            text += static_cast<char>(0xC0 | byte >> 6);
            text += static_cast<char>(0x80 | (byte & 0x3F));
        }
    }
    return text;
}

/// The inverse of text_of_bytes(). Throws Error for a character beyond 255. Pre: `text` is valid UTF-8.
std::string bytes_of_text(std::string_view text) {
    std::string bytes;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const auto lead = static_cast<unsigned char>(text[i]);
        if (lead < 0x80) {
            bytes += text[i];
        } else if (lead <= 0xC3) {
            bytes += static_cast<char>(lead << 6 | (static_cast<unsigned char>(text[++i]) & 0x3F));
        } else {
            throw Error("is not a manifest: 'begins' has a character beyond U+00FF; each character is one byte");
        }
    }
    return bytes;
}

}  // namespace

std::string to_json_text(const Manifest& manifest) { return text_of(manifest, filter_key); }

std::string to_json_text(const FormatManifest& manifest) {
    FormatManifest written = manifest;
    for (std::string& beginning : written.spec.begins) beginning = text_of_bytes(beginning);
    return text_of(written, format_key);
}

Manifest parse_manifest(std::string_view text) { return parsed<Manifest>(text, filter_key); }

FormatManifest parse_format_manifest(std::string_view text) {
    auto manifest = parsed<FormatManifest>(text, format_key);
    if (manifest.spec.name.empty() || manifest.spec.extensions.empty()) throw Error("names no format, or no extension");
    for (std::string& beginning : manifest.spec.begins) beginning = bytes_of_text(beginning);
    return manifest;
}

Json declaration_json(const FilterSpec& spec) { return json_of(spec); }
Json declaration_schema() { return JsonForm<FilterSpec>::schema(); }

}  // namespace scanmill
