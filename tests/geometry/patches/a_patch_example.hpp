// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
// How another program uses stored patches: is a point inside, how far is the surface, where does a ray hit it?
#include "scanmill/geometry/patches/a_patch.hpp"

struct Answer {
    bool is_inside = false;
    double distance = 0;
    scanmill::Vec3 hit, normal;
};

inline Answer ask(const scanmill::PatchComplex& patches, const scanmill::Vec3& point) {
    const scanmill::PatchSurface surface(patches);
    Answer answer;
    answer.is_inside = surface.is_inside(point);
    if (const auto foot = surface.foot(point)) answer.distance = foot->distance;
    if (const auto hit = surface.first_hit(point, scanmill::Vec3(0, 0, 10))) {
        answer.hit = hit->point;
        answer.normal = hit->gradient.normalized();
    }
    return answer;
}
