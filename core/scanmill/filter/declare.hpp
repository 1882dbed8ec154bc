// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How a filter declares itself, in one expression (see filters/voxel_thin/plugin.cpp).
///
/// A parameter's type follows from the member of the params struct that it binds, its default from that member's
/// initialiser: each fact stands once. Constraints come after the help text, in any order:
///
///     .param("bin-size", &P::bin_size, "Edge of a voxel.", above(0), word("auto"))
///
/// Members: bool, integers, double, std::string, std::filesystem::path, Length, Angle, Ratio, std::vector of these, and
/// std::optional of any of these for a parameter that may be left out or replaced by its word (then nullopt).

#include <concepts>
#include <filesystem>
#include <functional>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "scanmill/filter/context.hpp"
#include "scanmill/filter/error.hpp"
#include "scanmill/filter/ports.hpp"
#include "scanmill/filter/spec.hpp"

namespace scanmill {

/// A filter as the engine sees it.
struct FilterDeclaration {
    FilterSpec spec;
    /// Pre: every declared parameter has a value (resolved, in range) and every non-optional input is wired.
    std::function<Outputs(const Inputs&, const ParameterSet&, Context&)> run;
};

namespace constraint {
struct Low {
    Bound bound;
    void apply(ParameterSpec& spec) const { spec.low = bound; }
};
struct High {
    Bound bound;
    void apply(ParameterSpec& spec) const { spec.high = bound; }
};
struct InPlaceOfAValue {
    std::string text;
    void apply(ParameterSpec& spec) const {
        spec.word = text;
        spec.default_value = ParameterScalar(Word{text});
    }
};
struct Required {
    void apply(ParameterSpec& spec) const {
        spec.required = true;
        spec.default_value = std::monostate{};
    }
};
struct Size {
    std::size_t count;
    void apply(ParameterSpec& spec) const { spec.size = count; }
};
}  // namespace constraint

/// Lengths are compared as written, whatever their unit, so their bounds should be 0; angles in degrees, ratios as
/// fractions.
inline constraint::Low above(double value) { return {{value, false}}; }
inline constraint::Low at_least(double value) { return {{value, true}}; }
inline constraint::High below(double value) { return {{value, false}}; }
inline constraint::High at_most(double value) { return {{value, true}}; }
/// A word that may stand in place of a value, and is the default. Pre: the member is a std::optional, empty by default.
inline constraint::InPlaceOfAValue word(std::string text) { return {std::move(text)}; }
/// There is no sensible default: the workflow must give a value.
inline constexpr constraint::Required required{};
/// A list of exactly this many values.
inline constraint::Size size(std::size_t count) { return {count}; }

/// Port options, none, one or both: `.in<TriangleMesh>("mesh", "…", optional)`, `.in<PointCloud>("points", "…", list)`.
enum class PortOption { optional, list };
inline constexpr PortOption optional = PortOption::optional;
inline constexpr PortOption list = PortOption::list;

/// In place of nothing at the end of .metric(…): gives the metric a column in a run's summary.
enum class MetricOption { plain, headline };
inline constexpr MetricOption headline = MetricOption::headline;

/// One alternative of a choice: its written name, the enumerator, what it does.
template <class Enum>
struct Alternative {
    std::string name;
    Enum value;
    std::string help;
};

namespace detail {

template <class T>
struct Member;  // not a type that a parameter can have

template <>
struct Member<bool> {
    static constexpr ParameterType type = ParameterType::boolean;
    using Stored = bool;
};
template <std::integral T>
struct Member<T> {
    static constexpr ParameterType type = ParameterType::integer;
    using Stored = std::int64_t;
};
template <>
struct Member<double> {
    static constexpr ParameterType type = ParameterType::number;
    using Stored = double;
};
template <>
struct Member<std::string> {
    static constexpr ParameterType type = ParameterType::text;
    using Stored = std::string;
};
template <>
struct Member<std::filesystem::path> {
    static constexpr ParameterType type = ParameterType::path;
    using Stored = std::string;
};
template <>
struct Member<Length> {
    static constexpr ParameterType type = ParameterType::length;
    using Stored = Length;
};
template <>
struct Member<Angle> {
    static constexpr ParameterType type = ParameterType::angle;
    using Stored = Angle;
};
template <>
struct Member<Ratio> {
    static constexpr ParameterType type = ParameterType::ratio;
    using Stored = Ratio;
};

/// Between a member of the params struct and the ParameterValue that stands for it.
template <class T>
struct Convert {
    static void describe(ParameterSpec& spec, const T& value) {
        spec.type = Member<T>::type;
        spec.default_value = ParameterScalar(typename Member<T>::Stored(value));
    }
    static T from(const ParameterScalar& value) {
        const auto& stored = std::get<typename Member<T>::Stored>(value);
        if constexpr (Member<T>::type == ParameterType::integer)
            if (!std::in_range<T>(stored))
                throw Error("{} is out of range; expected a whole number from {} to {}", stored,
                            std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
        return static_cast<T>(stored);
    }
    static T from(const ParameterValue& value) { return from(std::get<ParameterScalar>(value)); }
};
template <>
inline void Convert<std::filesystem::path>::describe(ParameterSpec& spec, const std::filesystem::path& value) {
    spec.type = ParameterType::path;
    spec.default_value = ParameterScalar(value.string());
}
template <class T>
struct Convert<std::vector<T>> {
    static void describe(ParameterSpec& spec, const std::vector<T>& values) {
        spec.type = Member<T>::type;
        spec.list = true;
        std::vector<ParameterScalar> items;
        for (const T& value : values) items.emplace_back(typename Member<T>::Stored(value));
        spec.default_value = std::move(items);
    }
    static std::vector<T> from(const ParameterValue& value) {
        std::vector<T> values;
        for (const ParameterScalar& item : std::get<std::vector<ParameterScalar>>(value))
            values.push_back(Convert<T>::from(item));
        return values;
    }
};
template <class T>
struct Convert<std::optional<T>> {
    static void describe(ParameterSpec& spec, const std::optional<T>& value) {
        Convert<T>::describe(spec, value.value_or(T{}));
        if (!value) spec.default_value = std::monostate{};
    }
    static std::optional<T> from(const ParameterValue& value) {
        if (std::holds_alternative<std::monostate>(value)) return std::nullopt;
        if (const auto* one = std::get_if<ParameterScalar>(&value); one && std::holds_alternative<Word>(*one))
            return std::nullopt;
        return Convert<T>::from(value);
    }
};

}  // namespace detail

template <class Params>
class Declare {
public:
    Declare(std::string name, int version) {
        declaration_.spec.name = std::move(name);
        declaration_.spec.version = version;
    }

