// SPDX-License-Identifier: GPL-3.0-or-later
#include "merge/scan_poses.hpp"

#include <algorithm>
#include <map>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill::merging {

namespace {

std::vector<std::string> names_of(std::span<const ScanPose> poses) {
    std::vector<std::string> names;
    for (const ScanPose& pose : poses) names.push_back(pose.scan);
    return names;
}

std::vector<RigidTransform> by_order(std::size_t frames, std::span<const ScanPose> poses) {
    if (frames != poses.size())
        throw Error("there are {} poses for {} inputs; inputs whose frames have no name use the poses in order",
                    poses.size(), frames)
            .hint(
                "give as many inputs as there are poses, or name frames after their files: `frame: \"{stem}\"` at "
                "the workflow's input");
    std::vector<RigidTransform> result;
    for (const ScanPose& pose : poses) result.push_back(pose.transform);
    return result;
}

std::vector<RigidTransform> by_name(std::span<const Frame> frames, std::span<const ScanPose> poses, Context& context) {
    if (std::ranges::all_of(poses, [](const ScanPose& pose) { return pose.scan.empty(); }))
        throw Error("the frames of the inputs have names, such as '{}', but none of the {} poses names its scan",
                    frames.front().name, poses.size())
            .hint(
                "name the scans in the file, \"scan\": \"…\", or leave the frames without names; the inputs then use "
                "the poses in order");
    std::vector<RigidTransform> result;
    std::map<const ScanPose*, std::size_t> used;
    std::vector<std::string> unused = names_of(poses);
    for (std::size_t input = 0; input < frames.size(); ++input) {
        const std::string& name = frames[input].name;
        const auto fits = [&](const ScanPose& pose) { return is_of(pose, name); };
        const auto found = std::ranges::find_if(poses, fits);
        if (found == poses.end())
            throw Error("there is no pose for input {}, whose frame is called '{}'; the file has poses for {}{}", input,
                        name, enumerated(names_of(poses)), did_you_mean(name, names_of(poses)));
        if (std::ranges::count_if(poses, fits) > 1)
            throw Error("there are {} poses for input {}, whose frame is called '{}'; exactly one is needed",
                        std::ranges::count_if(poses, fits), input, name);
        if (const auto [earlier, is_new] = used.emplace(&*found, input); !is_new)
            context.warn(fmt::format("inputs {} and {} are both in the frame '{}' and use the same pose, that of '{}'",
                                     earlier->second, input, name, found->scan));
        result.push_back(found->transform);
        std::erase(unused, found->scan);
    }
    if (!unused.empty())
        context.warn(fmt::format("{} of {} poses match no input: {}", unused.size(), poses.size(), enumerated(unused)));
    return result;
}

}  // namespace

std::vector<RigidTransform> poses_of(std::span<const Frame> frames, std::span<const ScanPose> poses, Context& context) {
    const auto unnamed = std::ranges::find(frames, "", &Frame::name);
    if (unnamed == frames.end()) return by_name(frames, poses, context);
    if (const auto named = std::ranges::find_if(frames, [](const Frame& frame) { return !frame.name.empty(); });
        named != frames.end())
        throw Error(
            "the frame of input {} is called '{}', that of input {} has no name; poses are assigned by name "
            "for all inputs or for none",
            named - frames.begin(), named->name, unnamed - frames.begin())
            .hint("name frames after their files: `frame: \"{stem}\"` at the workflow's input");
    return by_order(frames.size(), poses);
}

}  // namespace scanmill::merging
