// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The declaration of a filter, in one expression (see filters/voxel_thin/plugin.cpp).
///
/// A parameter is bound to a field of the params struct: the field's type determines the parameter's type, its
/// initialiser the default. Constraints follow the help text, in any order:
///
///     .param("bin-size", &P::bin_size, "Edge of a voxel.", above(0), word("auto"))
///
/// Field types: bool, integers, double, std::string, std::filesystem::path, Length, Angle, Ratio, std::vector of these,
/// and std::optional of any of these for a parameter that may be omitted or replaced by its word. The field is then
/// nullopt.

#include <concepts>
#include <filesystem>
#include <functional>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/filter/ports.hpp"
#include "scanmill/filter/spec.hpp"

namespace scanmill {

class PointStream;

/// A filter as the engine uses it.
struct FilterDeclaration {
    FilterSpec spec;
    /// Pre: every declared parameter has a value (resolved, in range) and every non-optional input is wired.
    std::function<Outputs(const Inputs&, const ParameterSet&, Context&)> run;
    /// Runs the filter on a streamed input. Pre: spec.streams is set, and the parameters that it names have values.
    std::function<Outputs(const PointStream&, const ParameterSet&, Context&)> run_streamed;
};

/// Bounds of a parameter. Lengths are compared as written, regardless of their unit, so the bounds of a length should
/// be 0. Angles are compared in degrees, ratios as fractions.
inline auto bound(std::optional<Bound> ParameterSpec::*side, double value, bool inclusive) {
    return [=](ParameterSpec& spec) { spec.*side = Bound{value, inclusive}; };
}
inline auto above(double value) { return bound(&ParameterSpec::low, value, false); }
inline auto at_least(double value) { return bound(&ParameterSpec::low, value, true); }
inline auto below(double value) { return bound(&ParameterSpec::high, value, false); }
inline auto at_most(double value) { return bound(&ParameterSpec::high, value, true); }
/// A word that is accepted in place of a value. The word is also the default. Pre: the field is a std::optional, empty
/// by default.
inline auto word(std::string text) {
    return [text = std::move(text)](ParameterSpec& spec) {
        spec.word = text;
        spec.default_value = ParameterScalar(Word{text});
    };
}
/// There is no sensible default: the workflow must contain a value.
inline constexpr auto required = [](ParameterSpec& spec) {
    spec.required = true;
    spec.default_value = std::monostate{};
};
/// If the parameter `other` is given, the default of this parameter is not used. Its relative lengths then need no
/// scan.
inline auto unless_given(std::string other) {
    return [other = std::move(other)](ParameterSpec& spec) { spec.unless_given = other; };
}
/// Lengths in `spacing` reach the filter as they are written; other lengths reach it resolved. For filters that compute
/// the spacing in any case.
inline constexpr auto takes_spacings = [](ParameterSpec& spec) { spec.takes_spacings = true; };
/// A list of exactly this many values.
inline auto size(std::size_t count) {
    return [count](ParameterSpec& spec) { spec.size = count; };
}

namespace detail {

/// The parameter type of a field of type T.
template <class T>
consteval ParameterType parameter_type_of() {
    using std::same_as;
    if constexpr (same_as<T, bool>) return ParameterType::boolean;
    if constexpr (std::integral<T> && !same_as<T, bool>) return ParameterType::integer;
    if constexpr (same_as<T, double>) return ParameterType::number;
    if constexpr (same_as<T, std::string>) return ParameterType::text;
    if constexpr (same_as<T, std::filesystem::path>) return ParameterType::path;
    if constexpr (same_as<T, Length>) return ParameterType::length;
    if constexpr (same_as<T, Angle>) return ParameterType::angle;
    if constexpr (same_as<T, Ratio>) return ParameterType::ratio;
}
/// The alternative of ParameterScalar that holds the value of a field of type T.
template <class T>
using Stored = std::conditional_t<parameter_type_of<T>() == ParameterType::integer, std::int64_t,
                                  std::conditional_t<std::same_as<T, std::filesystem::path>, std::string, T>>;

/// Sets type, list, bounds and default of the parameter for a field whose initial value is `field`.
template <class T>
void describe(ParameterSpec& spec, const T& field) {
    spec.type = parameter_type_of<T>();
    spec.default_value = ParameterScalar(Stored<T>(field));
    if constexpr (parameter_type_of<T>() == ParameterType::integer) {  // the range of the C++ type
        if (std::is_unsigned_v<T>) spec.low = Bound{0, true};
        if constexpr (sizeof(T) < sizeof(std::int64_t)) {
            spec.low = Bound{static_cast<double>(std::numeric_limits<T>::min()), true};
            spec.high = Bound{static_cast<double>(std::numeric_limits<T>::max()), true};
        }
    }
}
template <class T>
void describe(ParameterSpec& spec, const std::vector<T>& field) {
    describe(spec, T{});
    spec.list = true;
    std::vector<ParameterScalar> items;
    for (const T& item : field) items.emplace_back(Stored<T>(item));
    spec.default_value = std::move(items);
}
template <class T>
void describe(ParameterSpec& spec, const std::optional<T>& field) {
    describe(spec, field.value_or(T{}));
    if (!field) spec.default_value = std::monostate{};
}

/// Sets the field to a parameter's value.
template <class T>
void assign(T& field, const ParameterScalar& value) {
    const auto& stored = std::get<Stored<T>>(value);
    if constexpr (parameter_type_of<T>() == ParameterType::integer)  // a C++ caller may pass unchecked values
        if (!std::in_range<T>(stored))
            throw Error("{} is out of range; expected a whole number from {} to {}", stored,
                        std::numeric_limits<T>::min(), std::numeric_limits<T>::max());
    field = static_cast<T>(stored);
}
template <class T>
void assign(T& field, const ParameterValue& value) {
    assign(field, std::get<ParameterScalar>(value));
}
template <class T>
void assign(std::vector<T>& field, const ParameterValue& value) {
    field.clear();
    for (const ParameterScalar& item : std::get<std::vector<ParameterScalar>>(value)) {
        T converted;
        assign(converted, item);
        field.push_back(std::move(converted));
    }
}
template <class T>
void assign(std::optional<T>& field, const ParameterValue& value) {
    field.reset();
    const auto* one = std::get_if<ParameterScalar>(&value);
    if (std::holds_alternative<std::monostate>(value) || (one && std::holds_alternative<Word>(*one))) return;
    assign(field.emplace(), value);
}

}  // namespace detail

/// Options of a port, in any combination: `.in<TriangleMesh>("mesh", "…", optional)`, `.in<PointCloud>("points", "…",
/// list)`. A port that takes one kind or another: `.in<TriangleMesh, PointCloud>("truth", "…")`. Only `in` connects a
/// port that is by_name: an input to an earlier value, or a later step to an output. Outputs are neither optional nor
/// lists.
enum class PortOption { optional, list, by_name };
inline constexpr PortOption optional = PortOption::optional;
inline constexpr PortOption list = PortOption::list;
inline constexpr PortOption by_name = PortOption::by_name;

/// Options of a metric, in any combination. A headline is a column in a run's summary. A numbered metric is reported
/// once per item: NAME, NAME@2, … The last two options state which of two values is better.
enum class MetricOption { headline, numbered, larger_is_better, smaller_is_better };
inline constexpr MetricOption headline = MetricOption::headline;
inline constexpr MetricOption numbered = MetricOption::numbered;
inline constexpr MetricOption larger_is_better = MetricOption::larger_is_better;
inline constexpr MetricOption smaller_is_better = MetricOption::smaller_is_better;

/// One alternative of a choice: its written name, its enumerator and the description of its effect.
template <class Enum>
struct Alternative {
    std::string name;
    Enum value;
    std::string help;
};

template <class Params>
class Declare {
public:
    Declare(std::string name, int version) {
        declaration_.spec.name = std::move(name);
        declaration_.spec.version = version;
    }

