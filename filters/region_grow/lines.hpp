// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Measured edge lines as constraints of the growth: prepares points and segments so that the segments become edges.
///
/// The points of the lines become points of the cloud. Scan points inside the sphere over a segment are left out. A
/// segment whose sphere is empty is an edge of every triangulation with empty circles (a Gabriel edge), so growth
/// usually finds it by itself. Scan points beside a segment are less exact than the segment and are left out as well.
///
/// *Spacing* is the local distance of the scan's points, see local_spacings() in search_radii.hpp. At a point of a line
/// it is that of the nearest scan point; for a segment, the least of its ends and its middle.
///
/// Source: probe-measured lines after Wang 2006, chapters 5 and 6; the Gabriel condition after Shewchuk 1997.

#include <array>
#include <vector>

#include "scanmill/data/features.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill::growing {

/// A segment of a line that is not an edge of the result.
struct NamedSegment {
    u32 polyline;
    /// The segment from entry `segment` of the polyline to the next entry.
    u32 segment;
    Vec3 middle;
};

struct PreparedLines {
    /// The scan without the points that are left out, in its order, then the points of lines that the scan does not
    /// contain, by x, y, z. These have the columns of the nearest scan point.
    PointCloud cloud;
    /// For each row of `cloud`, its row in the scan. Added points count on from the size of the scan.
    Array<u32> rows;
    /// Parts of segments as pairs of rows of `cloud`, without repeats.
    std::vector<std::array<u32, 2>> segments;
    /// For each part, the segment that it belongs to, with the middle of the part.
    std::vector<NamedSegment> names;
    /// For each part, the spacing.
    std::vector<double> spacings;
    /// Scan points that are left out.
    std::size_t near_lines = 0;
    /// Parts without support, and segments that yield to another one.
    std::vector<NamedSegment> unsupported, crossing;
};

/// Prepares the lines; the file comment defines the terms.
///
/// - Segments of zero length and repeats of a segment are ignored. Points of lines with equal positions are one point.
///   A scan point at the position of a line's point is that point.
/// - Two segments cross if their distance is below a tenth of the spacing and they have no common end. With a common
///   end, they cross if the other end of one is that near to the other one. The segment with the larger uncertainty
///   yields as a whole (ties: the later one). The uncertainty of a segment is the larger number of its ends in the
///   scan's column `uncertainty`; unknown if an end is not in the scan. An unknown one is larger than all others.
/// - Segments longer than 1.5 spacings are divided evenly, into parts of at most one spacing.
/// - A part is unsupported if no scan point is within 3 spacings of its middle. So is a segment that has more parts
///   than the scan has points.
/// - A scan point is left out if it is nearer to a part than half the spacing, or inside the sphere over the part.
/// - A scan point with a normal in the column `normal` is left out if it is nearer than one spacing and its normal
///   differs by more than 30 degrees from those of both sides: it straddles the edge. The sides' normals are those of
///   the two scan points from 1 to 3 spacings from the part's middle whose normals differ most.
///
/// Throws Error for an index out of range in the lines, another unit or frame, a point of a line that is not finite, or
/// fewer than three distinct points in the scan. Cost: O(n log n) in the scan's points, and a sort of the segments.
PreparedLines prepare_lines(const PointCloud& scan, const FeatureGraph& lines, Context& context);

}  // namespace scanmill::growing
