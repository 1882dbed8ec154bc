// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/batch/parse_pose.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/kinds/transform.hpp"
#include "scanmill/workflow/grammar.hpp"

namespace scanmill {

namespace {

const std::string place = "the pose";

/// Writes `node`'s numbers to `values`; false after reporting.
bool read_numbers(const YamlNode& node, std::span<double> values, std::string_view expected, Diagnostics& diagnostics) {
    if (!require_list(node, expected, diagnostics)) return false;
    if (node.items.size() != values.size()) {
        diagnostics.error(node.position, fmt::format("a list of {}; expected {}",
                                                     count_text(node.items.size(), "value", "values"), expected));
        return false;
    }
    bool sound = true;
    for (std::size_t i = 0; i < values.size(); ++i) {
        const YamlNode& item = node.items[i];
        if (item.is_scalar() && parse_number(item.text, values[i]) && std::isfinite(values[i])) continue;
        diagnostics.error(item.position,
                          fmt::format("{} is no finite number; expected {}", item.described(), expected));
        sound = false;
    }
    return sound;
}

/// What `make` returns; an Error of it is told at `position`.
template <class Make>
auto or_report(Position position, Diagnostics& diagnostics, Make&& make) -> std::optional<decltype(make())> {
    try {
        return make();
    } catch (const Error& error) {
        diagnostics.error(position, error.sentence() + (error.hint().empty() ? "" : "; " + error.hint()));
        return std::nullopt;
    }
}

std::optional<RigidTransform> from_matrix(const YamlNode& node, Diagnostics& diagnostics) {
    if (node.items.size() != 4) {
        diagnostics.error(node.position, fmt::format("a matrix of {}; expected 4 rows of 4 numbers",
                                                     count_text(node.items.size(), "row", "rows")));
        return std::nullopt;
    }
    std::array<double, 16> matrix;
    bool sound = true;
    for (std::size_t row = 0; row < 4; ++row)
        sound &=
            read_numbers(node.items[row], std::span(matrix).subspan(4 * row, 4), "a row of 4 numbers", diagnostics);
    if (!sound) return std::nullopt;
    return or_report(node.position, diagnostics, [&] { return motion_of(matrix, place); });
}

std::optional<RigidTransform> from_parts(const YamlNode& node, Diagnostics& diagnostics) {
    MapReader keys(node, "a pose", diagnostics);
    const YamlEntry* translation = keys.find("translation");
    const YamlEntry* rotation = keys.find("rotation");
    keys.complain_of_others();
    if (!translation || !rotation) {
        diagnostics.error(node.position, fmt::format("the pose has no {}; expected {{translation: [x, y, z], rotation: "
                                                     "[qx, qy, qz, qw]}}",
                                                     translation ? "rotation" : "translation"));
        return std::nullopt;
    }
    std::array<double, 3> along{};
    std::array<double, 4> quaternion{};
    const bool moves = read_numbers(translation->value, along, "3 numbers: x, y, z", diagnostics);
    const bool turns = read_numbers(rotation->value, quaternion, "4 numbers: qx, qy, qz, qw", diagnostics);
    if (!moves || !turns) return std::nullopt;
    const auto warn = [&](std::string sentence) { diagnostics.warning(rotation->value.position, std::move(sentence)); };
    const auto turn =
        or_report(rotation->value.position, diagnostics, [&] { return rotation_of(quaternion, place, warn); });
    if (!turn) return std::nullopt;
    RigidTransform pose;
    pose.rotation = *turn;
    pose.translation = Vec3(along.data());
    return pose;
}

}  // namespace

std::optional<RigidTransform> parse_pose(const YamlNode& node, Diagnostics& diagnostics) {
    return node.is_sequence() ? from_matrix(node, diagnostics) : from_parts(node, diagnostics);
}

RigidTransform PoseFiles::pose_of(const std::filesystem::path& scan, const std::filesystem::path& file,
                                  Position position, Diagnostics& diagnostics) {
    auto known = poses_.find(file);
    if (known == poses_.end()) {
        const auto warn = [&](std::string sentence) { diagnostics.warning(position, std::move(sentence)); };
        known = poses_.emplace(file, read_poses(file, warn)).first;
    }
    const std::vector<ScanPose>& poses = known->second;
    std::vector<std::string> names;
    std::vector<const ScanPose*> fitting;
    for (const ScanPose& pose : poses) {
        if (!pose.scan.empty()) names.push_back(pose.scan);
        if (is_of(pose, scan.filename().string()) || is_of(pose, scan.stem().string())) fitting.push_back(&pose);
    }
    if (fitting.size() == 1) return fitting.front()->transform;
    if (fitting.size() > 1)
        throw Error("'{}': there are {} poses of '{}'; one is needed", file.string(), fitting.size(),
                    scan.filename().string());
    if (poses.size() == 1 && names.empty()) return poses.front().transform;
    if (names.empty())
        throw Error("'{}': holds {} poses, none of which says of which scan it is", file.string(), poses.size());
    throw Error("'{}': has no pose of '{}'; it has those of {}{}", file.string(), scan.filename().string(),
                enumerated(names), did_you_mean(scan.filename().string(), names));
}

}  // namespace scanmill
