// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/plan/step_parameters.hpp"

#include <fmt/format.h>
#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

template <class Change>
ParameterValue with_each_path(ParameterValue value, const Change& change) {
    const auto apply = [&](ParameterScalar& item) {
        if (auto* path = std::get_if<std::string>(&item); path && !path->empty()) *path = change(*path);
    };
    if (auto* one = std::get_if<ParameterScalar>(&value)) apply(*one);
    if (auto* list = std::get_if<std::vector<ParameterScalar>>(&value))
        for (ParameterScalar& item : *list) apply(item);
    return value;
}

}  // namespace

ParameterValue with_paths_from(const std::filesystem::path& folder, const ParameterValue& value) {
    return with_each_path(value, [&](const std::filesystem::path& path) {
        return path.is_relative() ? (folder / path).lexically_normal().string() : path.string();
    });
}

std::string key_text_of_paths(const ParameterValue& value,
                              const std::function<std::string(const std::filesystem::path&)>& content_of) {
    return canonical_text(with_each_path(
        value, [&](const std::filesystem::path& path) { return path.extension().string() + " " + content_of(path); }));
}

bool names_files(const FilterSpec& spec, std::string_view parameter) {
    return spec.parameter(parameter)->type == ParameterType::path;
}

namespace {

class Reader {
public:
    explicit Reader(const ParameterSources& sources) : sources_(sources) {}

    ParameterSet parameters(const ExpandedStep& step, const FilterSpec& spec) {
        for (const NamedExpression& written : step.syntax->parameters)
            if (!spec.parameter(written.name))
                sources_.diagnostics.error(written.position, "{} has no parameter '{}'; {}", spec.name, written.name,
                                           it_has(spec.parameters, written.name));
        ParameterSet set;
        for (const ParameterSpec& parameter : spec.parameters)
            set.values.emplace_back(parameter.name, parameter_value(step, parameter));
        return set;
    }

private:
    ParameterValue parameter_value(const ExpandedStep& step, const ParameterSpec& parameter) {
        const auto argument = std::ranges::find(step.arguments, parameter.name,
                                                [](const ChosenArgument& given) { return given.parameter->name; });
        if (argument == step.arguments.end()) {
            const bool attempted = std::ranges::find(step.syntax->parameters, parameter.name, &NamedExpression::name) !=
                                   step.syntax->parameters.end();  // its value could not be read
            if (parameter.required && !attempted)
                sources_.diagnostics.error(step.syntax->position, "{} needs the parameter '{}': {}",
                                           step.syntax->filter, parameter.name, expectation(parameter));
            return parameter.default_value;
        }
        try {
            return with_folders(*argument, parameter, parse(parameter, argument->value));
        } catch (const Error& error) {
            report_value(*argument, parameter, step.syntax->filter, error.sentence());
            return parameter.default_value;
        }
    }

    /// Puts the folder of the file that contains a relative path before the path.
    ParameterValue with_folders(const ChosenArgument& argument, const ParameterSpec& parameter, ParameterValue value) {
        if (parameter.type != ParameterType::path) return value;
        const auto with_folder = [&](const ParameterScalar& path, std::size_t item) -> ParameterScalar {
            const ReplacedName* source = source_of(argument, item);
            const bool from_outside = source && sources_.settings.contains(source->use->name);
            if (from_outside && !sources_.settings_diagnostics) return path;  // relative to the working folder
            const std::filesystem::path file = from_outside ? sources_.settings_diagnostics->file() : sources_.workflow;
            return std::get<ParameterScalar>(with_paths_from(file.parent_path(), path));
        };
        if (auto* one = std::get_if<ParameterScalar>(&value)) *one = with_folder(*one, 0);
        if (auto* list = std::get_if<std::vector<ParameterScalar>>(&value))
            for (std::size_t item = 0; item < list->size(); ++item) (*list)[item] = with_folder((*list)[item], item);
        return value;
    }

    /// The `$name` that an item of the value came from; nullptr for a literal.
    static const ReplacedName* source_of(const ChosenArgument& argument, std::size_t item) {
        for (const ReplacedName& replaced : argument.replaced)
            if (!argument.written->literal.list || replaced.use->item == item) return &replaced;
        return nullptr;
    }

    void report_value(const ChosenArgument& argument, const ParameterSpec& parameter, const std::string& filter,
                      std::string sentence) {
        const ReplacedName* source =
            argument.written->literal.list ? refused_item(argument, parameter, sentence) : source_of(argument, 0);
        if (source && sources_.settings_diagnostics && sources_.settings.contains(source->use->name))
            sources_.settings_diagnostics->error(source->value->position, "${} is {}the {} of {}: {}",
                                                 source->use->name, argument.written->literal.list ? "one of " : "",
                                                 parameter.name, filter, sentence);
        else
            sources_.diagnostics.error(source ? source->use->position : argument.written->position, "{}{}: {}",
                                       parameter.name, source ? " (from $" + source->use->name + ")" : "", sentence);
    }

    /// The first `$name` of a list whose value the parameter refuses; `sentence` gets the reason. nullptr for other
    /// errors.
    static const ReplacedName* refused_item(const ChosenArgument& argument, const ParameterSpec& parameter,
                                            std::string& sentence) {
        if (!parameter.list) return nullptr;
        ParameterSpec item = parameter;
        item.list = false;
        item.size.reset();
        item.word.clear();
        for (const ReplacedName& replaced : argument.replaced) try {
                parse(item, replaced.value->literal);
            } catch (const Error& error) {
                sentence = error.sentence();
                return &replaced;
            }
        return nullptr;
    }

    const ParameterSources& sources_;
};

}  // namespace

ParameterSet step_parameters(const ExpandedStep& step, const FilterSpec& spec, const ParameterSources& sources) {
    return Reader(sources).parameters(step, spec);
}

}  // namespace scanmill