    Declare& summary(std::string text) {
        declaration_.spec.summary = std::move(text);
        return *this;
    }
    Declare& source(std::string text) {
        declaration_.spec.source = std::move(text);
        return *this;
    }
    template <class T, std::same_as<PortOption>... Options>
    Declare& in(std::string port, std::string help, Options... options) {
        declaration_.spec.inputs.push_back({std::move(port), kind_of<T>(), std::move(help),
                                            ((options == PortOption::list) || ...),
                                            ((options == PortOption::optional) || ...)});
        return *this;
    }
    /// The first output is the primary one.
    template <class T>
    Declare& out(std::string port, std::string help) {
        declaration_.spec.outputs.push_back({std::move(port), kind_of<T>(), std::move(help), false, false});
        return *this;
    }
    template <class T, class... Constraints>
    Declare& param(std::string name, T Params::*member, std::string help, const Constraints&... constraints) {
        ParameterSpec spec;
        detail::Convert<T>::describe(spec, Params{}.*member);
        (constraints.apply(spec), ...);
        bind(std::move(spec), std::move(name), std::move(help), [member](Params& params, const ParameterValue& value) {
            params.*member = detail::Convert<T>::from(value);
        });
        return *this;
    }
    template <class Enum>
    Declare& choice(std::string name, Enum Params::*member,
                    std::vector<Alternative<std::type_identity_t<Enum>>> alternatives, std::string help) {
        ParameterSpec spec;
        spec.type = ParameterType::choice;
        for (const auto& alternative : alternatives) {
            spec.choices.push_back({alternative.name, alternative.help});
            if (alternative.value == Params{}.*member) spec.default_value = ParameterScalar(alternative.name);
        }
        bind(std::move(spec), std::move(name), std::move(help),
             [member, alternatives](Params& params, const ParameterValue& value) {
                 const auto& chosen = std::get<std::string>(std::get<ParameterScalar>(value));
                 for (const auto& alternative : alternatives)
                     if (alternative.name == chosen) params.*member = alternative.value;
             });
        return *this;
    }
    Declare& metric(std::string name, Unit unit, std::string help, MetricOption option = MetricOption::plain) {
        declaration_.spec.metrics.push_back({std::move(name), unit, std::move(help), option == MetricOption::headline});
        return *this;
    }
    /// `body(inputs, params, context)` returns Outputs.
    template <class Body>
        requires std::is_invocable_r_v<Outputs, Body, const Inputs&, const Params&, Context&>
    Declare& run(Body body) {
        declaration_.run = [setters = setters_, body](const Inputs& inputs, const ParameterSet& values,
                                                      Context& context) {
            Params params;
            for (const auto& [name, set] : setters)
                if (const ParameterValue* value = values.find(name)) set(params, *value);
            return body(inputs, params, context);
        };
        return *this;
    }
    operator FilterDeclaration() const { return declaration_; }

private:
    using Setter = std::function<void(Params&, const ParameterValue&)>;

    void bind(ParameterSpec spec, std::string name, std::string help, Setter setter) {
        spec.name = name;
        spec.help = std::move(help);
        declaration_.spec.parameters.push_back(std::move(spec));
        setters_.emplace_back(std::move(name), std::move(setter));
    }

    FilterDeclaration declaration_;
    std::vector<std::pair<std::string, Setter>> setters_;
};

}  // namespace scanmill
