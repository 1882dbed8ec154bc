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
#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "scanmill/filter/constraint.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/filter/member.hpp"
#include "scanmill/filter/ports.hpp"
#include "scanmill/filter/spec.hpp"

namespace scanmill {

class PointStream;

/// A filter as the engine sees it.
struct FilterDeclaration {
    FilterSpec spec;
    /// Pre: every declared parameter has a value (resolved, in range) and every non-optional input is wired.
    std::function<Outputs(const Inputs&, const ParameterSet&, Context&)> run;
    /// The same for an input that comes as a stream. Pre: spec.streams; the parameters that it asks for have values.
    std::function<Outputs(const PointStream&, const ParameterSet&, Context&)> run_streamed;
};

/// Port options, none, one or both: `.in<TriangleMesh>("mesh", "…", optional)`, `.in<PointCloud>("points", "…", list)`.
/// A port that takes one kind or another: `.in<TriangleMesh, PointCloud>("truth", "…")`.
enum class PortOption { optional, list };
inline constexpr PortOption optional = PortOption::optional;
inline constexpr PortOption list = PortOption::list;

/// At the end of .metric(…), none, one or both: a column in a run's summary; told for each of several things.
enum class MetricOption { headline, numbered };
inline constexpr MetricOption headline = MetricOption::headline;
inline constexpr MetricOption numbered = MetricOption::numbered;

/// One alternative of a choice: its written name, the enumerator, what it does.
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

    Declare& summary(std::string text) {
        declaration_.spec.summary = std::move(text);
        return *this;
    }
    Declare& source(std::string text) {
        declaration_.spec.source = std::move(text);
        return *this;
    }
    /// What decides between equals: needed by every filter that takes something.
    Declare& ties(std::string text) {
        declaration_.spec.ties = std::move(text);
        return *this;
    }
    /// What becomes of NaN and infinite coordinates: needed by every filter that takes points or meshes.
    Declare& not_finite(std::string text) {
        declaration_.spec.not_finite = std::move(text);
        return *this;
    }
    template <class T, class... Others, std::same_as<PortOption>... Options>
    Declare& in(std::string port, std::string help, Options... options) {
        declaration_.spec.inputs.push_back({std::move(port),
                                            kind_of<T>(),
                                            std::move(help),
                                            ((options == PortOption::list) || ...),
                                            ((options == PortOption::optional) || ...),
                                            {kind_of<Others>()...}});
        return *this;
    }
    /// The filter that the value of the input declared last usually comes from: examples begin with it.
    Declare& made_by(std::string filter) {
        declaration_.spec.inputs.back().maker = std::move(filter);
        return *this;
    }
    /// The first output is the primary one.
    template <class T>
    Declare& out(std::string port, std::string help) {
        declaration_.spec.outputs.push_back({std::move(port), kind_of<T>(), std::move(help)});
        return *this;
    }
    /// An output of the kind of the value at the input `like`, which is declared before it.
    Declare& out_like(std::string port, std::string like, std::string help) {
        PortSpec spec{std::move(port), {}, std::move(help)};
        if (const PortSpec* input = declaration_.spec.input(like)) spec.kind = input->kind;
        spec.like = std::move(like);
        declaration_.spec.outputs.push_back(std::move(spec));
        return *this;
    }
    /// The member may be one that the params struct inherits.
    template <class T, class Owner, class... Constraints>
        requires std::derived_from<Params, Owner>
    Declare& param(std::string name, T Owner::*member, std::string help, const Constraints&... constraints) {
        ParameterSpec spec;
        detail::Convert<T>::describe(spec, Params{}.*member);
        (constraints.apply(spec), ...);
        bind(std::move(spec), std::move(name), std::move(help), [member](Params& params, const ParameterValue& value) {
            params.*member = detail::Convert<T>::from(value);
        });
        return *this;
    }
    template <class Enum, class Owner>
        requires std::derived_from<Params, Owner>
    Declare& choice(std::string name, Enum Owner::*member,
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
    template <std::same_as<MetricOption>... Options>
    Declare& metric(std::string name, Unit unit, std::string help, Options... options) {
        declaration_.spec.metrics.push_back({std::move(name), unit, std::move(help),
                                             ((options == MetricOption::headline) || ...),
                                             ((options == MetricOption::numbered) || ...)});
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
    /// `body(scan, params, context)` returns what run() would, byte for byte, of a scan file that is read piece by
    /// piece (scanmill/data/point_stream.hpp): called instead of run() when all parameters of `given` have a value,
    /// and nobody else needs the scan in memory. For filters with one input.
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

    void bind(ParameterSpec spec, std::string name, std::string help, Setter setter) {
        spec.name = name;
        spec.help = std::move(help);
        declaration_.spec.parameters.push_back(std::move(spec));
        setters_.emplace_back(std::move(name), std::move(setter));
    }

    FilterDeclaration declaration_;
    Setters setters_;
};

}  // namespace scanmill
