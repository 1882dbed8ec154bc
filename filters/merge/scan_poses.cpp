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

using Assigned = std::vector<std::optional<RigidTransform>>;

Assigned by_order(std::size_t frames, std::span<const ScanPose> poses) {
    // Programs write refused scans behind the others, so the order does not assign the poses.
    if (const auto refused = std::ranges::find_if(poses, [](const ScanPose& pose) { return pose.refused.has_value(); });
        refused != poses.end())
        throw Error(
            "'{}' and perhaps other scans are refused, and the frames of the inputs have no names that show "
            "which inputs these are",
            refused->scan)
            .hint("name frames after their files: `frame: \"{stem}\"` at the workflow's input");
    if (frames != poses.size())
        throw Error("there are {} poses for {} inputs; inputs whose frames have no name use the poses in order",
                    poses.size(), frames)
            .hint(
                "give as many inputs as there are poses, or name frames after their files: `frame: \"{stem}\"` at "
                "the workflow's input");
    Assigned result;
    for (const ScanPose& pose : poses) result.push_back(pose.transform);
    return result;
}

/// Warns of the refused inputs. Throws Error if no input is left.
void report(std::span<const std::string> refused, std::size_t inputs, Context& context) {
    if (refused.empty()) return;
    if (refused.size() == inputs)
        throw Error("all {} are refused: {}", count_text(inputs, "input", "inputs"), enumerated(refused))
            .hint("register the views again with other parameters");
    context.warn(fmt::format("{} of {} inputs {} left out, because the registration refused {}: {}", refused.size(),
                             inputs, by_count(refused.size(), "is", "are"), by_count(refused.size(), "it", "them"),
                             enumerated(refused)));
}

Assigned by_name(std::span<const Frame> frames, std::span<const ScanPose> poses, Context& context) {
    if (std::ranges::all_of(poses, [](const ScanPose& pose) { return pose.scan.empty(); }))
        throw Error("the frames of the inputs have names, such as '{}', but none of the {} poses names its scan",
                    frames.front().name, poses.size())
            .hint(
                "name the scans in the file, \"scan\": \"…\", or leave the frames without names; the inputs then use "
                "the poses in order");
    Assigned result;
    std::vector<std::string> refused;
    std::map<const ScanPose*, std::size_t> used;
    std::vector<std::string> unused = names_of(poses);
    for (std::size_t input = 0; input < frames.size(); ++input) {
        const std::string& name = frames[input].name;
        const auto fits = [&](const ScanPose& pose) { return is_of(pose, name); };
        const auto found = std::ranges::find_if(poses, fits);
        if (found == poses.end())
            throw Error("there is no pose for input {}, whose frame is called '{}'; there are poses for {}{}", input,
                        name, enumerated(names_of(poses)), did_you_mean(name, names_of(poses)));
        if (std::ranges::count_if(poses, fits) > 1)
            throw Error("there are {} poses for input {}, whose frame is called '{}'; exactly one is needed",
                        std::ranges::count_if(poses, fits), input, name);
        if (found->refused)
            refused.push_back(fmt::format("input {} '{}' ({})", input, name, *found->refused));
        else if (const auto [earlier, is_new] = used.emplace(&*found, input); !is_new)
            context.warn(fmt::format("inputs {} and {} are both in the frame '{}' and use the same pose, that of '{}'",
                                     earlier->second, input, name, found->scan));
        result.push_back(found->refused ? std::nullopt : std::optional(found->transform));
        std::erase(unused, found->scan);
    }
    report(refused, frames.size(), context);
    if (!unused.empty())
        context.warn(fmt::format("{} of {} poses match no input: {}", unused.size(), poses.size(), enumerated(unused)));
    return result;
}

}  // namespace

std::vector<ScanPose> scan_poses_of(const Transforms& transforms) {
    std::vector<ScanPose> poses;
    for (const RigidTransform& motion : transforms.motions) poses.push_back({motion.from, motion, {}});
    for (const RefusedFrame& each : transforms.refused) poses.push_back({each.from, {}, each.reason});
    return poses;
}

Assigned poses_of(std::span<const Frame> frames, std::span<const ScanPose> poses, Context& context) {
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

void place(std::vector<std::shared_ptr<const PointCloud>>& clouds, MergeParams& params, std::span<const ScanPose> poses,
           Context& context) {
    std::vector<Frame> frames;
    for (const auto& cloud : clouds) frames.push_back(cloud->frame);
    const Assigned assigned = poses_of(frames, poses, context);
    std::vector<std::shared_ptr<const PointCloud>> rest;
    for (std::size_t input = 0; input < clouds.size(); ++input) {
        if (!assigned[input]) continue;
        rest.push_back(clouds[input]);
        params.poses.push_back(*assigned[input]);
        params.numbers.push_back(static_cast<u32>(input));
    }
    clouds = std::move(rest);
}

}  // namespace scanmill::merging
