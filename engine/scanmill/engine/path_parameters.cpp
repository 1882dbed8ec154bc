// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/engine/path_parameters.hpp"

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

}  // namespace scanmill
