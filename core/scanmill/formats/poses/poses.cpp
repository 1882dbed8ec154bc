// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/formats/poses/poses.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/formats/common/reading.hpp"
#include "scanmill/formats/poses/detail/pose_files.hpp"
#include "scanmill/io/mapped_file.hpp"

namespace scanmill {

namespace {

bool is_json(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && (text[first] == '{' || text[first] == '[');
}

}  // namespace

std::vector<ScanPose> parse_poses(std::string_view content, const OnPoseWarning& warn) {
    const std::string_view text = without_byte_order_mark(content);
    return is_json(text) ? parse_poses_json(text, warn) : parse_stanford_conf(text, warn);
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
        throw Error("'{}': {}", file.string(), error.sentence()).hint(error.hint());
    }
}

bool is_of(const ScanPose& pose, const std::string& scan) {
    const std::filesystem::path named(pose.scan);
    return pose.scan == scan || named.filename() == scan || named.stem() == scan;
}

}  // namespace scanmill
