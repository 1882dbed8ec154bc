// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The connected components of the grown surface, and their orientation.

#include <optional>

#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

struct Components {
    /// Per point the number of its component, invalid_index for unused ones.
    Array<u32> of_point;
    std::size_t count = 0;
};

Components find_components(const Surface& surface);

/// Reverses triangles of components that face inwards: of a closed component by the sign of its volume; of open
/// components, together for all of a group, by the sign of the volume between them and their centroid, or, where that
/// is below a hundredth of area^(3/2), so that their summed normals are on the side of `up`, or without it have a
/// positive largest component. `groups`: per point the number of a point, equal for points whose orientations depend on
/// each other, or invalid_index; where it is invalid_index throughout, every component is a group of its own. Changes
/// the list of triangles only: the fans and the points' normals keep the old orientation. Cost: linear.
void orient_outwards(Surface& surface, const Components& components, std::span<const u32> groups,
                     const std::optional<Vec3>& up = std::nullopt);

/// Reverses the triangles of every component where at least three quarters of the given normals at its corners oppose
/// them. Zero normals do not count. `given`: per point. Changes the list of triangles only. Cost: linear.
void orient_like_normals(Surface& surface, const Components& components, const Array<Vec3>& given);

}  // namespace scanmill::growing
