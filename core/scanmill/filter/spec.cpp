// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/filter/spec.hpp"

#include <algorithm>
#include <cctype>
#include <set>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

template <class Item>
const Item* find_named(const std::vector<Item>& items, std::string_view name) {
    const auto found = std::ranges::find(items, name, &Item::name);
    return found == items.end() ? nullptr : &*found;
}

bool is_name(std::string_view name) {
    const auto plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '-'; };
    return !name.empty() && name.front() >= 'a' && name.front() <= 'z' && name.back() != '-' &&
           std::ranges::all_of(name, plain);
}

/// The letters and digits of `words` in lower case.
std::string letters(std::string_view words) {
    std::string kept;
    for (const unsigned char c : words)
        if (std::isalnum(c)) kept += static_cast<char>(std::tolower(c));
    return kept;
}

void require_sentence(std::string_view filter, std::string_view what, std::string_view name, std::string_view help) {
    if (help.size() < 8 || help.back() != '.' || help.find(' ') == std::string_view::npos)
        throw Error("filter {}: the help of {} '{}' is not a sentence: '{}'", filter, what, name, help);
    if (letters(help) == letters(name))
        throw Error("filter {}: the help of {} '{}' only repeats the name: '{}'", filter, what, name, help);
}

template <class Items>
void require_names(std::string_view filter, std::string_view what, const Items& items) {
    std::set<std::string_view> names;
    for (const auto& item : items) {
        if (!is_name(item.name))
            throw Error("filter {}: {} '{}' is not lower-case-with-hyphens", filter, what, item.name);
        if (!names.insert(item.name).second)
            throw Error("filter {}: {} '{}' is declared twice", filter, what, item.name);
        require_sentence(filter, what, item.name, item.help);
        if (item.name.find("neighbours") != std::string::npos && item.help.find("itself") == std::string::npos)
            throw Error("filter {}: the help of {} '{}' does not state whether the point itself is counted: '{}'",
                        filter, what, item.name, item.help);
    }
}

/// Throws Error unless the filter's remark on `subject` is a sentence.
void require_remark(std::string_view filter, std::string_view subject, std::string_view remark) {
    if (remark.empty()) throw Error("filter {}: the remark on {} is missing", filter, subject);
    require_sentence(filter, "remark on", subject, remark);
}

void require_sound_parameter(const FilterSpec& spec, const ParameterSpec& parameter) {
    const std::string_view filter = spec.name;
    if (!parameter.unless_given.empty() && !spec.parameter(parameter.unless_given))
        throw Error("filter {}: parameter '{}' is used unless '{}' is given, which is not a parameter", filter,
                    parameter.name, parameter.unless_given);
    if (parameter.takes_spacings && (parameter.list || parameter.type != ParameterType::length))
        throw Error("filter {}: parameter '{}' takes spacings, but is not a single length", filter, parameter.name);
    if (parameter.type == ParameterType::choice && parameter.choices.size() < 2)
        throw Error("filter {}: parameter '{}' has fewer than two choices", filter, parameter.name);
    std::set<std::string_view> names;
    for (const Choice& choice : parameter.choices) {
        require_sentence(filter, fmt::format("choice of '{}':", parameter.name), choice.name, choice.help);
        if (!names.insert(choice.name).second)
            throw Error("filter {}: parameter '{}' has the choice '{}' twice", filter, parameter.name, choice.name);
    }
    const bool has_default = !std::holds_alternative<std::monostate>(parameter.default_value);
    if (parameter.type == ParameterType::choice && !has_default && !parameter.required)
        throw Error("filter {}: the default of '{}' is none of its choices", filter, parameter.name);
    if (!has_default) return;
    try {
        parse(parameter, written(parameter.default_value));
    } catch (Error& error) {
        throw Error("filter {}: the default of '{}': {}", filter, parameter.name, error.sentence());
    }
}

