// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// The distance between a mesh and its truth, in numbers and by vertex, and the quality of the mesh by itself.
///
/// A distance is measured from a point of one surface to the nearest point of the other's triangles. Both directions
/// are measured: distances *to the truth* show surplus surface of the mesh, distances *from the truth* show missing
/// surface. Distances are computed at points spread evenly over the area; largest distances also include every vertex.
/// A truth that is a cloud has no area, so its points are the samples of that direction. Distances from the mesh to the
/// points of a cloud have names of their own.

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
    /// Number of points spread over each mesh, at least fewest_samples.
    u32 samples = 100'000;
    /// Distances that count as near for precision and recall; each above 0. Relative lengths refer to the mesh.
    std::vector<Length> thresholds = std::vector(1, Length::percent_of_diagonal(0.5));
    /// Whether pairs of intersecting triangles are counted. This takes about as long as everything else.
    bool self_intersections = true;
    /// The caller asserts that unit and frame are equal. Sizes and positions that suggest otherwise then only cause a
    /// warning.
    bool same_frame = false;
    /// Whether bounds of the Hausdorff distance are computed and reported; needs a mesh as truth.
    bool certify = false;
    /// The bounds are refined until upper - lower is at most this share of upper; in (0, 1).
    Ratio gap = Ratio::percent(1);
    /// Whether points of a cloud are used if their nearest point on the mesh is on its boundary: on an edge of only one
    /// triangle, or on an end of such an edge. The distance of such a point shows where the mesh ends, not how well it
    /// fits. `exclude` needs points as truth.
    Borders borders = Borders::include;
    /// Largest number of cuts of triangle parts. After them, the refinement ends with the bounds reached so far.
    u64 most_cuts = 10'000'000;
};

/// Shares of samples within a threshold, in [0, 1].
struct NearShares {
    double threshold = 0;
    /// Share of the mesh within the threshold of the truth; absent if the truth is a cloud.
    std::optional<double> precision;
    /// Share of the truth within the threshold of the mesh.
    double recall = 0;
    /// Harmonic mean of precision and recall, 0 if both are 0; absent if precision is absent.
    std::optional<double> f_score;
};

struct Measurement {
    /// Distances from the mesh to the truth's triangles; absent if the truth is a cloud.
    std::optional<DistanceNumbers> to_truth;
    /// Distances from the mesh to the nearest points of a cloud. They are not distances between surfaces, because the
    /// cloud's spacing keeps them above 0. Absent if the truth is a mesh.
    std::optional<DistanceNumbers> to_points;
    /// Distances from the truth's area, or from its points, to the mesh's triangles.
    DistanceNumbers from_truth;
    /// Number of points of a cloud that from_truth, and every number derived from it, leaves out. Absent unless borders
    /// are excluded.
    std::optional<std::size_t> beyond_borders;
    /// The numbers of both directions with equal weight; for a cloud, equal to from_truth.
    DistanceNumbers both;
    /// The largest distance found at a sample, at a vertex, or by largest_distance(); absent for a cloud. Not above the
    /// true Hausdorff distance, except for rounding, and not below certified->lower.
    std::optional<double> hausdorff;
    /// Half the sum of the two directions' means; absent for a cloud.
    std::optional<double> chamfer;
    std::vector<NearShares> near;
    /// Mean cosine between the normals of a sample's triangle and of the nearest triangle on the other surface, over
    /// both directions. It is -1 for a mesh that is inside out. Absent for a cloud, or if every pair lacks a normal.
    std::optional<double> normal_consistency;
    /// Mean absolute value of the cosines of normal_consistency; it does not depend on orientation.
    std::optional<double> normal_consistency_unsigned;
    /// Number of samples that both consistencies leave out, because their nearest triangle is degenerate and has no
    /// normal.
    std::size_t without_normal = 0;
    LengthUnit unit = LengthUnit::unknown;  ///< unit of all lengths here: the mesh's
    double diagonal = 0;  ///< of the mesh's bounding box
    MeshNumbers mesh;
    std::optional<MeshNumbers> truth;
    /// Pairs of the mesh's triangles, see scanmill::self_intersections(); absent unless requested.
    std::optional<std::size_t> self_intersections;
    std::optional<CertifiedHausdorff> certified;
    /// By vertex of the mesh, including vertices in no triangle: the distance to the nearest triangle or point of the
    /// truth. If the truth is a closed mesh (truth->topology.closed), distances are negative at vertices that it
    /// encloses, whatever its orientation. Distances within rounding are 0, without sign.
    Array<double> vertex_distances;
};

/// Measures `mesh` against `truth`.
///
/// Frames: if both units are declared and differ, the truth is converted. An unknown unit is taken as equal. Throws
/// Error if the frames have different names, or if sizes and positions show that unit or frame differ (see
/// measurable.hpp). Origins may differ. All lengths are in the mesh's unit.
/// Pre: finite coordinates; at least one triangle of area above 0 on every mesh; at least one point in a cloud.
/// Otherwise throws Error. Vertices in no triangle are not part of a surface. Degenerate triangles count as segments or
/// points.
/// Distances of at most 2^-46 of the largest coordinate are set to 0, because samples are rounded that much. So a mesh
/// has distance 0 to itself.
/// Ties: of equally near triangles, the one with the lowest row gives the normal.
/// Deterministic for a seed; bytes do not depend on the number of threads. Cost: O((samples + F) log F).
/// Source: Aspert, Santa-Cruz, Ebrahimi 2002 (MESH) for the two directions; Knapitsch et al. 2017 for precision and
/// recall.
Measurement measure(const TriangleMesh& mesh, const TriangleMesh& truth, const MeasureParams& params, Context& context);
Measurement measure(const TriangleMesh& mesh, const PointCloud& truth, const MeasureParams& params, Context& context);

/// The mesh with Measurement::vertex_distances as the vertex column `distance-to-truth`, a column of lengths. Replaces
/// an existing column of that name. Shares the mesh's memory. Pre: `measured` is a measurement of this mesh.
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
