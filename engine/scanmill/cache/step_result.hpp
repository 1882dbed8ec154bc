// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The result of a step as the cache stores it, and the serialisation that the cache and worker messages share.
///
/// Everything is stored as CBOR through nlohmann::json. Numbers keep their bits and texts need not be UTF-8.

#include <concepts>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "scanmill/data/metrics.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/filter/parameter.hpp"
#include "scanmill/kinds/value.hpp"

namespace nlohmann {

template <class T>
struct adl_serializer<std::optional<T>> {
    static void to_json(json& value, const std::optional<T>& object) {
        value = object ? json::array({*object}) : json::array();
    }
    static void from_json(const json& value, std::optional<T>& object) {
        object.reset();
        if (!value.empty()) value.at(0).get_to(object.emplace());
    }
};

/// [index of the alternative, alternative].
template <class... Types>
struct adl_serializer<std::variant<Types...>> {
    static void to_json(json& value, const std::variant<Types...>& object) {
        std::visit([&](const auto& item) { value = json::array({object.index(), json(item)}); }, object);
    }
    static void from_json(const json& value, std::variant<Types...>& object) {
        const auto wanted = value.at(0).get<std::size_t>();
        std::size_t index = 0;
        const auto read = [&]<class Type>(Type&& item) {
            if (index++ == wanted) object = value.at(1).get_to(item);
        };
        (read(Types{}), ...);
        if (wanted >= index) throw json::out_of_range::create(401, "no such alternative", &value);
    }
};

template <>
struct adl_serializer<std::monostate> {
    static void to_json(json& value, std::monostate) { value = nullptr; }
    static void from_json(const json&, std::monostate&) {}
};

}  // namespace nlohmann

namespace scanmill {

inline void to_json(nlohmann::json& json, Kind kind) { json = kind.name(); }
/// Throws Error for an unknown kind.
void from_json(const nlohmann::json& json, Kind& kind);

/// Lengths, angles and ratios as text, which reads back to the same value.
template <class Quantity>
concept WrittenQuantity =
    std::same_as<Quantity, Length> || std::same_as<Quantity, Angle> || std::same_as<Quantity, Ratio>;
template <WrittenQuantity Quantity>
void to_json(nlohmann::json& json, const Quantity& quantity) {
    json = quantity.text();
}
template <WrittenQuantity Quantity>
void from_json(const nlohmann::json& json, Quantity& quantity) {
    quantity = Quantity::parse(json.get<std::string>());
}

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Word, text)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ParameterSet, values)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Metric, name, value, unit)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Metrics, values, unit)

NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Doubt, text, port)

struct ResultOutput {
    std::string port;
    Kind kind = kind_of<PointCloud>();
    std::string content;  ///< EncodedValue::content()
    u64 bytes = 0;        ///< of its value file

    bool operator==(const ResultOutput&) const = default;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(ResultOutput, port, kind, content, bytes)

/// What a step gave, without the values themselves: their content hashes name their files in the cache.
struct StepResult {
    std::vector<ResultOutput> outputs;
    ParameterSet resolved;  ///< lengths in the scan's unit; without parameters that name files
    Metrics metrics;
    Metrics properties;  ///< of the primary output; empty unless requested
    std::vector<std::string> warnings;
    std::vector<Doubt> doubts;
    double seconds = 0;  ///< run time of the filter

    const ResultOutput* output(std::string_view port) const;
};
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(StepResult, outputs, resolved, metrics, properties, warnings, doubts, seconds)

std::string to_bytes(const nlohmann::json& json);
/// Throws Error for bytes that are not a serialised StepResult.
StepResult step_result_from(std::string_view bytes);

}  // namespace scanmill