void require_sound_stream(const FilterSpec& spec) {
    const auto is_required = [](const PortSpec& port) { return !port.optional; };
    if (std::ranges::count_if(spec.inputs, is_required) != 1 || !is_required(spec.inputs.front()) ||
        spec.inputs.front().kind != kind_of<PointCloud>() || spec.inputs.front().list ||
        !spec.inputs.front().also.empty())
        throw Error(
            "filter {}: cannot be streamed; its first input must be a cloud of points and its only required input",
            spec.name);
    for (const std::string& name : spec.streams->given) {
        const ParameterSpec* parameter = spec.parameter(name);
        if (!parameter) throw Error("filter {}: its stream needs '{}', which is not a parameter", spec.name, name);
        if (parameter->required ||
            (parameter->word.empty() && !std::holds_alternative<std::monostate>(parameter->default_value)))
            throw Error("filter {}: its stream needs '{}', which always has a value", spec.name, name);
    }
}

void require_sound_measure(const FilterSpec& spec) {
    for (const std::string& name : {spec.measures->value, spec.measures->truth})
        if (const PortSpec* input = spec.input(name); !input || input->optional || input->list)
            throw Error("filter {}: it measures with '{}', which must be a required input of one value", spec.name,
                        name);
    const auto& [value, truth, deviation, column] = *spec.measures;
    if (deviation.empty() && column.empty()) return;
    if (const PortSpec* output = spec.output(deviation); !output || output->kind != kind_of<TriangleMesh>())
        throw Error("filter {}: its deviation is '{}', which must be an output that is a mesh", spec.name, deviation);
    if (std::ranges::find(spec.adds, column) == spec.adds.end())
        throw Error("filter {}: the deviation is in the column '{}', which must be one that the filter adds", spec.name,
                    column);
}

/// Throws Error unless `name` is empty or a parameter of this type. `size`: of a list; 0: one value.
void require_parameter(const FilterSpec& spec, const std::string& name, ParameterType type, std::size_t size = 0) {
    if (name.empty()) return;
    const ParameterSpec* parameter = spec.parameter(name);
    if (!parameter || parameter->type != type || parameter->list != (size > 0) || parameter->size.value_or(0) != size)
        throw Error("filter {}: '{}' must be a parameter that takes {}", spec.name, name,
                    size > 0 ? fmt::format("{} values of type {}", size, name_of(type))
                             : fmt::format("a value of type {}", name_of(type)));
}

void require_sound_inspection(const FilterSpec& spec) {
    const InspectSpec& inspects = *spec.inspects;
    const auto require = [&](bool is_sound, const std::string& name, const char* what) {
        if (!is_sound) throw Error("filter {}: it inspects with '{}', which must be {}", spec.name, name, what);
    };
    for (const std::string& name : {inspects.part, inspects.nominal}) {
        const PortSpec* port = spec.input(name);
        require(port && !port->optional && !port->list, name, "a required input of one value");
    }
    for (const std::string& name : inspects.outputs) require(spec.output(name), name, "an output");
    require(std::ranges::find(spec.adds, inspects.column) != spec.adds.end(), inspects.column,
            "a column that the filter adds");
    const auto require_metrics = [&](const std::vector<std::string>& names, bool numbered) {
        for (const std::string& name : names) {
            const MetricSpec* metric = spec.metric(name);
            require(metric && metric->numbered == numbered, name, numbered ? "a numbered metric" : "a metric");
        }
    };
    require_metrics(inspects.tolerance, false);
    require_metrics(inspects.range, false);
    require_metrics({inspects.histogram}, true);
    require_metrics(inspects.label, true);
    require_metrics(inspects.numbers, true);
    if (inspects.tolerance.size() != 2 || inspects.range.size() != 2 || inspects.label.size() != 4)
        throw Error("filter {}: it inspects with {} limits, {} ends of the range and {} metrics of a label; expected "
                    "2, 2 and 4",
                    spec.name, inspects.tolerance.size(), inspects.range.size(), inspects.label.size());
}

void require_sound_drawing(const FilterSpec& spec) {
    const PortSpec* input = spec.input(spec.draws->value);
    if (!input || input->optional || input->list)
        throw Error("filter {}: it draws '{}', which must be a required input of one value", spec.name,
                    spec.draws->value);
    if (spec.outputs.front().kind != kind_of<Picture>())
        throw Error("filter {}: it draws '{}', so its first output must be a picture", spec.name, spec.draws->value);
    if (const std::string& camera = spec.draws->camera; !camera.empty())
        if (const PortSpec* port = spec.input(camera); !port || !port->optional || port->list)
            throw Error("filter {}: the camera is set by '{}', which must be an optional input of one value", spec.name,
                        camera);
    require_parameter(spec, spec.draws->size, ParameterType::integer, 2);
    require_parameter(spec, spec.draws->colour, ParameterType::text);
    require_parameter(spec, spec.draws->scale, ParameterType::length, 2);
    require_parameter(spec, spec.draws->tolerance, ParameterType::length, 2);
}

