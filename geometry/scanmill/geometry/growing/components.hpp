// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The connected components of the grown surface, and their orientation.

#include <optional>

#include "scanmill/geometry/growing/surface.hpp"

namespace scanmill::growing {

struct Components {
    /// For each point, the number of its component; invalid_index for unused points.
    Array<u32> of_point;
    std::size_t count = 0;
};

Components find_components(const Surface& surface);

/// Reverses the triangles of components that face inwards. For a closed component, the sign of its volume decides. The
/// open components of a group are reversed together, by the sign of the volume between them and their centroid. If this
/// volume is below a hundredth of area^(3/2), their summed normal decides. The sum must be on the side of `up`. Without
/// `up`, its largest component must be positive.
///
/// `groups`: for each point, the number of a point, or invalid_index. Points whose orientations depend on each other
/// have equal numbers. A component whose points all have invalid_index is a group of its own. Changes the list of
/// triangles only: the fans and the points' normals keep the old orientation. Cost: linear.
void orient_outwards(Surface& surface, const Components& components, std::span<const u32> groups,
                     const std::optional<Vec3>& up = std::nullopt);

/// Reverses the triangles of every component whose given normals oppose it. At least three quarters of the normals at
/// the triangles' corners must oppose them; zero normals do not count. `given`: one normal per point. Changes the list
/// of triangles only. Cost: linear.
void orient_like_normals(Surface& surface, const Components& components, const Array<Vec3>& given);

}  // namespace scanmill::growing
