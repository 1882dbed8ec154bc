// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/given_normals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::growing {

namespace {

constexpr double opposed_cosine = -0.9;  // cosine of 154 degrees
/// Heights of a neighbour along the normal, as shares of its distance. A neighbour on the same surface is at most
/// `most_height` high. Heights below `least_height` come from rounding and curvature.
constexpr double most_height = 0.3;
constexpr double least_height = 0.01;

void require_vectors(const Column& column, std::size_t points) {
    if (column.components() == 3 && column.rows() == points) return;
    const std::string size =
        column.is_list() ? "lists of varying length" : fmt::format("{} numbers per row", column.components());
    throw Error("the column 'normal' holds {} in {} rows; normals are 3 numbers in each of the {} rows", size,
                column.rows(), points)
        .hint("rename or drop the column, then normals are computed from the neighbours");
}

/// The row's normal as a unit vector; nullopt if it is zero or not finite.
std::optional<Vec3> direction(const Column& column, u32 row) {
    const Vec3 normal(column.number(row, 0), column.number(row, 1), column.number(row, 2));
    const double largest = normal.cwiseAbs().maxCoeff();
    if (!normal.allFinite() || !(largest > 0)) return std::nullopt;
    return (normal / largest).normalized();
}

/// Per point the normal of its row; if it has several rows, the first by x, y, z.
std::vector<std::optional<Vec3>> directions_of(const Column& column, const DistinctPoints& points) {
    std::vector<std::optional<Vec3>> directions(points.size());
    for (u32 point = 0; point < points.size(); ++point) directions[point] = direction(column, points.rows[point]);
    for (const auto& [point, row] : points.repeats) {
        std::optional<Vec3>& known = directions[point];
        const std::optional<Vec3> other = direction(column, row);
        if (other && (!known || is_lower(*other, *known))) known = other;
    }
    return directions;
}

/// Propagates the signs of the given normals to the principal ones, from neighbour to neighbour in breadth-first order.
/// A component of the neighbour graph without a given normal keeps the sign of its lowest point.
void propagate_signs(const Neighbourhoods& neighbourhoods, std::vector<bool> known, Array<Vec3>& directions) {
    Array<double> agreement(known.size());
    std::ranges::fill(agreement, 0);
    std::vector<bool> queued = known;
    std::vector<u32> ring, next;
    for (u32 point = 0; point < known.size(); ++point)
        if (known[point]) ring.push_back(point);
    for (u32 lowest = 0;; ring.swap(next)) {
        next.clear();
        for (u32 point : ring)
            for (u32 other : neighbourhoods.of(point)) {
                if (known[other]) continue;
                agreement[other] += directions[point].dot(directions[other]);
                if (queued[other]) continue;
                queued[other] = true;
                next.push_back(other);
            }
        while (next.empty() && lowest < known.size()) {
            if (!known[lowest]) next.push_back(lowest);
            ++lowest;
        }
        if (next.empty()) return;
        std::ranges::sort(next);
        for (u32 point : next) {
            known[point] = queued[point] = true;
            if (agreement[point] < 0) directions[point] = -directions[point];
        }
    }
}

/// Whether a given normal lies in the surface rather than across it: it is far from the principal normal, and the
/// neighbours extend along it. The points of a single scan line have no principal normal, but do not extend along any
/// direction across the line either.
bool lies_in_surface(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, u32 point, const Vec3& given,
                     const Vec3& principal) {
    constexpr double least_cosine = 0.5;  // cosine of the 60 degrees that the messages name
    constexpr double least_share = 0.25;  // a normal tilted by 60 degrees has 3/8 in an even neighbourhood
    if (std::abs(given.dot(principal)) >= least_cosine) return false;
    double along = 0, whole = 0;
    for (u32 other : neighbourhoods.of(point)) {
        const Vec3 offset = points.positions[other] - points.positions[point];
        along += given.dot(offset) * given.dot(offset);
        whole += offset.squaredNorm();
    }
    return along > least_share * whole;
}

/// Refuses the normals if most of them lie in the surface, and warns if many do. Where noise hides the surface, half of
/// all correct normals are that far from the principal ones. The limit for a refusal is higher than that.
void require_across(std::size_t lying, std::size_t given, Context& context) {
    const double share = static_cast<double>(lying) / static_cast<double>(given);
    const std::string found = fmt::format(
        "{} of {} normals of the column 'normal' ({:.3g} %) are more than 60 deg from the normal of their neighbours, "
        "as if they lay in the surface",
        lying, given, 100 * share);
    constexpr double most = 0.75, remarkable = 0.25;
    if (share > most)
        throw Error(found).hint(
            "check that the column holds normals; drop or rename it, then normals are computed from the neighbours");
    if (share > remarkable) context.warn(found + "; without the column, normals would be computed from the neighbours");
}

}  // namespace

