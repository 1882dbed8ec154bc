// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distance between a mesh and its truth, in numbers and by vertex, and the quality of the mesh by itself.
///
/// Distances are from points of one surface to the nearest point of the other's triangles, in both directions: *to the
/// truth* shows surplus surface of the mesh, *from the truth* shows missing surface. They are computed at points spread
/// evenly over the area; largest distances also at every vertex. If the truth is a cloud, it has no area: its points
/// are the samples of that direction, and distances from the mesh to its points have names of their own.

#include <optional>
#include <vector>

#include "measure/distance_numbers.hpp"
#include "measure/mesh_numbers.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/metrics.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/distance/certified_hausdorff.hpp"

namespace scanmill {

constexpr u32 fewest_samples = 32;

struct MeasureParams {
    enum class Borders { include, exclude };
    /// Points on each mesh, at least fewest_samples.
    u32 samples = 100'000;
    /// Distances that count as near for precision and recall; each above 0. Relative ones refer to the mesh.
    std::vector<Length> thresholds = std::vector(1, Length::percent_of_diagonal(0.5));
    /// Whether pairs of intersecting triangles are counted; takes about as long as everything else.
    bool self_intersections = true;
    /// Unit and frame are equal for certain: sizes and positions that suggest otherwise only cause a warning.
    bool same_frame = false;
    /// Whether bounds of the Hausdorff distance are computed and reported; needs a mesh as truth.
    bool certify = false;
    /// The bounds are refined until upper - lower is at most this share of upper; in (0, 1).
    Ratio gap = Ratio::percent(1);
    /// Whether points of a cloud count whose nearest point on the mesh is on a boundary edge (an edge of only one
    /// triangle) or on a vertex of one. Their distance shows where the mesh ends, not how well it fits.
    /// Excluding needs points as truth.
    Borders borders = Borders::include;
    /// Parts of triangles cut before the refinement ends with the bounds reached.
    u64 most_cuts = 10'000'000;
};

/// Shares of samples within a threshold, in [0, 1].
struct NearShares {
    double threshold = 0;
    /// Share of the mesh within the threshold of the truth; absent if the truth is a cloud.
    std::optional<double> precision;
    /// Share of the truth within the threshold of the mesh.
    double recall = 0;
    /// Harmonic mean of the two, 0 if both are 0; absent with precision.
    std::optional<double> f_score;
};

struct Measurement {
    /// From the mesh to the truth's triangles; absent if the truth is a cloud.
    std::optional<DistanceNumbers> to_truth;
    /// From the mesh to the nearest point of a cloud: not a distance between surfaces, because it cannot fall below the
    /// cloud's spacing. Absent if the truth is a mesh.
    std::optional<DistanceNumbers> to_points;
    /// From the truth, its area or its points, to the mesh's triangles.
    DistanceNumbers from_truth;
    /// Points of a cloud left out of from_truth and all that follows from it; absent unless borders are excluded.
    std::optional<std::size_t> beyond_borders;
    /// Both directions with equal weight; for a cloud, equal to from_truth.
    DistanceNumbers both;
    /// The largest distance found at a sample, at a vertex, or by largest_distance(); absent for a cloud. Not above the
    /// true Hausdorff distance, except for rounding, and not below certified->lower.
    std::optional<double> hausdorff;
    /// Half the sum of the two directions' means; absent for a cloud.
    std::optional<double> chamfer;
    std::vector<NearShares> near;
    /// Mean cosine between the normal of a sample's triangle and that of the nearest one on the other surface, over
    /// both directions; -1 for a mesh inside out. Absent for a cloud, or if no pair has two normals.
    std::optional<double> normal_consistency;
    /// The same with absolute values, so independent of orientation.
    std::optional<double> normal_consistency_unsigned;
    /// Samples whose nearest triangle is degenerate and has no normal; left out of the two numbers above.
    std::size_t without_normal = 0;
    LengthUnit unit = LengthUnit::unknown;  ///< the mesh's, of all lengths here
    double diagonal = 0;  ///< of the mesh's bounding box
    MeshNumbers mesh;
    std::optional<MeshNumbers> truth;
    /// Pairs of the mesh's triangles, see scanmill::self_intersections(); absent unless requested.
    std::optional<std::size_t> self_intersections;
    std::optional<CertifiedHausdorff> certified;
    /// By vertex of the mesh, also of those in no triangle: the distance to the nearest triangle or point of the truth.
    /// Negative where the truth encloses the vertex, if it is a closed mesh (truth->topology.closed): inside is inside
    /// whichever way the truth faces. 0 within rounding, without sign.
    Array<double> vertex_distances;
};

/// Measures `mesh` against `truth`.
///
/// Frames: if both units are declared and differ, the truth is converted. An unknown unit is taken as equal. Frames
/// with different names, or sizes and positions that show that unit or frame differ (see measurable.hpp), are an Error.
/// Origins may differ. All lengths are in the mesh's unit.
/// Pre: finite coordinates; at least one triangle of area above 0 on every mesh; a cloud has a point. Else Error.
/// Vertices in no triangle are not part of a surface. Degenerate triangles are segments or points of it.
/// Distances of at most 2^-46 of the largest coordinate are 0, the rounding of samples. A mesh has distance 0 to
/// itself.
/// Ties: of equally near triangles the smallest row gives the normal.
/// Deterministic for a seed; bytes do not depend on the number of threads. Cost: O((samples + F) log F).
/// Source: Aspert, Santa-Cruz, Ebrahimi 2002 (MESH) for the two directions; Knapitsch et al. 2017 for precision and
/// recall.
Measurement measure(const TriangleMesh& mesh, const TriangleMesh& truth, const MeasureParams& params, Context& context);
Measurement measure(const TriangleMesh& mesh, const PointCloud& truth, const MeasureParams& params, Context& context);

/// The mesh with Measurement::vertex_distances as the vertex column `distance-to-truth`, of lengths. Replaces a column
/// of that name. Shares the mesh's memory. Pre: measured from this mesh.
TriangleMesh deviation_of(const TriangleMesh& mesh, const Measurement& measured);

/// A measurement under the metric names of workflows, gates and reports. A number that is absent from the measurement
/// has no metric.
///
///   mean, mean-spread, rms, p50, p90, p95, p99, max     over both directions (cloud as truth: from the truth)
///   the same with -to-truth, -from-truth, -to-points    one direction
///   beyond-borders                                      if borders are excluded
///   hausdorff, chamfer
///   threshold, f-score, precision, recall               at the first threshold
///   the same with @2, @3, …                             at the others, in their order
///   normal-consistency, normal-consistency-unsigned, without-normal
///   hausdorff-lower, hausdorff-upper, certified, cuts
///   diagonal                                            of the mesh's bounding box
///   triangles, area, volume, components, genus, boundary-loops, …, self-intersections      the mesh
///   the same with truth- in front, but no self-intersections                              the truth, if a mesh
Metrics metrics_of(const Measurement& measured);

}  // namespace scanmill
