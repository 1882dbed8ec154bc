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
        jet   ///< normal at the point of the polynomial of degree two that fits them best (see jet.hpp)
    };
    Method method = Method::pca;
    /// Number of nearest other positions, from 2 to 1000; all others if there are fewer. The point itself counts in
    /// addition; its duplicates do not count.
    u32 neighbours = 16;
    enum class Orient {
        automatic,  ///< as sensor if there is a scanner's position or a column `approach`, else as tree
        sensor,  ///< towards the scanner
        known,  ///< as sensor; without a scanner's position or a column `approach`, the points stay as they are
        tree,  ///< as the neighbours, along a spanning tree
        none  ///< one of the two, by with_positive_sign()
    };
    Orient orient = Orient::automatic;
    /// The scanner's position: x, y, z in the scan's coordinates, frame.origin included. Empty: the column `approach`.
    /// Not with Orient::tree or none.
    std::optional<std::vector<Length>> scanner;
};

struct NormalsResult {
    /// The input with the column `normal` (3 × float32, unit length). An older one is replaced, with a warning. The
    /// input itself with Orient::known, if no scanner is known.
    PointCloud points;
    /// Points whose side is decided: all, or with Orient::none 0.
    std::size_t oriented = 0;
    /// Number of those `oriented` normals that were turned towards the scanner.
    std::size_t by_sensor = 0;
    /// Points whose normal or whose side is doubtful.
    std::size_t doubtful = 0;
    /// Connected components of the neighbourhoods.
    std::size_t components = 0;
};

/// One normal for each distinct position; duplicates share it.
///
/// 1. Normal. By `method` from the position and its `neighbours` nearest other positions; ties: the
///    lower by x, then y, then z. A jet that is not determined is the plane.
/// 2. Sensor. Every point has a direction to the scanner: its column `approach` (3 numbers, of any length above 0) or
///    that to `scanner`. A normal is turned to the side of the mean direction of the points at its position, unless
///    they are nearly perpendicular (the angle between them is above 85 degrees), or the direction is missing (0 or
///    NaN).
/// 3. Tree. Two positions are neighbours if one is among the `neighbours` nearest of the other. Starting from all
///    positions with a side, the next is always the one with the least 1 - |cosine| to the normal of a neighbour that
///    has a side (ties: the lower position, then the lower neighbour), and takes its side. A component without
///    any starts at its highest point (by z; ties: the lowest by x, then y), whose normal is turned upwards, or
///    if it is horizontal away from the component's centroid.
///
/// A point is doubtful if its neighbours lie on one line, so that they do not determine a plane (their flatness is
/// below 1e-6, see covariance.hpp), or if the sides of most of its neighbours' normals disagree with its own (a
/// negative cosine), as at sharp edges and where the tree erred.
///
/// Throws Error for fewer than 3 distinct positions, positions on one line, a NaN or infinite coordinate, a parameter
/// out of range, Orient::sensor without directions, and a column `approach` that is not 3 numbers. Doubts its result if
/// more than 5 % of the points are doubtful, and if components with more than 5 % of the positions beside the largest
/// are turned by their highest points alone.
///
/// Deterministic: the same bytes for any number of threads and any processor; the same normals for any order of the
/// points. Cost: O(n log n) time; about 90 + 8 `neighbours` bytes per point beside the result.
/// Metrics: `oriented`, `by-sensor`, `doubtful`, `components`.
NormalsResult normals(const PointCloud& cloud, const NormalsParams& params, Context& context);

}  // namespace scanmill
