// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <nlohmann/json.hpp>
#include <set>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/poses/detail/pose_files.hpp"
#include "scanmill/formats/poses/rotation.hpp"

namespace scanmill {

namespace {

using Json = nlohmann::json;

/// nlohmann's parser lets a key stand twice in one object and keeps one of them, and nests as deep as the text does,
/// which is too deep for what walks through the result.
class StrictStructure {
public:
    bool operator()(int depth, Json::parse_event_t event, Json& value) {
        if (depth > deepest) throw Error("is nested more than {} levels deep", deepest);
        if (event == Json::parse_event_t::object_start) open_.emplace_back();
        if (event == Json::parse_event_t::object_end) open_.pop_back();
        if (event == Json::parse_event_t::key && !open_.back().insert(value.get<std::string>()).second)
            throw Error("the key '{}' stands twice in one object", value.get<std::string>());
        return true;
    }

private:
    static constexpr int deepest = 8;
    std::vector<std::set<std::string>> open_;
};

Json parsed(std::string_view text) {
    try {
        return Json::parse(text, StrictStructure());
    } catch (const Json::out_of_range&) {
        throw Error("holds a number that is too large");
    } catch (const Json::parse_error& error) {
        const std::size_t end = std::min(error.byte, text.size());
        throw Error("line {}: is no JSON", 1 + std::ranges::count(text.substr(0, end), '\n'));
    }
}

void require_keys(const Json& object, const std::string& place, const std::vector<std::string>& known) {
    for (const auto& [key, value] : object.items())
        if (std::ranges::find(known, key) == known.end())
            throw Error("{}: the key '{}' is not known; there are {}{}", place, key, enumerated(known),
                        did_you_mean(key, known));
}

/// Null when there is none.
const Json& item_at(const Json& object, const char* key) {
    static const Json none;
    const auto found = object.find(key);
    return found == object.end() ? none : *found;
}

/// Empty when there is none.
std::string text_at(const Json& object, const char* key, const std::string& place) {
    if (!object.contains(key)) return {};
    if (!item_at(object, key).is_string()) throw Error("{}: '{}' is no text", place, key);
    return item_at(object, key).get<std::string>();
}

/// `what` begins the message: "pose 2: 'rotation'".
template <std::size_t count>
std::array<double, count> numbers_of(const Json& list, const std::string& what) {
    std::array<double, count> values;
    const bool sound = list.is_array() && list.size() == count &&
                       std::ranges::all_of(list, [](const Json& item) { return item.is_number(); });
    if (!sound) throw Error("{} is not a list of {} numbers", what, count);
    for (std::size_t i = 0; i < count; ++i) values[i] = list[i].template get<double>();
    return values;
}

/// Four rows of four numbers, row by row.
std::array<double, 16> matrix_of(const Json& rows, const std::string& place) {
    if (!rows.is_array() || rows.size() != 4) throw Error("{}: 'matrix' is not a list of 4 rows", place);
    std::array<double, 16> values;
    for (std::size_t row = 0; row < 4; ++row)
        std::ranges::copy(numbers_of<4>(rows[row], fmt::format("{}: row {} of 'matrix'", place, row + 1)),
                          values.begin() + static_cast<std::ptrdiff_t>(4 * row));
    return values;
}

RigidTransform motion_at(const Json& item, const std::string& place, const OnPoseWarning& warn) {
    if (!item.contains("matrix")) {
        RigidTransform motion;
        motion.rotation = rotation_of(numbers_of<4>(item_at(item, "rotation"), place + ": 'rotation'"), place, warn);
        motion.translation = Vec3(numbers_of<3>(item_at(item, "translation"), place + ": 'translation'").data());
        return motion;
    }
    for (const char* other : {"rotation", "translation"})
        if (item.contains(other)) throw Error("{}: has a matrix and '{}'; expected one of the two ways", place, other);
    return motion_of(matrix_of(item_at(item, "matrix"), place), place);
}

}  // namespace

std::vector<ScanPose> parse_poses_json(std::string_view text, const OnPoseWarning& warn) {
    const Json root = parsed(text);
    const std::string whole = "the poses";
    if (!root.is_object()) throw Error("holds no JSON object; expected {}", "{\"scanmill\": 1, \"poses\": […]}");
    if (item_at(root, "scanmill") != Json(1)) throw Error("does not say its grammar; expected \"scanmill\": 1");
    require_keys(root, whole, {"scanmill", "unit", "frame", "poses"});
    const std::string unit_text = text_at(root, "unit", whole);
    const std::optional<LengthUnit> unit = length_unit(unit_text);
    if (!unit_text.empty() && !unit)
        throw Error("'{}' is no unit; expected one of {}", unit_text, length_unit_symbols());
    const Json& list = item_at(root, "poses");
    if (!list.is_array() || list.empty()) throw Error("holds no pose; expected \"poses\" to be a list of them");

    std::vector<ScanPose> poses;
    for (const Json& item : list) {
        const std::string place = fmt::format("pose {}", poses.size() + 1);
        if (!item.is_object()) throw Error("{}: is no JSON object", place);
        require_keys(item, place, {"scan", "rotation", "translation", "matrix"});
        ScanPose pose;
        pose.scan = text_at(item, "scan", place);
        pose.transform = motion_at(item, place, warn);
        pose.transform.unit = unit.value_or(LengthUnit::unknown);
        pose.transform.to = text_at(root, "frame", whole);
        poses.push_back(std::move(pose));
    }
    return poses;
}

}  // namespace scanmill
