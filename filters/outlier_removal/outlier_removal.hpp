// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Removes points that do not belong to the scanned surface: isolated points, small groups of them, points that hover
/// above the surface, and points that are scattered over a volume.
///
/// No distance decides for the whole scan. Every point is compared with its neighbours, so parts of a scan may be
/// several times as dense as others, and half as many outliers as points do not change the judgement of the points.
///
/// Source: Rusu, Marton, Blodow, Dolha, Beetz 2008, section 4.1, for the mean distances (PCL's
/// StatisticalOutlierRemoval); Breunig, Kriegel, Ng, Sander 2000 for densities relative to those of the neighbours.
/// With `min_component` 0 the result is that of PCL's StatisticalOutlierRemoval or RadiusOutlierRemoval, computed in
/// doubles.

#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct OutlierRemovalParams {
    enum class Method {
        statistical,  ///< suspects: points with a mean distance to the nearest points far above that of these points
        radius  ///< suspects: points with fewer than `neighbours` other points at most `radius` away
    };
    Method method = Method::statistical;
    /// Number of nearest other points, from 1 to 1000; all others if there are fewer. A point does not count itself,
    /// but it counts its duplicates, at distance 0.
    u32 neighbours = 16;
    /// Number of standard deviations that are tolerated in the test of Method::statistical; above 0.
    double factor = 3;
    /// Points at most this far from each other are connected; with Method::radius also the radius of the test. 0 or
    /// more. A length in `spacing` is a multiple of the median distance from a position to the nearest other position.
    Length radius = Length::spacings(3);
    /// Connected components with less than this share of all distinct positions, and less than this share of the area,
    /// are removed; from 0 to 1. With 0, components are not computed, and exactly the suspects are removed.
    Ratio min_component = Ratio::percent(0.1);
    /// Keeps all points and adds the column `outlier` (uint8): 1 for the points that would be removed, else 0.
    bool mark = false;
};

struct OutlierRemovalResult {
    /// The kept points, or with `mark` all points, in input order with all columns. An existing column `outlier` is
    /// replaced, with a warning.
    PointCloud points;
    /// Rows of the points that are not outliers, ascending.
    Array<u32> kept;
    /// kept + removed = input, also with `mark`.
    std::size_t removed = 0;
    /// Number of points that failed the test of the method, removed or not.
    std::size_t suspects = 0;
    /// Number of suspects that hover above the surface that their neighbours form.
    std::size_t hovering = 0;
    /// Number of points in clusters that are scattered over a volume.
    std::size_t scattered = 0;
    /// Number of connected components that are kept; 0 if min_component is 0.
    std::size_t components = 0;
    /// Largest distance that passes the test of the method. 0 with Method::statistical and components.
    double limit = 0;
    /// With Method::statistical and components: the largest natural logarithm that passes the test, of a mean distance
    /// over the median of the neighbours' mean distances. Otherwise 0.
    double log_limit = 0;
};

/// Decides for every distinct position; duplicates are treated alike. The mean distance of a position is that to its
/// `neighbours` nearest other positions. Of equally near positions, the lower in order of x, then y, then z is nearer.
///
/// With min_component 0, points whose distance is above the limit are removed, as by PCL. Method::statistical: the mean
/// distance to the `neighbours` nearest other points; the limit is the mean over all points plus `factor` standard
/// deviations (divisor n - 1). Method::radius: the distance to the `neighbours`-th nearest other point; the limit is
/// `radius`. Points at the limit pass. Otherwise:
///
/// 1. Test. Method::statistical: each mean distance is divided by the median of the neighbours' mean distances. A
///    position is a suspect if the logarithm of this ratio is above the limit: the median of all logarithms plus
///    `factor` standard deviations, estimated as 1.4826 median absolute deviations; at least 0.25. Method::radius: as
///    above.
/// 2. Surface. The usual mean distance is the median over positions in a surface, of 10,000. A suspect hovers if its
///    mean distance is above the usual one, and if its nearest neighbour and the plane that fits its neighbours best
///    are both farther away than 0.6 of it. A position is sparse if its mean distance is above 2.5 times the usual one.
///    A sparse position is scattered if the surface variation (see covariance.hpp) of its neighbours and itself is
///    above 0.05. Suspects and sparse positions lie in their surface only if this variation is at most 0.0125, and the
///    plane of the neighbours is at most half of their median mean distance away; all other positions count as in their
///    surface.
/// 3. Clusters. Scattered positions, more than half of whose neighbours are scattered, form clusters of mutual
///    neighbours. A cluster is cut off, unless 15 % of it have a mutual neighbour that is neither scattered nor
///    a suspect.
/// 4. Connection. Hovering positions and those cut off are connected to nothing. Two others are connected
///    - if neither is a suspect and they are at most `radius` apart, or
///    - if one is among the nearest of the other, their distance is at most 6 times the mean distance of either, and
///      the former is also among the nearest of the latter or the latter lies in its surface. Method::radius: the
///      distance is also at most 2 `radius`.
///    A sparse suspect that does not lie in its surface is connected only to the nearest of the others.
/// 5. Components. A component is removed if it has at most `neighbours` positions, if more than half of it is
///    scattered, or if it is below `min_component`, both by positions and by area. The area of a position is the square
///    of its mean distance, and 0 if it is not in its surface. The first rule never removes the largest component, and
///    a scan that is scattered as a whole stays.
///
/// The numbers were chosen on models with 0 to 100 % outliers in the doubled box, on spheres of two densities, and on
/// 85 sets of vertices of CGAL's models; see README.md. Hovering: with 0.5, tips of sharp corners hover; with 0.7, more
/// outliers stay beside the surface. Sparse: with 2, vertices of an uneven CAD model are cut off; with 3, a
/// third of the outliers of a model with 3,800 points stays. Least limit: with 0.15, more points of a noisy sphere
/// are lost; with 0.3, more outliers beside the surface stay.
///
/// Throws Error for an empty cloud, more than 2^32 - 1 points, a NaN or infinite coordinate, and a parameter out of
/// range. Unless `mark` is set, also throws if every point is an outlier. Doubts its result if more than 10 % of the
/// points are outliers, or if outliers have more than 10 % of the area.
///
/// Deterministic: the same bytes for any number of threads; the same points for any order of the input. Cost: O(n log
/// n) time while few points lie within `radius` of a point. Memory beside the result: about 110 + 4
/// `neighbours` bytes per point. Metrics: `kept`, `removed`, `suspects`, `limit` or `log-limit`; also `hovering`,
/// `scattered` and `components` unless `min_component` is 0.
OutlierRemovalResult outlier_removal(const PointCloud& cloud, const OutlierRemovalParams& params, Context& context);

}  // namespace scanmill
