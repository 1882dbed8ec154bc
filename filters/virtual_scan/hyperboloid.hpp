// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The upper half of a hyperboloid of one sheet above a disc: an open saddle, bent both ways, whose curvatures are
/// known. Source: Wang 2006, section 4.4.1, whose h is height · radius here.

#include <optional>

#include "virtual_scan/ray.hpp"

namespace scanmill::scan {

/// z = height / radius · √(x² − y² + radius²) where x² + y² ≤ radius².
struct Hyperboloid {
    double radius, height;
};

BoundingBox bounds_of(const Hyperboloid& surface);

/// From either side; the normal is turned against the ray.
std::optional<Hit> first_hit(const Ray& ray, const Hyperboloid& surface);

}  // namespace scanmill::scan
