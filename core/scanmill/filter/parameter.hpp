// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Parameters as data: name, type and range, and the conversion between the written form and the value.
///
/// The specification of a parameter comes from the filter's declaration (declare.hpp) or, without loading code, from
/// its manifest.

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "scanmill/data/quantity.hpp"
#include "scanmill/record/fields.hpp"

namespace scanmill {

enum class ParameterType { boolean, integer, number, choice, text, path, length, angle, ratio };
constexpr std::array<std::string_view, 9> names_of(const ParameterType*) {
    return {"boolean", "integer", "number", "choice", "text", "path", "length", "angle", "ratio"};
}

/// A word in place of a value: `auto`, `none`.
struct Word {
    std::string text;
    bool operator==(const Word&) const = default;
};
constexpr auto fields(const Word*) { return std::tuple{field("text", &Word::text)}; }

/// Choices, texts and paths are strings.
using ParameterScalar = std::variant<bool, std::int64_t, double, std::string, Length, Angle, Ratio, Word>;
/// No value (for an omitted optional parameter), one value, or a list.
using ParameterValue = std::variant<std::monostate, ParameterScalar, std::vector<ParameterScalar>>;

struct Bound {
    double value;
    bool inclusive;
    bool operator==(const Bound&) const = default;
};
constexpr auto fields(const Bound*) {
    return std::tuple{field("value", &Bound::value), field("inclusive", &Bound::inclusive)};
}

struct Choice {
    std::string name, help;
    bool operator==(const Choice&) const = default;
};
constexpr auto fields(const Choice*) { return std::tuple{field("name", &Choice::name), field("help", &Choice::help)}; }

struct ParameterSpec {
    std::string name;
    std::string help;
    ParameterType type = ParameterType::number;
    bool list = false;
    std::optional<std::size_t> size;  ///< exact length of a list
    bool required = false;            ///< there is no default
    std::string word;                 ///< accepted in place of a value; empty if there is no such word
    std::optional<Bound> low, high;   ///< limits of the written amount; angles in degrees, ratios as fractions
    std::vector<Choice> choices;
    /// Another parameter. If the other parameter has a value, the default of this one is not used.
    std::string unless_given;
    bool takes_spacings = false;   ///< lengths in `spacing` reach the filter as they are written
    ParameterValue default_value;  ///< no value if required, or optional without default

    bool operator==(const ParameterSpec&) const = default;
};
/// The default value is not among the fields, because its form depends on the other members.
constexpr auto fields(const ParameterSpec*) {
    using T = ParameterSpec;
    return std::tuple{
        field("name", &T::name),
        field("type", &T::type),
        field("help", &T::help),
        field("list", &T::list).optional(),
        field("size", &T::size, "The exact length of the list.").optional(),
        field("required", &T::required, "The parameter has no default.").optional(),
        field("word", &T::word, "Accepted in place of a value.").optional(),
        field("low", &T::low).optional(),
        field("high", &T::high).optional(),
        field("choices", &T::choices).optional(),
        field("unless-given", &T::unless_given, "The default is not used if this parameter is given.").optional(),
        field("takes-spacings", &T::takes_spacings, "Lengths in `spacing` reach the filter as they are written.")
            .optional()};
}

/// A value as the user wrote it: texts that are not interpreted yet.
struct WrittenParameter {
    std::vector<std::string> items;
    bool list = false;
};

/// "a length above 0, as 0.2 mm, 0.1 %diag, 3 spacing or 0.5 u; or `auto`".
std::string expectation(const ParameterSpec& spec);

/// The value of the written form. Throws Error "… is wrong; expected …; did you mean …".
ParameterValue parse(const ParameterSpec& spec, const WrittenParameter& written);

/// Throws Error when the value is out of the declared range.
void require_in_range(const ParameterSpec& spec, const ParameterValue& value);

/// The value as people write it: "0.1 %diag", "[0, 1]"; empty for no value.
std::string text(const ParameterValue& value);
/// A text for cache keys that is the same for equal values: 40 deg and 0.698… rad have one text.
std::string canonical_text(const ParameterValue& value);
/// The text or texts that parse() reads back to the same value. Pre: there is a value.
WrittenParameter written(const ParameterValue& value);

/// Whether there is a value other than a word.
bool has_value(const ParameterValue* value);
/// Whether the value contains a length in `spacing`.
bool is_in_spacings(const ParameterValue& value);
/// The value with all lengths in the scan's own unit.
ParameterValue resolved(ParameterValue value, const LengthScale& scale);

/// Named values, in declaration order.
struct ParameterSet {
    std::vector<std::pair<std::string, ParameterValue>> values;

    const ParameterValue* find(std::string_view name) const;
};
constexpr auto fields(const ParameterSet*) { return std::tuple{field("values", &ParameterSet::values)}; }

}  // namespace scanmill
