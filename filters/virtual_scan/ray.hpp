// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The line of a ray, and its way through a box.

#include <optional>

#include "virtual_scan/scene.hpp"

namespace scanmill::scan {

struct Ray {
    Vec3 start, direction;  // a whole line: it enters shapes before `start` too
    Vec3 at(double depth) const { return start + depth * direction; }
};

struct Passage {
    double enter, leave;  ///< depths; enter ≤ leave
    Vec3 normal;          ///< outwards, of the face it enters by
};

/// By slabs (Kay, Kajiya 1986); of faces met together, the lowest axis counts. A ray within a face passes through.
std::optional<Passage> passage_through(const Ray& ray, const BoundingBox& box);

/// Where the ray enters the box: on the face's plane exactly, whatever the rounding along the ray.
Hit entry_of(const Ray& ray, const BoundingBox& box, const Passage& passage);

}  // namespace scanmill::scan
