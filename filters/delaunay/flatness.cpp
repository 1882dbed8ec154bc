// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/flatness.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr std::size_t chunk = 1 << 15;
constexpr std::string_view way_out = "region-grow makes a surface of flat scans, but not of points on a line";
constexpr std::string_view few_points =
    "`scanmill info` gives the number of points in a file; an earlier step may keep too few, such as voxel-thin with a "
    "large bin-size or min-points";

struct Farthest {
    double measure = -1;
    std::size_t row = 0;
};

/// The first row with the largest measure(position).
template <class Measure>
Farthest farthest(std::span<const Vec3> positions, unsigned threads, const Measure& measure) {
    std::vector<Farthest> per_chunk((positions.size() + chunk - 1) / chunk);
    for_each_chunk(threads, positions.size(), chunk, [&](std::size_t begin, std::size_t end) {
        Farthest best;
        for (std::size_t row = begin; row < end; ++row)
            if (const double value = measure(positions[row]); value > best.measure) best = {value, row};
        per_chunk[begin / chunk] = best;
    });
    Farthest best;
    for (const Farthest& candidate : per_chunk)
        if (candidate.measure > best.measure) best = candidate;
    return best;
}

std::size_t distinct_points(std::span<const Vec3> positions) {
    std::vector<Vec3> sorted(positions.begin(), positions.end());
    std::ranges::sort(sorted, is_lower);
    std::size_t distinct = positions.empty() ? 0 : 1;
    for (std::size_t i = 1; i < positions.size(); ++i) distinct += sorted[i] != sorted[i - 1];
    return distinct;
}

}  // namespace

Extents extents(std::span<const Vec3> positions, const Vec3& origin, unsigned threads) {
    Extents result;
    const Farthest largest =
        farthest(positions, threads, [&](const Vec3& p) { return (p.cwiseAbs() + origin.cwiseAbs()).maxCoeff(); });
    constexpr double last_places = 16;
    result.rounding = last_places * std::numeric_limits<double>::epsilon() * largest.measure;

    const Vec3 a = positions[0];
    const Farthest second = farthest(positions, threads, [&](const Vec3& p) { return (p - a).stableNorm(); });
    result.from_point = second.measure;
    if (!(result.from_point > 0)) return result;
    const Vec3 direction = (positions[second.row] - a) / result.from_point;
    const auto off_line = [&](const Vec3& p) -> Vec3 {
        const Vec3 offset = p - a;
        return offset - offset.dot(direction) * direction;
    };
    const Farthest third = farthest(positions, threads, [&](const Vec3& p) { return off_line(p).stableNorm(); });
    result.from_line = third.measure;
    if (!(result.from_line > 0)) return result;
    const Vec3 normal = direction.cross(off_line(positions[third.row])).stableNormalized();
    result.from_plane =
        farthest(positions, threads, [&](const Vec3& p) { return std::abs((p - a).dot(normal)); }).measure;
    return result;
}

void require_spatial(std::span<const Vec3> positions, const Frame& frame, unsigned threads) {
    if (positions.size() < 4)
        throw Error("needs at least 4 points that are not coplanar; the cloud has {}", positions.size())
            .hint(std::string(few_points));
    const Extents found = extents(positions, frame.origin, threads);
    if (found.from_point <= found.rounding) refuse_flat(positions, 0, found.from_point, frame);
    if (found.from_line <= found.rounding) refuse_flat(positions, 1, found.from_line, frame);
    if (found.from_plane <= found.rounding) refuse_flat(positions, 2, found.from_plane, frame);
}

void refuse_flat(std::span<const Vec3> positions, int dimension, double distance, const Frame& frame) {
    if (const std::size_t distinct = distinct_points(positions); distinct < 4)
        throw Error("needs at least 4 points that are not coplanar; the cloud has {} at {}",
                    count_text(positions.size(), "point", "points"),
                    count_text(distinct, "distinct position", "distinct positions"))
            .hint(std::string(few_points));
    const std::string_view shape = dimension == 0 ? "one position" : dimension == 1 ? "one line" : "one plane";
    throw Error("needs at least 4 points that are not coplanar; the cloud has {}, all within {:.2g} {} of {}{}",
                positions.size(), distance, symbol(frame.unit), shape,
                distance > 0 ? ", less than their coordinates can express" : "")
        .hint(distance > 0 && dimension == 0 ? "move the scan near the origin before it is written; so far from the "
                                               "origin, coordinates lose their last digits"
                                             : std::string(way_out));
}

}  // namespace scanmill
