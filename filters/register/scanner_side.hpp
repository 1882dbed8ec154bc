// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The side from which a view was scanned, found in its points.

#include <span>

#include "scanmill/data/frame.hpp"

namespace scanmill::registration {

/// Returns the unit direction from a view to its scanner: +z, as range images have it, unless the points contradict
/// that.
///
/// If all normals are turned towards the scanner, neighbours have similar ones; elsewhere the surface would be seen
/// edge-on. +z stays if at most 1 % more neighbours contradict each other than for the best of 193 axes all round.
/// Otherwise the direction is the mean of the normals turned towards the best axis. Its sign is the one for which the
/// surface is convex as a whole, as objects seen from outside are. The sign of +z changes only if the surface is
/// clearly concave.
///
/// Pre: finite points. Ties: the first axis. Deterministic; cost: about 10 ms.
Vec3 scanner_side(std::span<const Vec3> points);

}  // namespace scanmill::registration
