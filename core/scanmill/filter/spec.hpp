// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The declaration of a filter as data: name, ports, parameters, metrics. Help, validation, schema and pages derive
/// from this declaration. It can be read from a manifest without loading the filter.

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
    bool list = false;      ///< any number of values; inputs only
    bool optional = false;  ///< need not be wired; inputs only
    std::vector<Kind> also{};  ///< other accepted kinds; inputs only. Only `in` can wire a port that has some
    /// The input that determines the value's kind; outputs only. `kind` is the first kind of this input.
    std::string like{};
    std::string maker{};  ///< the filter that usually produces the value; empty if no filter is typical
    bool by_name = false;  ///< only `in` connects it: an input to a value, or a later step to an output

    bool takes(Kind other) const { return kind == other || std::ranges::find(also, other) != also.end(); }
    bool operator==(const PortSpec&) const = default;
};
constexpr auto fields(const PortSpec*) {
    using T = PortSpec;
    return std::tuple{
        field("name", &T::name),
        field("kind", &T::kind),
        field("help", &T::help),
        field("list", &T::list, "The port takes any number of values.").optional(),
        field("optional", &T::optional).optional(),
        field("also", &T::also, "Other kinds that the port takes.").optional(),
        field("like", &T::like, "The input whose kind the output has.").optional(),
        field("maker", &T::maker, "The filter that usually makes the value.").optional(),
        field("by-name", &T::by_name, "Only `in` connects the port: an input to a value, or a later step to an output.")
            .optional()};
}

/// "mesh or points".
std::string kinds_text(const PortSpec& port);

struct MetricSpec {
    std::string name;
    Unit unit = Unit::number;
    std::string help;
    bool headline = false;  ///< worth a column in a run's summary
    bool numbered = false;  ///< reported once per item: NAME of the first, NAME@2 of the second, …
    Better better = Better::neither;

    bool operator==(const MetricSpec&) const = default;
};
constexpr auto fields(const MetricSpec*) {
    using T = MetricSpec;
    return std::tuple{field("name", &T::name),
                      field("unit", &T::unit),
                      field("help", &T::help),
                      field("headline", &T::headline).optional(),
                      field("numbered", &T::numbered, "Reported once per item: NAME, NAME@2, …").optional(),
                      field("better", &T::better).optional()};
}

/// For filters that can stream their first input if no other input is wired. The scan file is then read piece by piece
/// and never in memory as a whole.
struct StreamSpec {
    /// Parameters that must have a value, which means that they are neither omitted nor replaced by their word.
    std::vector<std::string> given;

    bool operator==(const StreamSpec&) const = default;
};
constexpr auto fields(const StreamSpec*) { return std::tuple{field("given", &StreamSpec::given)}; }

/// For filters that compare a value with its truth: the names of these two inputs.
struct MeasureSpec {
    std::string value, truth;
    /// The output that is the mesh with its deviation, and the vertex column of that mesh with the signed distance from
    /// the truth. Both are empty for filters that give only numbers.
    std::string deviation{}, column{};

    bool operator==(const MeasureSpec&) const = default;
};
constexpr auto fields(const MeasureSpec*) {
    using T = MeasureSpec;
    return std::tuple{
        field("value", &T::value), field("truth", &T::truth),
        field("deviation", &T::deviation, "The output that is the mesh with its deviation from the truth.").optional(),
        field("column", &T::column, "The vertex column of this output with the signed distance.").optional()};
}

/// For filters that compare a part with its nominal and give a verdict. Metrics of the whole nominal and of its parts are
/// numbered: NAME is of the whole, NAME@2 … of the parts.
struct InspectSpec {
    std::string part, nominal;  ///< names of inputs
    std::vector<std::string> outputs;  ///< outputs with the deviation in `column`, the best to look at first
    std::string column;
    std::vector<std::string> tolerance;  ///< metrics: lowest and highest deviation in tolerance
    std::vector<std::string> range;  ///< metrics: both ends of the histogram and of the colours
    std::string histogram;  ///< numbered metric: the shares in equal bins
    std::vector<std::string> label;  ///< numbered metrics: the largest deviations, and x, y and z of their points
    std::vector<std::string> numbers;  ///< numbered metrics to show for each part, in this order

    bool operator==(const InspectSpec&) const = default;
};
constexpr auto fields(const InspectSpec*) {
    using T = InspectSpec;
    return std::tuple{field("part", &T::part),
                      field("nominal", &T::nominal),
                      field("outputs", &T::outputs, "Outputs with the deviation, the best to look at first."),
                      field("column", &T::column, "The column of these outputs with the deviation."),
                      field("tolerance", &T::tolerance, "Metrics: lowest and highest deviation in tolerance."),
                      field("range", &T::range, "Metrics: both ends of the histogram and of the colours."),
                      field("histogram", &T::histogram, "Numbered metric: the shares in equal bins."),
                      field("label", &T::label, "Numbered metrics: the largest deviations, and x, y, z of their points."),
                      field("numbers", &T::numbers, "Numbered metrics to show for each part.")};
}

