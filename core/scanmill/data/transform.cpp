// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/data/transform.hpp"

#include <algorithm>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

const RigidTransform& Transforms::motion_from(const std::string& frame) const {
    const auto found = std::ranges::find(motions, frame, &RigidTransform::from);
    const auto refusal = std::ranges::find(refused, frame, &RefusedFrame::from);
    if (found == motions.end() && refusal != refused.end())
        throw Error("the frame '{}' has no motion, because it was refused: {}", frame, refusal->reason)
            .hint("leave this view out, or repeat the registration with other parameters");
    if (motions.size() == 1) return motions.front();
    std::vector<std::string> names;
    for (const RigidTransform& motion : motions)
        if (!motion.from.empty()) names.push_back(motion.from);
    const std::string known = names.empty() ? "frames without a name" : enumerated(names);
    if (motions.empty()) throw Error("the transform has no motion").hint("check the file of the transform");
    if (frame.empty())
        throw Error("the frame has no name, which must select one of {} motions; they start from {}", motions.size(),
                    known)
            .hint("name the frame after its file: `frame: \"{stem}\"` at the workflow's input");
    if (found == motions.end())
        throw Error("no motion starts from the frame '{}'; the {} motions start from {}{}", frame, motions.size(),
                    known, did_you_mean(frame, names))
            .hint("frames are named at the workflow's inputs: `frame: \"{stem}\"`");
    if (const auto count = std::ranges::count(motions, frame, &RigidTransform::from); count > 1)
        throw Error("{} motions start from the frame '{}'; exactly one is needed", count, frame)
            .hint("give every frame another name");
    return *found;
}

}  // namespace scanmill
