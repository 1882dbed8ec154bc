// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// What a scanner far away in one direction saw: the points of its view, sorted across the line of sight.
///
/// A position is contradicted by a view if the view's rays must have hit it first, but measured something behind it; or
/// if it faces the scanner where the view measured nothing.

#include <vector>

#include "scanmill/geometry/registration/projected_grid.hpp"

namespace scanmill {

class SightLines {
public:
    enum class Place {
        unknown,  ///< the view has no ray there
        in_front,  ///< nearer to the scanner than all points around the line of sight
        behind  ///< occluded or on the surface
    };

    /// `to_scanner` is a unit vector. `reach` is the length to which all distances below refer. If not `sees_all`, the
    /// scanner's field may have cut the view off: all that is known of it is the convex outline of the points across
    /// the line of sight. Copies the points. Pre: finite points. Cost: O(n log n).
    SightLines(std::span<const Vec3> points, const Vec3& to_scanner, double reach, bool sees_all = true);

    const Vec3& to_scanner() const { return grid_.direction(); }

    /// The view has a ray at `position` if one of its points lies within reach / 2 across the line of sight. The
    /// position is in front if it is more than `reach` nearer to the scanner than the points within 3/4 reach across.
    Place place_of(const Vec3& position) const;
    /// Whether the scanner looked along the line of sight through `position` and measured no point within `reach` of
    /// it.
    bool is_empty_at(const Vec3& position) const;

private:
    bool is_in_outline(const ProjectedGrid::Ray& at) const;

    ProjectedGrid grid_;
    double reach_;
    /// The corners of the convex outline, counter-clockwise; empty for views that are not cut off.
    std::vector<Eigen::Vector2d> outline_;
};

}  // namespace scanmill