    Declare& summary(std::string text) { return set(&FilterSpec::summary, std::move(text)); }
    Declare& source(std::string text) { return set(&FilterSpec::source, std::move(text)); }
    /// The rule for ties; required of every filter with inputs.
    Declare& ties(std::string text) { return set(&FilterSpec::ties, std::move(text)); }
    /// The handling of NaN and infinite coordinates; required of every filter that takes points or meshes.
    Declare& not_finite(std::string text) { return set(&FilterSpec::not_finite, std::move(text)); }
    template <class T, class... Others, std::same_as<PortOption>... Options>
    Declare& in(std::string port, std::string help, Options... options) {
        declaration_.spec.inputs.push_back({std::move(port),
                                            kind_of<T>(),
                                            std::move(help),
                                            ((options == PortOption::list) || ...),
                                            ((options == PortOption::optional) || ...),
                                            {kind_of<Others>()...}});
        declaration_.spec.inputs.back().by_name = ((options == PortOption::by_name) || ...);
        return *this;
    }
    /// Names the filter that usually produces the value of the last declared input. Examples start with this filter.
    Declare& made_by(std::string filter) {
        declaration_.spec.inputs.back().maker = std::move(filter);
        return *this;
    }
    /// The first output is the primary one.
    template <class T, std::same_as<PortOption>... Options>
    Declare& out(std::string port, std::string help, Options... options) {
        declaration_.spec.outputs.push_back({std::move(port), kind_of<T>(), std::move(help)});
        declaration_.spec.outputs.back().by_name = ((options == PortOption::by_name) || ...);
        return *this;
    }
    /// Declares an output that has the kind of the value at the input `like`. Pre: this input is already declared.
    template <std::same_as<PortOption>... Options>
    Declare& out_like(std::string port, std::string like, std::string help, Options... options) {
        PortSpec spec{std::move(port), {}, std::move(help)};
        if (const PortSpec* input = declaration_.spec.input(like)) spec.kind = input->kind;
        spec.like = std::move(like);
        spec.by_name = ((options == PortOption::by_name) || ...);
        declaration_.spec.outputs.push_back(std::move(spec));
        return *this;
    }
    /// The names of the columns that the filter may add to its outputs.
    Declare& adds(std::vector<std::string> columns) {
        declaration_.spec.adds = std::move(columns);
        return *this;
    }
    /// When the filter doubts its result, each as a clause that can follow "if". A filter that calls Context::doubt()
    /// declares when.
    Declare& doubts(std::vector<std::string> clauses) {
        declaration_.spec.doubts = std::move(clauses);
        return *this;
    }
    /// The field may be inherited.
    template <class T, class Owner, class... Constraints>
        requires std::derived_from<Params, Owner>
    Declare& param(std::string name, T Owner::*field, std::string help, const Constraints&... constraints) {
        ParameterSpec& spec = add_parameter(std::move(name), std::move(help));
        detail::describe(spec, Params{}.*field);
        (constraints(spec), ...);
        setters_.emplace_back(
            spec.name, [field](Params& params, const ParameterValue& value) { detail::assign(params.*field, value); });
        return *this;
    }
    template <class Enum, class Owner>
        requires std::derived_from<Params, Owner>
    Declare& choice(std::string name, Enum Owner::*field,
                    std::vector<Alternative<std::type_identity_t<Enum>>> alternatives, std::string help) {
        ParameterSpec& spec = add_parameter(std::move(name), std::move(help));
        spec.type = ParameterType::choice;
        for (const auto& alternative : alternatives) {
            spec.choices.push_back({alternative.name, alternative.help});
            if (alternative.value == Params{}.*field) spec.default_value = ParameterScalar(alternative.name);
        }
        setters_.emplace_back(spec.name, [field, alternatives](Params& params, const ParameterValue& value) {
            const auto& chosen = std::get<std::string>(std::get<ParameterScalar>(value));
            for (const auto& alternative : alternatives)
                if (alternative.name == chosen) params.*field = alternative.value;
        });
        return *this;
    }
    /// A list of choices.
    template <class Enum, class Owner>
        requires std::derived_from<Params, Owner>
    Declare& choices(std::string name, std::vector<Enum> Owner::*field,
                     std::vector<Alternative<std::type_identity_t<Enum>>> alternatives, std::string help) {
        ParameterSpec& spec = add_parameter(std::move(name), std::move(help));
        spec.type = ParameterType::choice;
        spec.list = true;
        std::vector<ParameterScalar> defaults;
        const Params params{};  // named, because a temporary would end before the loop
        for (const Enum value : params.*field)
            for (const auto& alternative : alternatives)
                if (alternative.value == value) defaults.emplace_back(alternative.name);
        spec.default_value = std::move(defaults);
        for (const auto& alternative : alternatives) spec.choices.push_back({alternative.name, alternative.help});
        setters_.emplace_back(spec.name, [field, alternatives](Params& target, const ParameterValue& value) {
            (target.*field).clear();
            for (const ParameterScalar& item : std::get<std::vector<ParameterScalar>>(value))
                for (const auto& alternative : alternatives)
                    if (alternative.name == std::get<std::string>(item)) (target.*field).push_back(alternative.value);
        });
        return *this;
    }
    template <std::same_as<MetricOption>... Options>
    Declare& metric(std::string name, Unit unit, std::string help, Options... options) {
        const auto has = [&]([[maybe_unused]] MetricOption wanted) { return ((options == wanted) || ...); };
        declaration_.spec.metrics.push_back({std::move(name), unit, std::move(help), has(headline), has(numbered),
                                             has(larger_is_better)    ? Better::larger
                                             : has(smaller_is_better) ? Better::smaller
                                                                      : Better::neither});
        return *this;
    }
    /// Declares that the filter compares the value at one input with the truth at another input. A batch applies such a
    /// filter to its results.
    Declare& measures(std::string value, std::string truth) {
        return measures(MeasureSpec{std::move(value), std::move(truth)});
    }
    /// The same for a filter that also gives the mesh with its deviation.
    Declare& measures(MeasureSpec spec) {
        declaration_.spec.measures = std::move(spec);
        return *this;
    }
    /// Declares that the filter compares a part with its nominal and gives a verdict.
    Declare& inspects(InspectSpec spec) {
        declaration_.spec.inspects = std::move(spec);
        return *this;
    }
    /// Declares that the filter draws the value at this input; its first output is the picture. A step without `in`
    /// draws the last geometric value before it.
    Declare& draws(std::string value) { return draws(DrawSpec{std::move(value)}); }
    /// The same for a filter whose pictures can have a given camera, size or colours.
    Declare& draws(DrawSpec spec) {
        declaration_.spec.draws = std::move(spec);
        return *this;
    }
    /// Declares that the filter makes a mesh of fewer triangles from the mesh at one input. Reports show such meshes.
    Declare& simplifies(SimplifySpec spec) {
        declaration_.spec.simplifies = std::move(spec);
        return *this;
    }
    /// `body(inputs, params, context)` returns Outputs.
    template <class Body>
        requires std::is_invocable_r_v<Outputs, Body, const Inputs&, const Params&, Context&>
    Declare& run(Body body) {
        declaration_.run = [setters = setters_, body](const Inputs& inputs, const ParameterSet& values,
                                                      Context& context) {
            return body(inputs, filled(setters, values), context);
        };
        return *this;
    }
    /// `body(scan, params, context)` returns the same bytes as run(), from a scan file that is read piece by piece
    /// (scanmill/data/point_stream.hpp). Called instead of run() if all parameters in `given` have a value and no other
    /// step needs the scan in memory. For filters whose first input is a cloud of points; other inputs must be
    /// optional, and run() is called if one of them is wired.
    template <class Body>
        requires std::is_invocable_r_v<Outputs, Body, const PointStream&, const Params&, Context&>
    Declare& run_streamed(std::vector<std::string> given, Body body) {
        declaration_.spec.streams = StreamSpec{std::move(given)};
        declaration_.run_streamed = [setters = setters_, body](const PointStream& scan, const ParameterSet& values,
                                                               Context& context) {
            return body(scan, filled(setters, values), context);
        };
        return *this;
    }
    operator FilterDeclaration() const { return declaration_; }

private:
    using Setter = std::function<void(Params&, const ParameterValue&)>;
    using Setters = std::vector<std::pair<std::string, Setter>>;

    static Params filled(const Setters& setters, const ParameterSet& values) {
        Params params;
        for (const auto& [name, set] : setters)
            if (const ParameterValue* value = values.find(name)) set(params, *value);
        return params;
    }

    Declare& set(std::string FilterSpec::*remark, std::string text) {
        declaration_.spec.*remark = std::move(text);
        return *this;
    }

    ParameterSpec& add_parameter(std::string name, std::string help) {
        ParameterSpec& spec = declaration_.spec.parameters.emplace_back();
        spec.name = std::move(name);
        spec.help = std::move(help);
        return spec;
    }

    FilterDeclaration declaration_;
    Setters setters_;
};

}  // namespace scanmill
