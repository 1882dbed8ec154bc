// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/parameter.hpp"
#include "scanmill/base/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

constexpr std::array<std::string_view, 9> type_names{"boolean", "integer", "number", "choice", "text",
                                                     "path",    "length",  "angle",  "ratio"};

template <class... Actions>
struct Overloaded : Actions... {
    using Actions::operator()...;
};
template <class... Actions>
Overloaded(Actions...) -> Overloaded<Actions...>;  // clang 16 needs it said

std::string range_text(const ParameterSpec& spec) {
    const std::string unit = spec.type == ParameterType::angle ? " deg" : "";
    std::string range;
    if (spec.low) range += (spec.low->inclusive ? " of at least " : " above ") + number_text(spec.low->value) + unit;
    if (spec.high)
        range += (spec.low               ? " and "
                  : spec.high->inclusive ? " of "
                                         : " ") +
                 std::string(spec.high->inclusive ? "at most " : "below ") + number_text(spec.high->value) + unit;
    return range;
}

std::vector<std::string> choice_names(const ParameterSpec& spec) {
    std::vector<std::string> names;
    for (const Choice& choice : spec.choices) names.push_back(choice.name);
    return names;
}

std::string one_value_expectation(const ParameterSpec& spec) {
    switch (spec.type) {
        case ParameterType::boolean: return "true or false";
        case ParameterType::integer: return "a whole number" + range_text(spec);
        case ParameterType::number: return "a number" + range_text(spec);
        case ParameterType::choice: return "one of " + enumerated(choice_names(spec));
        case ParameterType::text: return "a text";
        case ParameterType::path: return "a path";
        case ParameterType::length: return "a length" + range_text(spec) + ", as " + std::string(length_examples());
        case ParameterType::angle: return "an angle" + range_text(spec) + ", as 40 deg or 0.7 rad";
        case ParameterType::ratio: return "a ratio" + range_text(spec) + ", as 5 % or 0.05";
    }
    return "";
}

ParameterScalar parse_integer(std::string_view text) {
    std::int64_t value = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || rest != text.data() + text.size()) throw Error("'{}' is not a whole number", text);
    return value;
}

ParameterScalar parse_plain_number(std::string_view text) {
    double value = 0;
    if (!parse_number(text, value) || !std::isfinite(value)) throw Error("'{}' is not a number", text);
    return value;
}

ParameterScalar parse_choice(const ParameterSpec& spec, const std::string& text) {
    const std::vector<std::string> names = choice_names(spec);
    if (std::ranges::find(names, text) == names.end())
        throw Error("'{}' is not one of {}{}", text, enumerated(names), did_you_mean(text, names));
    return text;
}

ParameterScalar parse_one(const ParameterSpec& spec, const std::string& text) {
    switch (spec.type) {
        case ParameterType::boolean:
            if (text == "true") return true;
            if (text == "false") return false;
            throw Error("'{}' is neither true nor false", text);
        case ParameterType::integer: return parse_integer(text);
        case ParameterType::number: return parse_plain_number(text);
        case ParameterType::choice: return parse_choice(spec, text);
        case ParameterType::text:
        case ParameterType::path: return text;
        case ParameterType::length: return Length::parse(text);
        case ParameterType::angle: return Angle::parse(text);
        case ParameterType::ratio: return Ratio::parse(text);
    }
    return text;
}

/// The number that a bound compares; nothing for types without an order.
std::optional<double> amount(const ParameterScalar& value) {
    return std::visit(Overloaded{
                          [](std::int64_t number) -> std::optional<double> { return static_cast<double>(number); },
                          [](double number) -> std::optional<double> { return number; },
                          [](const Length& length) -> std::optional<double> { return length.amount(); },
                          [](const Angle& angle) -> std::optional<double> { return angle.in_degrees(); },
                          [](const Ratio& ratio) -> std::optional<double> { return ratio.value(); },
                          [](const auto&) -> std::optional<double> { return std::nullopt; },
                      },
                      value);
}

std::string scalar_text(const ParameterScalar& value) {
    return std::visit(Overloaded{
                          [](bool flag) -> std::string { return flag ? "true" : "false"; },
                          [](std::int64_t number) { return std::to_string(number); },
                          [](double number) { return number_text(number); },
                          [](const std::string& words) { return words; },
                          [](const Word& word) { return word.text; },
                          [](const auto& quantity) { return quantity.text(); },
                      },
                      value);
}

std::string canonical_scalar(const ParameterScalar& value) {
    return std::visit(Overloaded{
                          [](const Angle& angle) { return number_text(angle.in_radians()); },
                          [](const Ratio& ratio) { return number_text(ratio.value()); },
                          [](const auto& other) { return scalar_text(other); },
                      },
                      value);
}