GivenNormals take_given_normals(const PointCloud& cloud, const DistinctPoints& points,
                                const Neighbourhoods& neighbourhoods, PointNormals& normals, Context& context) {
    const Column* column = cloud.columns.find("normal");
    if (!column) return {};
    require_vectors(*column, cloud.size());
    const std::vector<std::optional<Vec3>> directions = directions_of(*column, points);
    std::vector<bool> given(points.size(), false);
    std::size_t lying = 0, count = 0;
    for (u32 point = 0; point < points.size(); ++point) {
        if (!directions[point]) continue;
        const Vec3& normal = *directions[point];
        if (lies_in_surface(points, neighbourhoods, point, normal, normals.directions[point])) ++lying;
        normals.directions[point] = normal;
        given[point] = true;
        ++count;
    }
    const std::size_t missing = points.size() - count;
    if (count == 0) {
        context.warn(
            fmt::format("all {} normals are zero or not finite; normals are computed from the neighbours", missing));
        return {};
    }
    require_across(lying, count, context);
    const bool are_few = missing > count;
    if (missing > 0)
        context.warn(fmt::format("{} of {} normals are zero or not finite; they are computed from the neighbours{}",
                                 missing, points.size(),
                                 are_few ? ", and the others only decide which way the surface faces" : ""));
    const OpposedNormals opposed = opposed_normals(points, neighbourhoods, normals.directions, given);
    const bool are_mixed = opposed.are_mixed(count);
    if (are_mixed)
        context.warn(fmt::format(
            "{} of {} normals of the column 'normal' are opposed to that of their nearest neighbour: they have no "
            "orientation, or two sides touch; their signs only decide which way most of the surface faces",
            opposed.count, count));
    if (!are_few && !are_mixed) {
        propagate_signs(neighbourhoods, given, normals.directions);
        return {true, {}};
    }
    Array<Vec3> doubtful(points.size());
    for (u32 point = 0; point < points.size(); ++point)
        doubtful[point] = given[point] ? normals.directions[point] : Vec3(Vec3::Zero());
    return {false, std::move(doubtful)};
}

bool are_opposed(const Vec3& one, const Vec3& other) { return one.dot(other) < opposed_cosine; }

void OpposedNormals::add(const Vec3& normal, const Vec3& offset_of_other) {
    const double height = normal.dot(offset_of_other), distance = offset_of_other.norm();
    ++count;
    behind += height < -least_height * distance;
    in_front += height > least_height * distance;
    beside += std::abs(height) < most_height * distance;
}

OpposedNormals opposed_normals(const DistinctPoints& points, const Neighbourhoods& neighbourhoods,
                               const Array<Vec3>& directions, const std::vector<bool>& given) {
    OpposedNormals opposed;
    for (u32 point = 0; point < points.size(); ++point) {
        if (!given[point]) continue;
        for (u32 other : neighbourhoods.of(point)) {
            if (!given[other]) continue;
            if (are_opposed(directions[point], directions[other]))
                opposed.add(directions[point], points.positions[other] - points.positions[point]);
            break;
        }
    }
    return opposed;
}

}  // namespace scanmill::growing
