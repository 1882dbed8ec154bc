// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Compares a scan with its nominal mesh: the signed deviation of every point, statistics with a tolerance, the places
/// that deviate most, and a map on the nominal.
///
/// The deviation of a point is its distance to the nearest point of the nominal: positive on the side of the
/// triangles' normals, that is outside the part, and negative inside. The points of a mesh are its vertices that are in
/// a triangle.
///
/// Source: Bærentzen & Aanæs 2005 for the sign.

#include <optional>
#include <string_view>
#include <vector>

#include "inspect/deviation_numbers.hpp"
#include "scanmill/data/mesh.hpp"
#include "scanmill/data/metrics.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/data/transform.hpp"
#include "scanmill/filter/context.hpp"
#include "scanmill/geometry/colour/colour_scale.hpp"

namespace scanmill {

struct InspectParams {
    enum class Borders { include, exclude };
    enum class By { none, components, patches };
    /// Low and high; low ≤ high.
    std::vector<Length> tolerance;
    /// Whether points beyond the nominal's border count.
    Borders borders = Borders::exclude;
    /// Points farther than this many standard deviations from the mean are cut from the statistics, once; above 0.
    std::optional<double> sigma;
    /// Points farther from the nominal are too far to belong to it. If absent: 10 times the larger of the tolerance's
    /// two amounts; if points are farther, at least 3 spacings of the scan.
    std::optional<Length> max_distance;
    /// Largest distance of the nominal from the surface that it approximates; for the comparison with the tolerance.
    Length chord_error;
    /// The parts of the nominal that have numbers of their own.
    By by = By::none;
    /// Number of points that get a label, at most 1,000, and the least distance between two of them. Relative lengths
    /// refer to the scan.
    u32 labels = 10;
    Length label_distance = Length::percent_of_diagonal(5);
    /// From 1 to 10,000.
    u32 bins = 41;
};

/// The treatment of a point.
enum class Finding : u8 {
    counted,
    cut,  ///< by sigma; has a deviation, but is not in the statistics
    undecided,  ///< the nearest point of the nominal does not decide the sign
    beyond_border,
    too_far
};

struct InspectedPart {
    /// Points that are nearest to this part and not too far.
    std::size_t points = 0;
    /// Absent if no point is counted.
    std::optional<DeviationNumbers> numbers;
};

struct Label {
    u32 row;
    Vec3 position;  ///< in world coordinates
    double deviation;
};

struct Inspection {
    /// Every point has one finding: points = counted + cut + undecided + beyond_border + too_far. Points beyond the
    /// border are counted like others if borders are included.
    std::size_t points = 0, cut = 0, undecided = 0, beyond_border = 0, too_far = 0;
    DeviationNumbers numbers;  ///< over all counted points
    /// In the order of the parts; empty for By::none.
    std::vector<InspectedPart> parts;
    /// Shares of the counted points, see histogram_of(). The range is that of `scale`.
    std::vector<double> histogram;
    /// The largest absolute deviation first.
    std::vector<Label> labels;
    Tolerance tolerance;
    double max_distance = 0, chord_error = 0;
    ColourScale scale;
    LengthUnit unit = LengthUnit::unknown;
    double diagonal = 0;  ///< the diagonal of the nominal's bounding box
    bool aligned = false;  ///< whether a transform was given
    /// The rms of its motion, in `unit`; without a value if the motion has none, or if there are several motions.
    std::optional<double> alignment_rms;

    /// By row of the scan: NaN unless the point is counted or cut.
    Array<double> deviations;
    /// By row of the scan: the number of the point's label, or 0.
    Array<u32> label_numbers;
    /// By row of the scan: the number of its part, from 2 on, or 0. Empty for By::none.
    Array<u32> part_numbers;
    /// The nominal with edges of at most max(0.5 % of its diagonal, 3 spacings of the scan), or longer if it would have
    /// more than about 2 million triangles. Vertex columns `deviation` (the mean over the counted points whose nearest
    /// points are within that length, on the same side, nearer ones with more weight; NaN without any) and `colour`.
    /// The face columns are those of the nominal, and `part`.
    TriangleMesh on_nominal;
};

/// Inspects a scan.
///
/// Counted apart, in this order: points farther than `max_distance`; points beyond the border, unless included; points
/// without a sign. The sign is undecided if the nearest point is on an edge or vertex where the triangles fold back,
/// are oriented inconsistently or are more than two, unless all of them agree. A point on the surface, within rounding,
/// has deviation 0. A point is beyond the border if its nearest point is on it, and the point is not above or below the
/// surface there: the way to it leads outwards across an edge of the border. Vertices of the nominal at one position
/// are one vertex.
///
/// The scale of colours and histogram is [2 low, 2 high] of the tolerance [low, high]. Where low ≥ 0, it begins at
/// -2 high; where high ≤ 0, it ends at -2 low. If both are 0, the largest absolute deviation takes their place.
///
/// Pre:  one unit and one frame for both; origins may differ. Throws Error otherwise; for coordinates that are not
///       finite, no points, a nominal without a triangle that has an area, parameters out of range, and if no point is
///       counted.
/// Post: ties between equally near triangles go to the lowest row. Bytes do not depend on the number of threads.
///       Doubts a nominal that is inside out or inconsistently oriented, and a scan of which most points are too far or
///       undecided.
///       Warns if the chord error is more than a tenth of the tolerance.
/// Cost: O(n log F) for n points and F triangles, and the points near every vertex of the map; on two cores about 1 s
/// per
///       million points.
Inspection inspect(const PointCloud& scan, const TriangleMesh& nominal, const Transforms* transforms,
                   const InspectParams& params, Context& context);
Inspection inspect(const TriangleMesh& scan, const TriangleMesh& nominal, const Transforms* transforms,
                   const InspectParams& params, Context& context);

/// The scan with the columns `deviation`, `label`, `part` (unless By::none) and `colour`. An earlier column `colour` is
/// kept as `scan-colour`. Shares the scan's memory.
PointCloud deviation_of(const PointCloud& scan, const Inspection& inspected, Context& context);
TriangleMesh deviation_of(const TriangleMesh& scan, const Inspection& inspected, Context& context);

/// Parts whose numbers are metrics.
inline constexpr std::size_t most_parts = 100;

/// The inspection under the metric names of workflows. A number that does not exist has no metric.
///
///   points, counted, cut, undecided, beyond-borders, too-far
///   min, max, mean, rms, standard-deviation, mean-above, mean-below, in-tolerance, above, below, p1 … p99
///   points, counted, min … p99 with @2, @3, …           the parts, in their order, at most most_parts
///   histogram, histogram@2, …, range-low, range-high
///   label, label-x, label-y, label-z and the same with @2, …
///   tolerance-low, tolerance-high, max-distance, chord-error, aligned, alignment-rms, parts, diagonal
Metrics metrics_of(const Inspection& inspected);

}  // namespace scanmill
