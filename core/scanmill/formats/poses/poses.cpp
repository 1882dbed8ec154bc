// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/poses/poses.hpp"

#include <array>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/common/text_cursor.hpp"
#include "scanmill/io/mapped_file.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

constexpr std::array<std::string_view, 7> fields{"tx", "ty", "tz", "qx", "qy", "qz", "qw"};

std::array<double, 7> numbers(TextCursor& cursor, std::string_view scan) {
    std::array<double, 7> values;
    const std::size_t found = cursor.count_tokens();
    if (found != fields.size())
        throw Error("line {}: {} words follow {}; expected 7 numbers: tx ty tz qx qy qz qw", cursor.line(), found,
                    quote(scan))
            .hint("a file's name with blanks can only stand in JSON: \"scan\": \"…\"");
    for (std::size_t i = 0; i < fields.size(); ++i) {
        cursor.more();
        if (!cursor.number(values[i]))
            throw Error("line {}: {} of {} is {}, which is no number", cursor.line(), fields[i], quote(scan),
                        quote(cursor.last_token()));
        if (!std::isfinite(values[i]))
            throw Error("line {}: {} of {} is {}; a pose is finite", cursor.line(), fields[i], quote(scan), values[i]);
    }
    return values;
}

std::vector<ScanPose> parse_stanford_conf(std::string_view text, const OnPoseWarning& warn) {
    static const std::vector<std::string> keywords{"camera", "mesh", "bmesh"};
    std::vector<ScanPose> poses;
    TextCursor cursor(text, {.comment = '#'});
    while (cursor.next_row()) {
        const std::string keyword(cursor.token());
        if (keyword == "camera") continue;
        if (keyword != "mesh" && keyword != "bmesh")
            throw Error("line {}: {} does not begin a line of poses; expected one of {}{}", cursor.line(),
                        quote(keyword), enumerated(keywords), did_you_mean(keyword, keywords));
        if (!cursor.more()) throw Error("line {}: '{}' names no file", cursor.line(), keyword);
        ScanPose pose;
        pose.scan = cursor.token();
        const std::string place = fmt::format("line {}", cursor.line());
        const std::array<double, 7> values = numbers(cursor, pose.scan);
        pose.transform.translation = Vec3(values[0], values[1], values[2]);
        pose.transform.rotation = rotation_of(std::span(values).subspan<3, 4>(), place, warn).transpose();
        poses.push_back(std::move(pose));
    }
    if (poses.empty()) throw Error("holds no pose; expected lines 'bmesh FILE tx ty tz qx qy qz qw'");
    return poses;
}

bool is_json(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && (text[first] == '{' || text[first] == '[');
}

}  // namespace

std::vector<ScanPose> parse_poses(std::string_view content, const OnPoseWarning& warn) {
    const std::string_view text = without_byte_order_mark(content);
    return is_json(text) ? poses_from_json(parse_document(text), warn) : parse_stanford_conf(text, warn);
}

std::vector<ScanPose> read_poses(const std::filesystem::path& file, const OnPoseWarning& warn) {
    if (std::filesystem::is_directory(file)) throw Error("'{}': is a folder; expected a file of poses", file.string());
    const auto warn_of_file = [&](const std::string& sentence) {
        warn(fmt::format("'{}': {}", file.string(), sentence));
    };
    try {
        const MappedFile content(file);
        return parse_poses(content.bytes(), warn_of_file);
    } catch (const Error& error) {
        throw error.reworded(fmt::format("'{}': {}", file.string(), error.sentence()));
    }
}

bool is_of(const ScanPose& pose, const std::string& scan) {
    const std::filesystem::path named(pose.scan);
    return pose.scan == scan || named.filename() == scan || named.stem() == scan;
}

}  // namespace scanmill