void require_sound_simplifying(const FilterSpec& spec) {
    const auto& [value, triangles, max_error] = *spec.simplifies;
    const PortSpec* input = spec.input(value);
    if (!input || input->optional || input->list || !input->takes(kind_of<TriangleMesh>()))
        throw Error("filter {}: it simplifies '{}', which must be a required input of one mesh", spec.name, value);
    if (spec.outputs.front().kind != kind_of<TriangleMesh>())
        throw Error("filter {}: it simplifies '{}', so its first output must be a mesh", spec.name, value);
    if (triangles.empty() || max_error.empty())
        throw Error("filter {}: it simplifies '{}', but does not name the parameters for it", spec.name, value);
    require_parameter(spec, triangles, ParameterType::integer);
    require_parameter(spec, max_error, ParameterType::length);
}

}  // namespace

const PortSpec* FilterSpec::input(std::string_view port) const { return find_named(inputs, port); }
const PortSpec* FilterSpec::output(std::string_view port) const { return find_named(outputs, port); }
const ParameterSpec* FilterSpec::parameter(std::string_view wanted) const { return find_named(parameters, wanted); }
const MetricSpec* FilterSpec::metric(std::string_view wanted) const {
    const std::size_t at = wanted.find('@');
    if (at == std::string_view::npos) return find_named(metrics, wanted);
    const MetricSpec* metric = find_named(metrics, wanted.substr(0, at));
    const std::string_view number = wanted.substr(at + 1);
    const bool is_number = !number.empty() && number != "1" && number.front() != '0' &&
                           number.find_first_not_of("0123456789") == std::string_view::npos;
    return metric && metric->numbered && is_number ? metric : nullptr;
}

std::string kinds_text(const PortSpec& port) {
    if (!port.like.empty()) return fmt::format("the kind of '{}'", port.like);
    std::string text(name_of(port.kind));
    for (const Kind kind : port.also) text.append(" or ").append(name_of(kind));
    return text;
}

void require_sound(const FilterSpec& spec) {
    if (!is_name(spec.name)) throw Error("filter '{}': the name is not lower-case-with-hyphens", spec.name);
    require_sentence(spec.name, "filter", spec.name, spec.summary);
    if (spec.version < 1) throw Error("filter {}: version {} is below 1", spec.name, spec.version);
    if (spec.source.empty()) throw Error("filter {}: no source is named", spec.name);
    if (spec.outputs.empty()) throw Error("filter {}: declares no output", spec.name);
    require_names(spec.name, "input", spec.inputs);
    require_names(spec.name, "output", spec.outputs);
    require_names(spec.name, "parameter", spec.parameters);
    require_names(spec.name, "metric", spec.metrics);
    for (const PortSpec& output : spec.outputs)
        if (const PortSpec* input = output.like.empty() ? nullptr : spec.input(output.like);
            !output.like.empty() && (!input || input->optional || input->kind != output.kind))
            throw Error("filter {}: the output '{}' has the kind of '{}', which must be a required input", spec.name,
                        output.name, output.like);
    if (!spec.inputs.empty()) require_remark(spec.name, "ties", spec.ties);
    const auto has_coordinates = [](const PortSpec& port) {
        return port.takes(kind_of<PointCloud>()) || port.takes(kind_of<TriangleMesh>());
    };
    if (std::ranges::any_of(spec.inputs, has_coordinates)) require_remark(spec.name, "NaN", spec.not_finite);
    for (const ParameterSpec& parameter : spec.parameters) require_sound_parameter(spec, parameter);
    if (spec.streams) require_sound_stream(spec);
    if (spec.measures) require_sound_measure(spec);
    if (spec.inspects) require_sound_inspection(spec);
    if (spec.draws) require_sound_drawing(spec);
    if (spec.simplifies) require_sound_simplifying(spec);
    for (const std::string& doubt : spec.doubts)
        if (doubt.empty() || doubt.ends_with('.'))
            throw Error("filter {}: the doubt '{}' is not a clause that can follow 'if'", spec.name, doubt);
}

}  // namespace scanmill
