// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The groups into which the overlap facets divide the model, and the angle condition that chooses those to replace.
///
/// The boundary of a cloud lies on the model, so on one side of it the model continues the cloud, and on the other side
/// it lies under or above the cloud. The angle at a boundary edge is the interior dihedral angle between the cloud's
/// triangle and the triangle from the edge to the nearest vertex of a group: near 180° if the group continues the
/// cloud, near 0 if the cloud replaces the group. As printed, equation 4 gives the opposite for a triangle that is
/// folded back; the definition here agrees with figures 9 and 11.
///
/// Source: Woo, Dey 2005, section 3.4, equations 4 and 5, and the angle condition.

#include <string>
#include <vector>

#include "mesh_update/overlap.hpp"

namespace scanmill::updating {

/// Components of the facets that are not overlap facets, connected through edges.
struct Groups {
    static constexpr std::int32_t overlap = -1;
    /// By facet: its group, or `overlap`. Group 0 contains the lowest vertex of all groups, group 1 the lowest of the
    /// others, and so on.
    Array<std::int32_t> of_facet;
    std::size_t count = 0;
    std::vector<u32> component;  ///< by group, the lowest group in the same component of the model
};

/// Pre: one flag per facet. Cost: linear.
Groups segmentation(const Model& model, std::span<const u8> is_overlap, Context& context);

/// The interior dihedral angle at the edge from `start` to `end`, in radians: between the half-planes through `apex`
/// and through `vertex`. `on_model` is the point of the model nearest to the middle of the edge: if the edge lies above
/// or below the model, the direction to the vertex is still that along the model.
double dihedral_angle(const Vec3& start, const Vec3& end, const Vec3& apex, const Vec3& on_model, const Vec3& vertex);

struct GroupAngle {
    u32 group;
    double mean;  ///< in radians
    double share;  ///< largest share of a loop's edges at which the group has a vertex
};

/// Groups at a smaller share of every loop are fragments: overlap facets that touch enclose a few facets between them.
inline constexpr double least_group_share = 0.5;

struct CloudAngles {
    std::vector<GroupAngle> groups;  ///< those at the cloud's loops, ascending
    /// The number of a loop that does not divide the model: most of its edges have one group on both sides.
    std::optional<std::size_t> undivided_loop;
    Vec3 undivided_at = Vec3::Zero();  ///< the middle of its first such edge
};

/// At every boundary edge, each group has at most one angle: that of its vertex on the overlap facets of this edge that
/// is nearest to the edge's middle. Edges of thin triangles have none. Ties: the lowest vertex. Cost: linear in the
/// overlap facets.
CloudAngles mean_angles(const Model& model, const Groups& groups, const CloudSurface& cloud,
                        std::span<const LoopOverlap> loops, Context& context);

struct Choice {
    std::vector<u32> replaced;  ///< groups, ascending
    std::string ambiguity;  ///< why the angles do not decide; empty if they do
};

/// The groups that one cloud replaces. Of two groups, the one with the smaller mean angle; they must differ by more
/// than `gap`. Of more groups, those below 90°; no mean angle may be within half of `gap` of 90°. Fragments are
/// replaced below 90°, whatever the gap.
Choice chosen_groups(const CloudAngles& angles, double gap);

/// V - E + F of the part of the model that stays: all but the replaced groups. A vertex counts once per fan.
/// `vertices`: the number of the model's vertices that are in triangles. Cost: a look at every facet, and that of the
/// replaced groups.
long euler_of_rest(const Model& model, const Groups& groups, const std::vector<bool>& replaced, std::size_t vertices);

/// V - E + F of the components of a cloud's surface that have a loop in use, with their other loops filled.
struct CloudEuler {
    long as_found = 0;  ///< a vertex counts once per fan
    long as_sphere = 0;  ///< if every component is a sphere with its loops cut out
};
CloudEuler euler_of(const CloudSurface& cloud);

}  // namespace scanmill::updating
