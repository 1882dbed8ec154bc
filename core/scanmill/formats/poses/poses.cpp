// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/poses/poses.hpp"

#include "scanmill/formats/common/text_cursor.hpp"
#include "scanmill/kinds/document.hpp"

namespace scanmill {

namespace {

/// Reads the rest of a row: tx ty tz qx qy qz qw.
std::array<double, 7> read_numbers(TextCursor& cursor, std::string_view scan) {
    if (const std::size_t found = cursor.count_tokens(); found != 7)
        throw Error("line {}: {} words follow {}; expected 7 numbers: tx ty tz qx qy qz qw", cursor.line(), found,
                    quote(scan))
            .hint("a file's name with blanks can only be written in JSON: \"scan\": \"…\"");
    std::array<double, 7> values;
    for (std::size_t i = 0; i < values.size(); ++i) {
        constexpr std::array<std::string_view, 7> names{"tx", "ty", "tz", "qx", "qy", "qz", "qw"};
        values[i] = next_number(cursor, "{} of '{}'", names[i], scan);
        if (!std::isfinite(values[i]))
            throw Error("line {}: {} of {} is {}; a pose is finite", cursor.line(), names[i], quote(scan), values[i]);
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
        if (!cursor.more()) throw Error("line {}: '{}' is not followed by a file's name", cursor.line(), keyword);
        ScanPose pose;
        pose.scan = cursor.token();
        const std::string line = fmt::format("line {}", cursor.line());
        const std::array<double, 7> values = read_numbers(cursor, pose.scan);
        pose.transform.translation = Vec3(values[0], values[1], values[2]);
        pose.transform.rotation = rotation_of(std::span(values).subspan<3, 4>(), line, warn).transpose();
        poses.push_back(std::move(pose));
    }
    if (poses.empty()) throw Error("holds no pose; expected lines 'bmesh FILE tx ty tz qx qy qz qw'");
    return poses;
}

}  // namespace

std::vector<ScanPose> parse_poses(std::string_view content, const OnPoseWarning& warn) {
    const std::string_view text = without_byte_order_mark(content);
    const std::size_t first = std::min(text.find_first_not_of(" \t\r\n"), text.size());
    const bool is_json = text.substr(first).starts_with('{') || text.substr(first).starts_with('[');
    return is_json ? poses_from_json(parse_document(text), warn) : parse_stanford_conf(text, warn);
}

std::vector<ScanPose> read_poses(const std::filesystem::path& file, const OnPoseWarning& warn) {
    return with_file_name(file,
                          [&] { return parse_poses(MappedFile(file).bytes(), warnings_with_file_name(file, warn)); });
}

bool is_of(const ScanPose& pose, const std::string& scan) {
    const std::filesystem::path named(pose.scan);
    return pose.scan == scan || named.filename() == scan || named.stem() == scan;
}

}  // namespace scanmill