/// For filters that draw a value: the name of this input. The first output is the picture. The other members are empty
/// if the filter has no such input or parameter.
struct DrawSpec {
    std::string value;
    std::string camera{};  ///< the input that sets the camera instead of the value
    std::string size{};  ///< the parameter with the columns and rows of the picture
    std::string colour{};  ///< the parameter that names the column that colours the value
    std::string scale{};  ///< the parameter with the values at both ends of the colours
    std::string tolerance{};  ///< the parameter with the two limits that the colours show

    bool operator==(const DrawSpec&) const = default;
};
constexpr auto fields(const DrawSpec*) {
    using T = DrawSpec;
    return std::tuple{
        field("value", &T::value),
        field("camera", &T::camera, "The input that sets the camera instead of the value.").optional(),
        field("size", &T::size, "The parameter with the columns and rows of the picture.").optional(),
        field("colour", &T::colour, "The parameter that names the column that colours the value.").optional(),
        field("scale", &T::scale, "The parameter with the values at both ends of the colours.").optional(),
        field("tolerance", &T::tolerance, "The parameter with the two limits that the colours show.").optional()};
}

/// For filters that make a mesh of fewer triangles: the name of the input, the parameter with the number of triangles
/// to reach, and the parameter with the largest distance from the input. The first output is the mesh.
struct SimplifySpec {
    std::string value, triangles, max_error;

    bool operator==(const SimplifySpec&) const = default;
};
constexpr auto fields(const SimplifySpec*) {
    using T = SimplifySpec;
    return std::tuple{field("value", &T::value),
                      field("triangles", &T::triangles, "The parameter with the number of triangles."),
                      field("max-error", &T::max_error, "The parameter with the largest distance from the input.")};
}

struct FilterSpec {
    std::string name;
    int version = 1;  ///< increases if equal inputs and parameters produce other bytes
    std::string summary;
    std::string source;
    std::string ties;  ///< the rule for ties
    std::string not_finite;  ///< the handling of NaN and infinite coordinates
    std::vector<PortSpec> inputs;
    std::vector<PortSpec> outputs;  ///< the step's name alone refers to the first, the primary output
    std::vector<ParameterSpec> parameters;
    std::vector<MetricSpec> metrics;
    std::optional<StreamSpec> streams;
    std::optional<MeasureSpec> measures;
    std::optional<InspectSpec> inspects;
    std::optional<DrawSpec> draws;
    std::optional<SimplifySpec> simplifies;
    /// Names of columns that the filter may add to its outputs. Formats that cannot hold these columns leave them out
    /// without a warning.
    std::vector<std::string> adds;
    /// When the filter doubts its result, each as a clause: "more than 5 % of the surface is filled".
    std::vector<std::string> doubts;

    const PortSpec* input(std::string_view port) const;
    const PortSpec* output(std::string_view port) const;
    const ParameterSpec* parameter(std::string_view parameter) const;
    /// Also finds NAME@2 of a numbered metric.
    const MetricSpec* metric(std::string_view metric) const;
    bool operator==(const FilterSpec&) const = default;
};
constexpr auto fields(const FilterSpec*) {
    using T = FilterSpec;
    return std::tuple{
        field("name", &T::name),
        field("version", &T::version),
        field("summary", &T::summary),
        field("source", &T::source),
        field("ties", &T::ties),
        field("not-finite", &T::not_finite),
        field("inputs", &T::inputs),
        field("outputs", &T::outputs),
        field("parameters", &T::parameters),
        field("metrics", &T::metrics),
        field("streams", &T::streams, "The filter can read its first input as a stream.").optional(),
        field("measures", &T::measures, "The filter compares the value at one input with the truth at another.")
            .optional(),
        field("inspects", &T::inspects, "The filter compares a part with its nominal and gives a verdict.").optional(),
        field("draws", &T::draws, "The filter draws the value at this input.").optional(),
        field("simplifies", &T::simplifies, "The filter makes a mesh of fewer triangles from the mesh at this input.")
            .optional(),
        field("adds", &T::adds, "Columns that the filter may add to its outputs.").optional(),
        field("doubts", &T::doubts, "When the filter doubts its result, each as a clause.").optional()};
}

/// Throws Error for an unsound declaration:
/// - A name is not lower-case-with-hyphens, or two names are equal.
/// - A help text is not a sentence or only repeats the name. The help of a number of neighbours does not state whether
///   the point itself is counted.
/// - A default is outside its range.
/// - There is no output.
/// - The remark on ties (filters with inputs) or on NaN (filters that take points or meshes) is missing.
/// - The filter can be streamed, but its first input is not one cloud of points, or another input is required.
/// - The stream needs a parameter that does not exist or that always has a value.
/// - The filter compares a value with a truth, but lacks one of these two inputs. Its deviation is not an output that
///   is a mesh, or lacks a column among those that the filter adds.
/// - The filter inspects a part, but lacks one of these inputs, outputs and metrics, or a column among those that it
///   adds. Tolerance and range are not two metrics, or the label is not four. A metric of a part is not numbered.
/// - The filter draws a value, but lacks this input, or its first output is not a picture. The camera is not an
///   optional input, or a parameter has another type.
/// - The filter simplifies a mesh, but lacks this input or one of the two parameters, or its first output is not a
///   mesh.
/// - A doubt is empty or ends with a full stop: pages write it after "if".
void require_sound(const FilterSpec& spec);

}  // namespace scanmill
