// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a filter says of itself: name, ports, parameters, metrics. Pure data: help, validation, schema and pages all
/// derive from it, and it can be read from a manifest without loading the filter.

#include <algorithm>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "scanmill/filter/parameter.hpp"
#include "scanmill/kinds/value.hpp"

namespace scanmill {

struct PortSpec {
    std::string name;
    Kind kind = kind_of<PointCloud>();
    std::string help;
    bool list = false;      ///< takes any number of values; inputs only
    bool optional = false;  ///< may stay unwired; inputs only
    std::vector<Kind> also{};  ///< kinds that it takes as well; inputs only. Such a port is wired by `in` alone
    std::string like{};  ///< the input whose kind the value has; outputs only. `kind` is then that input's first
    std::string maker{};  ///< the filter that its value usually comes from; empty: any that gives the kind

    bool takes(Kind other) const { return kind == other || std::ranges::find(also, other) != also.end(); }
    bool operator==(const PortSpec&) const = default;
};

/// "mesh or points".
std::string kinds_text(const PortSpec& port);

struct MetricSpec {
    std::string name;
    Unit unit = Unit::number;
    std::string help;
    bool headline = false;  ///< worth a column in a run's summary
    bool numbered = false;  ///< told for each of several things: NAME of the first, NAME@2 of the second, …

    bool operator==(const MetricSpec&) const = default;
};

/// A filter that can take its one input as a stream: a scan file that is read piece by piece and never is in memory as
/// a whole.
struct StreamSpec {
    /// Parameters that must have a value for it, not be left out nor be their word.
    std::vector<std::string> given;

    bool operator==(const StreamSpec&) const = default;
};

struct FilterSpec {
    std::string name;
    int version = 1;  ///< grows when equal inputs and parameters give other bytes
    std::string summary;
    std::string source;
    std::string ties;  ///< what decides between equals, so that the result is one
    std::string not_finite;  ///< what becomes of NaN and infinite coordinates
    std::vector<PortSpec> inputs;
    std::vector<PortSpec> outputs;  ///< the first is the primary one: what the step alone means
    std::vector<ParameterSpec> parameters;
    std::vector<MetricSpec> metrics;
    std::optional<StreamSpec> streams;

    const PortSpec* input(std::string_view port) const;
    const PortSpec* output(std::string_view port) const;
    const ParameterSpec* parameter(std::string_view parameter) const;
    /// Also of the NAME@2 of a numbered one.
    const MetricSpec* metric(std::string_view metric) const;
    bool operator==(const FilterSpec&) const = default;
};

/// Throws Error when a declaration is unsound: names that repeat or are not lower-case-with-hyphens, help that is no
/// sentence or only repeats the name, a default outside its own range, no output; nothing said of ties by a filter with
/// inputs, or of NaN by one that takes points or meshes; a number of neighbours that leaves open whether the point
/// itself is one of them; a stream where the input is not one cloud of points, or that asks for parameters that are
/// not there or always have a value.
void require_sound(const FilterSpec& spec);

}  // namespace scanmill
