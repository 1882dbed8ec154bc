// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// How far a mesh is from the truth, and how good a mesh it is by itself.
///
/// Distances are from points of one surface to the nearest point of the other's triangles, both ways: *to the truth*
/// sees what the mesh has too much, *from the truth* what it lacks. They are taken at points spread evenly over the
/// area; largest distances also at every vertex. When the truth is a cloud, it has no area: its points are the samples
/// of that side, and distances from the mesh to its points exist only under a name of their own.

#include <optional>
#include <vector>

#include "measure/certified_hausdorff.hpp"
#include "measure/distance_numbers.hpp"
#include "measure/mesh_numbers.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

constexpr u32 fewest_samples = 32;

struct MeasureParams {
    enum class Borders { include, exclude };
    /// Points on each mesh, at least fewest_samples.
    u32 samples = 100'000;
    /// Distances that count as near for precision and recall; each above 0. Relative ones refer to the mesh.
    std::vector<Length> thresholds = std::vector(1, Length::percent_of_diagonal(0.5));
    /// Whether pairs of triangles that intersect are counted; takes about as long as everything else.
    bool self_intersections = true;
    /// Whether unit and frame are known to be equal, whatever sizes and places say: they only warn then.
    bool same_frame = false;
    /// Whether the Hausdorff distance is bounded from both sides; needs a mesh as truth.
    bool certify = false;
    /// The bounds are refined until upper - lower is at most this share of upper; in (0, 1).
    Ratio gap = Ratio::percent(1);
    /// Whether points of a cloud count whose nearest point on the mesh lies on a border of it: on an edge in one
    /// triangle, or a vertex of such an edge. How far they are says where the mesh ends, not how well it fits.
    /// Excluding needs points as truth.
    Borders borders = Borders::include;
    /// Pieces of triangles cut before the refinement ends with the bounds that it has.
    u64 most_cuts = 10'000'000;
};

/// How near is near enough: shares of samples, in [0, 1].
struct NearShares {
    double threshold = 0;
    /// Of the mesh within the threshold of the truth; absent when the truth is a cloud.
    std::optional<double> precision;
    /// Of the truth within the threshold of the mesh.
    double recall = 0;
    /// Harmonic mean of the two, 0 when both are 0; absent with precision.
    std::optional<double> f_score;
};

struct Measurement {
    /// From the mesh to the truth's triangles; absent when the truth is a cloud.
    std::optional<DistanceNumbers> to_truth;
    /// From the mesh to the nearest point of a cloud: no distance between surfaces, it cannot fall below the cloud's
    /// spacing. Absent when the truth is a mesh.
    std::optional<DistanceNumbers> to_points;
    /// From the truth, its area or its points, to the mesh's triangles.
    DistanceNumbers from_truth;
    /// Points of a cloud left out of from_truth and all that follows from it; absent unless they were to be.
    std::optional<std::size_t> beyond_borders;
    /// Both sides with equal weight; for a cloud, from_truth again.
    DistanceNumbers both;
    /// Larger of the two sides' max; absent for a cloud. Not above the true Hausdorff distance.
    std::optional<double> hausdorff;
    /// Half the sum of the two sides' means; absent for a cloud.
    std::optional<double> chamfer;
    std::vector<NearShares> near;
    /// Mean cosine between the normal of the triangle under a sample and that of the nearest one on the other side,
    /// over both sides; -1 for a mesh inside out. Absent for a cloud, or where no pair has two normals.
    std::optional<double> normal_consistency;
    /// The same of absolute values: does not see orientation.
    std::optional<double> normal_consistency_unsigned;
    /// Samples whose nearest triangle is degenerate and has no normal; they are left out of the two numbers above.
    std::size_t without_normal = 0;
    LengthUnit unit = LengthUnit::unknown;  ///< the mesh's, which all lengths here are in
    double diagonal = 0;  ///< of the mesh's bounding box
    MeshNumbers mesh;
    std::optional<MeshNumbers> truth;
    /// Pairs of the mesh's triangles, see self_intersections.hpp; absent when not asked for.
    std::optional<std::size_t> self_intersections;
    std::optional<CertifiedHausdorff> certified;
};

/// Measures `mesh` against `truth`.
///
/// Frames: both units declared and different: the truth is converted. One unknown: taken as equal. Both frames named
/// and different, or sizes and places that say that unit or frame differ (see comparable.hpp): Error, no number.
/// Origins may differ. All lengths are in the mesh's unit.
/// Pre: finite coordinates; at least one triangle of area above 0 on every mesh; a cloud has a point. Else Error.
/// Vertices in no triangle are not part of a surface. Degenerate triangles are segments or points of it.
/// Distances not above 2^-46 of the largest coordinate are 0: samples are no more exact. A mesh is at 0 of itself.
/// Ties: of equally near triangles the smallest row gives the normal.
/// Deterministic for a seed: any number of threads gives the same bytes. Cost: O((samples + F) log F).
/// Source: Aspert, Santa-Cruz, Ebrahimi 2002 (MESH) for the two sides; Knapitsch et al. 2017 for precision and recall.
Measurement measure(const TriangleMesh& mesh, const TriangleMesh& truth, const MeasureParams& params, Context& context);
Measurement measure(const TriangleMesh& mesh, const PointCloud& truth, const MeasureParams& params, Context& context);

}  // namespace scanmill
