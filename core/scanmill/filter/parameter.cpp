// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/parameter.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <span>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

template <class... Actions>
struct Overloaded : Actions... {
    using Actions::operator()...;
};
template <class... Actions>
Overloaded(Actions...) -> Overloaded<Actions...>;  // clang 16 needs the deduction guide

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

/// The properties of a type that messages and parsing need.
struct TypeRow {
    std::string_view noun, example;
    ParameterScalar (*parse)(const ParameterSpec& spec, const std::string& text);
    bool parse_names_expected;  ///< whether the Error of `parse` already states what was expected
};

ParameterScalar parse_boolean(const ParameterSpec&, const std::string& text) {
    if (text != "true" && text != "false") throw Error("'{}' is neither true nor false", text);
    return text == "true";
}

ParameterScalar parse_integer(const ParameterSpec&, const std::string& text) {
    std::int64_t value = 0;
    const auto [rest, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc() || rest != text.data() + text.size()) throw Error("'{}' is not a whole number", text);
    return value;
}

ParameterScalar parse_plain_number(const ParameterSpec&, const std::string& text) {
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

ParameterScalar parse_text(const ParameterSpec&, const std::string& text) { return text; }

template <class Quantity>
ParameterScalar parse_quantity(const ParameterSpec&, const std::string& text) {
    return Quantity::parse(text);
}

/// Indexed by ParameterType.
constexpr std::array<TypeRow, 9> types{{
    {"true or false", "", parse_boolean, false},
    {"a whole number", "", parse_integer, false},
    {"a number", "", parse_plain_number, false},
    {"one of ", "", parse_choice, true},
    {"a text", "", parse_text, false},
    {"a path", "", parse_text, false},
    {"a length", length_examples, parse_quantity<Length>, true},
    {"an angle", angle_examples, parse_quantity<Angle>, true},
    {"a ratio", ratio_examples, parse_quantity<Ratio>, true},
}};

const TypeRow& row_of(ParameterType type) { return types[static_cast<std::size_t>(type)]; }

/// The number that is compared with a bound; nullopt for types without an order.
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

/// The items of a value: none, one or several. `Value` is ParameterValue or const ParameterValue.
template <class Value>
auto items_of(Value& value) {
    using Item = std::conditional_t<std::is_const_v<Value>, const ParameterScalar, ParameterScalar>;
    if (auto* list = std::get_if<std::vector<ParameterScalar>>(&value)) return std::span<Item>(*list);
    auto* one = std::get_if<ParameterScalar>(&value);
    return std::span<Item>(one, one ? 1 : 0);
}

bool is_list(const ParameterValue& value) { return std::holds_alternative<std::vector<ParameterScalar>>(value); }

template <class ScalarText>
std::string joined(const ParameterValue& value, ScalarText&& scalar) {
    std::string text;
    for (const ParameterScalar& item : items_of(value)) text += (text.empty() ? "" : ", ") + scalar(item);
    return is_list(value) ? "[" + text + "]" : text;
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

std::string expectation(const ParameterSpec& spec) {
    const TypeRow& type = row_of(spec.type);
    std::string expected(type.noun);
    expected.append(enumerated(choice_names(spec))).append(range_text(spec));
    if (!type.example.empty()) expected.append(", as ").append(type.example);
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
    // A single value in place of a list is a list of one.
    const auto item = [&](const std::string& text) {
        bool is_parsed = false;
        try {
            const ParameterScalar value = row_of(spec.type).parse(spec, text);
            is_parsed = true;
            require_item_in_range(spec, value);
            return value;
        } catch (const Error& error) {
            std::string sentence = error.sentence();
            if (!is_parsed && !row_of(spec.type).parse_names_expected) sentence += "; expected " + expectation(spec);
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
    for (const ParameterScalar& item : items_of(value)) require_item_in_range(spec, item);
}

std::string text(const ParameterValue& value) { return joined(value, scalar_text); }

std::string canonical_text(const ParameterValue& value) {
    // A text in a list is preceded by its length: a text that contains ", " must not equal two texts.
    return joined(value, [&](const ParameterScalar& item) {
        const std::string one = canonical_scalar(item);
        const bool is_text = std::holds_alternative<std::string>(item);
        return is_list(value) && is_text ? std::to_string(one.size()) + ":" + one : one;
    });
}

WrittenParameter written(const ParameterValue& value) {
    WrittenParameter result{{}, is_list(value)};
    for (const ParameterScalar& item : items_of(value)) result.items.push_back(scalar_text(item));
    return result;
}

bool has_value(const ParameterValue* value) {
    if (!value || std::holds_alternative<std::monostate>(*value)) return false;
    const auto* one = std::get_if<ParameterScalar>(value);
    return !one || !std::holds_alternative<Word>(*one);
}

bool is_in_spacings(const ParameterValue& value) {
    return std::ranges::any_of(items_of(value), [](const ParameterScalar& item) {
        const Length* length = std::get_if<Length>(&item);
        return length && length->in() == Length::In::spacing;
    });
}

ParameterValue resolved(ParameterValue value, const LengthScale& scale) {
    for (ParameterScalar& item : items_of(value))
        if (auto* length = std::get_if<Length>(&item)) *length = length->resolved(scale);
    return value;
}

const ParameterValue* ParameterSet::find(std::string_view name) const {
    for (const auto& [key, value] : values)
        if (key == name) return &value;
    return nullptr;
}

}  // namespace scanmill