template <class ScalarText>
std::string joined(const ParameterValue& value, ScalarText&& scalar) {
    if (const auto* one = std::get_if<ParameterScalar>(&value)) return scalar(*one);
    const auto* list = std::get_if<std::vector<ParameterScalar>>(&value);
    if (!list) return {};
    std::string text = "[";
    for (const ParameterScalar& item : *list) text += (text.size() > 1 ? ", " : "") + scalar(item);
    return text + "]";
}

void require_item_in_range(const ParameterSpec& spec, const ParameterScalar& item) {
    const std::optional<double> number = amount(item);
    if (!number) return;
    const auto below = [&](const Bound& low) { return low.inclusive ? *number < low.value : *number <= low.value; };
    const auto above = [&](const Bound& high) { return high.inclusive ? *number > high.value : *number >= high.value; };
    if ((spec.low && below(*spec.low)) || (spec.high && above(*spec.high)))
        throw Error("{} is out of range; expected {}", scalar_text(item), expectation(spec));
}

}  // namespace

std::string_view name_of(ParameterType type) { return type_names[static_cast<std::size_t>(type)]; }

std::optional<ParameterType> parameter_type_named(std::string_view name) {
    const auto found = std::ranges::find(type_names, name);
    if (found == type_names.end()) return std::nullopt;
    return static_cast<ParameterType>(found - type_names.begin());
}

std::string expectation(const ParameterSpec& spec) {
    std::string expected = one_value_expectation(spec);
    if (spec.list)
        expected =
            "a list of " + (spec.size ? std::to_string(*spec.size) + " values" : "values") + ", each " + expected;
    if (!spec.word.empty()) expected += "; or `" + spec.word + "`";
    return expected;
}

ParameterValue parse(const ParameterSpec& spec, const WrittenParameter& written) {
    if (!written.list && !spec.word.empty() && written.items.front() == spec.word)
        return ParameterScalar(Word{spec.word});
    if (written.list && !spec.list) throw Error("is a list; expected {}", expectation(spec));
    // A single value in a list's place is the list of that value, unless the list must have another length.
    const auto item = [&](const std::string& text) {
        try {
            const ParameterScalar value = parse_one(spec, text);
            require_item_in_range(spec, value);
            return value;
        } catch (Error& error) {
            std::string sentence = error.sentence();
            if (sentence.find("; expected ") == std::string::npos && spec.type != ParameterType::choice)
                sentence += "; expected " + expectation(spec);
            if (!spec.word.empty()) {
                const std::vector<std::string> words{spec.word};
                sentence += did_you_mean(text, words);
            }
            throw Error(std::move(sentence));
        }
    };
    if (!spec.list) return item(written.items.front());
    if (spec.size && written.items.size() != *spec.size)
        throw Error("has {}; expected {}", count_text(written.items.size(), "value", "values"), expectation(spec));
    std::vector<ParameterScalar> values;
    for (const std::string& text : written.items) values.push_back(item(text));
    return values;
}

void require_in_range(const ParameterSpec& spec, const ParameterValue& value) {
    if (const auto* one = std::get_if<ParameterScalar>(&value)) require_item_in_range(spec, *one);
    if (const auto* list = std::get_if<std::vector<ParameterScalar>>(&value))
        for (const ParameterScalar& item : *list) require_item_in_range(spec, item);
}

std::string text(const ParameterValue& value) { return joined(value, scalar_text); }

std::string canonical_text(const ParameterValue& value) {
    if (!std::holds_alternative<std::vector<ParameterScalar>>(value)) return joined(value, canonical_scalar);
    // With its length before it, a text that holds ", " is not taken for two.
    return joined(value, [](const ParameterScalar& item) {
        const std::string one = canonical_scalar(item);
        return std::holds_alternative<std::string>(item) ? std::to_string(one.size()) + ":" + one : one;
    });
}

WrittenParameter written(const ParameterValue& value) {
    WrittenParameter result;
    if (const auto* list = std::get_if<std::vector<ParameterScalar>>(&value)) {
        result.list = true;
        for (const ParameterScalar& item : *list) result.items.push_back(scalar_text(item));
    } else {
        result.items.push_back(scalar_text(std::get<ParameterScalar>(value)));
    }
    return result;
}

ParameterValue resolved(const ParameterValue& value, const LengthScale& scale) {
    const auto resolve = [&](const ParameterScalar& item) -> ParameterScalar {
        if (const auto* length = std::get_if<Length>(&item)) return length->resolved(scale);
        return item;
    };
    if (const auto* one = std::get_if<ParameterScalar>(&value)) return resolve(*one);
    if (const auto* list = std::get_if<std::vector<ParameterScalar>>(&value)) {
        std::vector<ParameterScalar> items;
        for (const ParameterScalar& item : *list) items.push_back(resolve(item));
        return items;
    }
    return value;
}

const ParameterValue* ParameterSet::find(std::string_view name) const {
    for (const auto& [key, value] : values)
        if (key == name) return &value;
    return nullptr;
}

}  // namespace scanmill
