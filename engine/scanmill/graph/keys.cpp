// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/graph/keys.hpp"

#include <fmt/format.h>

#include "scanmill/base/hash.hpp"
#include "scanmill/formats/common/format.hpp"
#include "scanmill/plan/step_parameters.hpp"
#include "scanmill/plugin/module.hpp"

namespace scanmill {

namespace {

constexpr std::string_view key_scheme = "4";

/// Of everything that reads files: the core, and the modules of formats.
std::string builds_of_readers(const std::string& core) {
    std::string builds = core;
    for (std::filesystem::path module : module_manifests(installed_format_folder())) {
        std::error_code absent;
        if (module.replace_extension(".so"); std::filesystem::is_regular_file(module, absent))
            builds += " " + content_hash(module);
    }
    return builds;
}

std::string text_of(const RigidTransform& pose) {
    std::string text = fmt::format("{} {} {}", symbol(pose.unit), pose.from, pose.to);
    for (const double number : pose.rotation.reshaped()) text += fmt::format(" {:a}", number);
    for (const double number : pose.translation) text += fmt::format(" {:a}", number);
    return text;
}

}  // namespace

KeyBase key_base(std::uint64_t seed) {
    const std::string core = content_hash(core_library_file());
    return {core, builds_of_readers(core), seed};
}

std::string key_of_leaf(const LeafSource& leaf, const KeyBase& base) {
    KeyBuilder key;
    key.field("scheme", key_scheme)
        .field("content", leaf.content)
        .field("readers", base.readers)
        .field("extension", plain_extension(leaf.file.extension().string()))  // it may decide how bytes are read
        .field("kind", name_of(leaf.kind))
        .field("unit", symbol(leaf.unit))
        .field("frame", leaf.frame)
        .field("pose", leaf.pose ? text_of(*leaf.pose) : "");
    return key.key();
}

StepKeys keys_of_step(const PlannedStep& step, const std::string& module, const KeyBase& base,
                      const std::function<std::string(const std::filesystem::path&)>& content,
                      const std::vector<std::pair<std::string, std::string>>& inputs) {
    KeyBuilder key;
    key.field("scheme", key_scheme)
        .field("filter", step.spec.name)
        .field("version", std::to_string(step.spec.version))
        .field("module", module)
        .field("core", base.core)
        .field("seed", std::to_string(base.seed));
    for (const auto& [name, value] : step.parameters.values)
        if (names_files(step.spec, name)) key.field("parameter " + name, key_text_of_paths(value, content));
    const std::string code = key.key();
    for (const auto& [name, value] : step.parameters.values)
        if (!names_files(step.spec, name)) key.field("parameter " + name, canonical_text(value));
    for (const auto& [port, from] : inputs) key.field("port " + port, from);
    return {code, key.key()};
}

}  // namespace scanmill
