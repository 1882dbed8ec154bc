// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
/// Estimates the normal of the scanned surface at every point, and decides which side is outside.
///
/// Source: Hoppe, DeRose, Duchamp, McDonald, Stuetzle 1992, "Surface reconstruction from unorganized points", sections
/// 3.2 and 3.3, for the plane and the spanning tree; Cazals, Pouget 2005 for the jet.

#include <optional>
#include <vector>

#include "scanmill/data/points.hpp"
#include "scanmill/data/quantity.hpp"
#include "scanmill/filter/context.hpp"

namespace scanmill {

struct NormalsParams {
    enum class Method {
        pca,  ///< normal of the plane that best fits the point and its neighbours
        jet   ///< normal, at the point, of the best fitting polynomial of degree two (see jet.hpp)
    };
    Method method = Method::pca;
    /// Number of nearest other positions that a normal is estimated from; 2 to 1000. If there are fewer, all others.
    /// The point itself is used in addition; its duplicates do not count.
    u32 neighbours = 16;
    enum class Orient {
        /// As sensor if there is a scanner's position or a column `approach`; else as column if there is a column
        /// `normal` that does not contradict itself; else as tree.
        automatic,
        sensor,  ///< towards the scanner
        known,  ///< as sensor; without a scanner's position or a column `approach`, the points stay as they are
        column,  ///< on the side of the column `normal`; only the direction is estimated
        tree,  ///< consistent with the neighbours, along a spanning tree
        none  ///< either of the two sides, by with_positive_sign()
    };
    Orient orient = Orient::automatic;
    /// The scanner's position: x, y, z in the scan's coordinates, frame.origin included. If it is empty, the column
    /// `approach` is used. Not allowed with Orient::column, Orient::tree and Orient::none.
    std::optional<std::vector<Length>> scanner;
};

struct NormalsResult {
    /// The input with the column `normal` (3 × float32, unit length). An existing column of that name is replaced, with
    /// a warning. With Orient::known and without a scanner, the input itself.
    PointCloud points;
    /// Number of points whose side is decided: all points; 0 with Orient::none, and if the input stays as it is.
    std::size_t oriented = 0;
    /// Number of points whose normals were turned towards the scanner.
    std::size_t by_sensor = 0;
    /// Number of points whose normals are on the other side than the scanner, or than the column `normal`.
    std::size_t against = 0;
    /// Number of points whose normal or whose side is doubtful.
    std::size_t doubtful = 0;
    /// Connected components of the neighbourhoods.
    std::size_t components = 0;
};

/// Estimates one normal for each distinct position; duplicates share it.
///
/// 1. Normal. `method` estimates the normal from the position and its `neighbours` nearest other positions. Of equally
///    near positions, the lower by x, then y, then z is nearer. A jet that is not determined is replaced by the plane.
/// 2. Sensor. Every point has a direction to the scanner: its column `approach` (3 numbers, of any length above 0), or
///    the direction to `scanner`. A normal is turned to the side of the mean direction of the points at its position.
///    It is not turned if the angle between them is above 85 degrees, or if the direction is missing (0 or NaN).
/// 3. Tree. Two positions are neighbours if one is among the `neighbours` nearest of the other. A spanning tree grows
///    from all positions with a side. The next position is the one with the least 1 - |cosine| between its normal and
///    the normal of a neighbour in the tree (ties: the lower position, then the lower neighbour). It takes the side of
///    that neighbour. A component without any side starts at its highest point (by z; ties: the lowest by x, then y).
///    The normal there is turned upwards, or away from the component's centroid if it is horizontal.
/// 4. Check. A component that started at its highest point is reversed if the column `approach`, or else `normal`, has
///    the other side at more than half of its positions. Without such a column it is reversed if it is closed and its
///    normals face inwards: their flux through the component, with the mean squared distance to the neighbours as the
///    area of a position, is negative. A component is closed if its area vectors sum to at most a quarter of its area.
/// 5. Column. With Orient::column, and with Orient::automatic without a scanner, a position with a column `normal`
///    keeps that side. A column contradicts itself if at more than 5 % of the positions most neighbours have it on the
///    other side; Orient::automatic then leaves it to the tree.
///
/// A point is doubtful if its neighbours lie on one line, so that they do not determine a plane (their flatness is
/// below 1e-6, see covariance.hpp). It is also doubtful if most of its neighbours' normals have a negative cosine with
/// its own, as at sharp edges and where the tree is wrong.
///
/// Throws Error for fewer than 3 distinct positions, positions on one line, a NaN or infinite coordinate, a parameter
/// out of range, Orient::sensor without directions, Orient::column without the column `normal`, and a column that is
/// not 3 numbers. Doubts its result if more than 5 % of the points are doubtful. Doubts a column `normal` that
/// contradicts itself, or that has the other side in regions with more than 5 % of the positions. Also doubts it if the
/// highest point alone decides the side of components that hold more than 5 % of the positions; the largest component
/// does not count.
///
/// Deterministic: the same bytes for any number of threads and any processor; the same normals for any order of the
/// points. Cost: O(n log n) time; about 90 + 8 `neighbours` bytes per point beside the result.
/// Metrics: `oriented`, `by-sensor`, `against`, `doubtful`, `components`.
NormalsResult normals(const PointCloud& cloud, const NormalsParams& params, Context& context);

}  // namespace scanmill
