// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Updates a closed mesh where its object was scanned again.
///
/// 1. The surface of each cloud is reconstructed, and its boundary loops are found (cloud_surface.hpp).
/// 2. The loops are followed on the model; the facets under them are the overlap facets (overlap.hpp).
/// 3. The overlap facets divide the model into groups (groups.hpp).
/// 4. The angle condition chooses the groups that a cloud replaces (groups.hpp).
/// 5. The vertices of those groups are discarded (replacement.hpp).
/// 6. Tight cocone makes a closed surface through the vertices that are kept and the points of the clouds. With
///    Rebuild::local, it does so around the change only, and all other triangles stay (local_rebuild.hpp).
///
/// Before step 2, edges of the model longer than `density` spacings of the cloud are split (resample.hpp): a CAD model
/// has too few vertices for step 6.
///
/// Source: Woo, Dey 2005. Resampling, closed barriers, doubts and the local rebuild are our own.

#include <memory>
#include <span>

#include "scanmill/data/features.hpp"
#include "tight_cocone/tight_cocone.hpp"

namespace scanmill {

struct MeshUpdateParams : TightCoconeParams {
    enum class Rebuild {
        whole,  ///< tight cocone of all points
        local  ///< tight cocone around the change; all else keeps its bytes
    };
    enum class Overlap {
        projected,  ///< facets under the boundary
        candidates  ///< also all facets at the vertices nearest to boundary points
    };
    enum class OnDoubt {
        fail,  ///< throw an Error
        keep  ///< return the model, with a warning
    };
    Rebuild rebuild = Rebuild::whole;
    /// Boundary points of a cloud farther from the model have no overlap facet; above 0. The spacing is the model's
    /// median edge, or `density` spacings of the densest cloud if that is less.
    Length max_distance = Length::spacings(3);
    Overlap overlap = Overlap::projected;
    /// The mean angles of two groups must differ by more than this; 0 to 90 degrees.
    Angle angle_gap = Angle::degrees(20);
    /// Vertices of overlap facets nearer to a point of the cloud are discarded; 0 or more, in local spacings of the
    /// cloud.
    double trim = 0.3;
    /// Longer edges of the model are split; above 0, in spacings of the cloud.
    double density = 4;
    OnDoubt on_doubt = OnDoubt::fail;
};

/// A connected part of the mesh that the clouds changed.
struct MeshChange {
    double area = 0;  ///< total area of the triangles with a point of a cloud
    double volume_added = 0;  ///< inside the result and outside the model; see changes.hpp for the error
    double volume_removed = 0;  ///< inside the model and outside the result
    double deviation = 0;  ///< largest distance of a point of the clouds in it from the model
    Vec3 position = Vec3::Zero();  ///< that point, relative to the model's origin
    u32 cloud = 0;  ///< number of the cloud that this point is from, from 1
};

/// The angle condition at the border of a cloud.
struct MeshUpdateAngle {
    u32 cloud = 0;  ///< number of the cloud, from 1; if clouds count as one, the lowest
    u32 group = 0;  ///< number of the model's group, from 1
    double mean = 0;  ///< in radians
    bool is_replaced = false;  ///< whether the group is
};

struct MeshUpdateResult {
    /// Closed and outward. Vertices of the model in their order, then points of the clouds; vertex columns `source`
    /// (uint32; 0: the model, j: cloud j), `group` (int32; from 1, or -1 on overlap facets and for points of clouds)
    /// and `replaced` (uint8; 1 only where OnDoubt::keep left what would have been discarded), and face column
    /// `updated` (1: not a triangle of the model).
    TriangleMesh mesh;
    /// The loops of the clouds, as outer boundaries and holes.
    FeatureGraph features;
    bool updated = false;
    std::size_t initial = 0;  ///< vertices of the model that are in triangles
    std::size_t resampled = 0;  ///< vertices that splitting edges added
    std::size_t added = 0;  ///< points of all clouds
    std::size_t discarded = 0, kept = 0;  ///< initial + resampled = discarded + kept
    std::size_t unused = 0;  ///< kept + added - vertices of the result
    std::size_t groups = 0, replaced = 0;
    std::vector<MeshUpdateAngle> angles;  ///< by cloud, then by group
    std::vector<MeshChange> changes;  ///< by their lowest triangle of the model
    std::size_t remeshed = 0;  ///< new triangles without a point of a cloud: vertices of the model, joined anew
    std::string doubt;  ///< why the model was kept; empty if updated
};

/// Pre:  the model is closed, a manifold and faces outwards; with Rebuild::whole it does not intersect itself. Clouds
/// have
///       at least one point. All have one unit; origins may differ. Parameters are in their ranges. Throws Error
///       otherwise. With OnDoubt::fail, throws Error for each of these doubts, with cloud, position and numbers:
///        - hanging: more than a fifth of a loop is farther than max_distance from the model;
///        - registration: the median distance of a loop's points from their facets exceeds half a spacing of the cloud;
///        - no separation: a loop has one group on both sides;
///        - ambiguous: the angles do not decide, or clouds disagree.
///       One doubt stops the whole update. Holes of a cloud that hang, lie beside the model or do not decide are not
///       used as loops; the new surface closes them. Throws Error if nothing of a component of the model would be kept,
///       and with Rebuild::local where rebuild_locally() does.
/// Post: vertices of the model that are not discarded keep their coordinates, bit for bit. With OnDoubt::keep and a
/// doubt,
///       positions and triangles are those of the given model. The result depends on neither the number of threads nor
///       the order of the clouds, apart from the order of their points. Clouds whose loops come within two spacings of
///       each other count as one. Where the surface has a short handle that neither the model nor a cloud has, the
///       points of the clouds on it are left out, with a warning.
/// Ties: among equally near facets, the lowest row; among equally near vertices, the lowest.
/// Cost: whole: that of delaunay() and tight_cocone() on all points; local: passes over the model without searches,
/// then
///       the change.
/// Metrics: see plugin.cpp. Doubts a result in three cases: its topology is not that of the kept groups joined with the
///       clouds' surfaces; more than 1 % of the new area is farther than a spacing from both; more than 5 % of the
///       clouds' points are left out.
MeshUpdateResult mesh_update(const TriangleMesh& model, std::span<const std::shared_ptr<const PointCloud>> clouds,
                             const MeshUpdateParams& params, Context& context);

}  // namespace scanmill
