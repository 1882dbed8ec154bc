// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/normals.hpp"

#include <fmt/format.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/fit/covariance.hpp"

namespace scanmill::growing {

namespace {

/// So few that at a border, where they lie on one side, they still are of the same sheet.
constexpr std::size_t counted_neighbours = 12;

Scatter scatter_at(const Samples& samples, const Neighbourhoods& neighbourhoods, u32 place) {
    const auto near = neighbourhoods.of(place);
    const std::size_t count = std::min(counted_neighbours, near.size());
    std::array<Vec3, counted_neighbours + 1> offsets;
    offsets[0] = Vec3::Zero();
    for (std::size_t i = 0; i < count; ++i) offsets[i + 1] = samples.positions[near[i]] - samples.positions[place];
    return scatter_of(std::span(offsets).first(count + 1));
}

void require_vectors(const Column& column, std::size_t points) {
    if (column.components() == 3 && column.rows() == points) return;
    const std::string size =
        column.is_list() ? "lists of varying length" : fmt::format("{} numbers per row", column.components());
    throw Error("the column 'normal' holds {} in {} rows; normals are 3 numbers in each of the {} rows", size,
                column.rows(), points)
        .hint("rename or drop the column, then normals are taken from the neighbours");
}

/// The row's normal as a unit vector; nothing when it is zero or not finite.
std::optional<Vec3> direction(const Column& column, u32 row) {
    const Vec3 normal(column.number(row, 0), column.number(row, 1), column.number(row, 2));
    const double largest = normal.cwiseAbs().maxCoeff();
    if (!normal.allFinite() || !(largest > 0)) return std::nullopt;
    return (normal / largest).normalized();
}

/// Per place its row's; of several rows the first by x, y, z, whatever their order.
std::vector<std::optional<Vec3>> directions_of(const Column& column, const Samples& samples) {
    std::vector<std::optional<Vec3>> directions(samples.size());
    for (u32 place = 0; place < samples.size(); ++place) directions[place] = direction(column, samples.rows[place]);
    for (const auto& [place, row] : samples.repeats) {
        std::optional<Vec3>& known = directions[place];
        const std::optional<Vec3> other = direction(column, row);
        if (other &&
            (!known || std::lexicographical_compare(other->begin(), other->end(), known->begin(), known->end())))
            known = other;
    }
    return directions;
}

/// Turns principal normals to where the given ones near them point, from neighbour to neighbour outwards. Where no
/// given one is reached, the lowest place's sign decides.
void turn_like_neighbours(const Neighbourhoods& neighbourhoods, std::vector<bool> known, Array<Vec3>& directions) {
    Array<double> agreement(known.size());
    std::ranges::fill(agreement, 0);
    std::vector<bool> asked = known;
    std::vector<u32> ring, next;
    for (u32 place = 0; place < known.size(); ++place)
        if (known[place]) ring.push_back(place);
    for (u32 lowest = 0;; ring.swap(next)) {
        next.clear();
        for (u32 place : ring)
            for (u32 other : neighbourhoods.of(place)) {
                if (known[other]) continue;
                agreement[other] += directions[place].dot(directions[other]);
                if (asked[other]) continue;
                asked[other] = true;
                next.push_back(other);
            }
        while (next.empty() && lowest < known.size()) {
            if (!known[lowest]) next.push_back(lowest);
            ++lowest;
        }
        if (next.empty()) return;
        std::ranges::sort(next);
        for (u32 place : next) {
            known[place] = asked[place] = true;
            if (agreement[place] < 0) directions[place] = -directions[place];
        }
    }
}

/// Whether a given normal lies in the surface rather than across it: far from the principal one, and its neighbours
/// reach along it. Those of one scan line have no principal normal, but reach along no direction across the line
/// either.
bool lies_in_surface(const Samples& samples, const Neighbourhoods& neighbourhoods, u32 place, const Vec3& given,
                     const Vec3& principal) {
    constexpr double least_cosine = 0.5;  // of 60 degrees, as the sentences below say
    constexpr double least_share = 0.25;  // of a normal tilted by that in an even neighbourhood: 3/8
    if (std::abs(given.dot(principal)) >= least_cosine) return false;
    double along = 0, whole = 0;
    for (u32 other : neighbourhoods.of(place)) {
        const Vec3 offset = samples.positions[other] - samples.positions[place];
        along += given.dot(offset) * given.dot(offset);
        whole += offset.squaredNorm();
    }
    return along > least_share * whole;
}

/// Refuses normals most of which are not the surface's, and warns when many are not. Where noise hides the surface,
/// half of any normals are that far from the principal ones, so more than that is asked.
void require_across(std::size_t lying, std::size_t given, Context& context) {
    const double share = static_cast<double>(lying) / static_cast<double>(given);
    const std::string found = fmt::format(
        "{} of {} normals of the column 'normal' ({:.3g} %) are more than 60 deg from the normal of their neighbours, "
        "as if they lay in the surface",
        lying, given, 100 * share);
    constexpr double most = 0.75, remarkable = 0.25;
    if (share > most)
        throw Error(found).hint(
            "check that the column holds normals; drop or rename it, then normals are taken from the neighbours");
    if (share > remarkable) context.warn(found + "; without the column, normals would be taken from the neighbours");
}

constexpr double opposed_cosine = -0.9;  // of 154 degrees
/// Of the distance, along the normal: a neighbour beside is no higher.
constexpr double most_height = 0.3;
/// What rounding and bends make of a height of nothing.
constexpr double least_height = 0.01;

}  // namespace

PointNormals principal_normals(const Samples& samples, const Neighbourhoods& neighbourhoods, unsigned threads) {
    PointNormals normals;
    normals.directions.resize(samples.size());
    normals.roughness.resize(samples.size());
    for_each_chunk(threads, samples.size(), 1 << 12, [&](std::size_t begin, std::size_t end) {
        for (std::size_t place = begin; place < end; ++place) {
            const Scatter scatter = scatter_at(samples, neighbourhoods, static_cast<u32>(place));
            normals.directions[place] = scatter.normal;
            normals.roughness[place] = static_cast<float>(scatter.roughness);
        }
    });
    return normals;
}

GivenNormals take_given_normals(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                                PointNormals& normals, Context& context) {
    const Column* column = cloud.columns.find("normal");
    if (!column) return {};
    require_vectors(*column, cloud.size());
    const std::vector<std::optional<Vec3>> directions = directions_of(*column, samples);
    std::vector<bool> given(samples.size(), false);
    std::size_t lying = 0, count = 0;
    for (u32 place = 0; place < samples.size(); ++place) {
        if (!directions[place]) continue;
        const Vec3& normal = *directions[place];
        if (lies_in_surface(samples, neighbourhoods, place, normal, normals.directions[place])) ++lying;
        normals.directions[place] = normal;
        given[place] = true;
        ++count;
    }
    const std::size_t missing = samples.size() - count;
    if (count == 0) {
        context.warn(
            fmt::format("none of the {} normals has a direction; they are taken from the neighbours", missing));
        return {};
    }
    require_across(lying, count, context);
    const bool are_few = missing > count;
    if (missing > 0)
        context.warn(fmt::format("{} of {} normals are zero or not finite; they are taken from the neighbours{}",
                                 missing, samples.size(),
                                 are_few ? ", and the others only tell which way the surface faces" : ""));
    const OpposedNormals opposed = opposed_normals(samples, neighbourhoods, normals.directions, given);
    const bool are_mixed = opposed.are_mixed(count);
    if (are_mixed)
        context.warn(fmt::format(
            "{} of {} normals of the column 'normal' point the other way than their nearest neighbour's, as where "
            "nobody oriented them, or two sides touch; their signs only tell which way most of the surface faces",
            opposed.count, count));
    if (!are_few && !are_mixed) {
        turn_like_neighbours(neighbourhoods, given, normals.directions);
        return {true, {}};
    }
    Array<Vec3> doubtful(samples.size());
    for (u32 place = 0; place < samples.size(); ++place)
        doubtful[place] = given[place] ? normals.directions[place] : Vec3(Vec3::Zero());
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

OpposedNormals opposed_normals(const Samples& samples, const Neighbourhoods& neighbourhoods,
                               const Array<Vec3>& directions, const std::vector<bool>& given) {
    OpposedNormals opposed;
    for (u32 place = 0; place < samples.size(); ++place) {
        if (!given[place]) continue;
        for (u32 other : neighbourhoods.of(place)) {
            if (!given[other]) continue;
            if (are_opposed(directions[place], directions[other]))
                opposed.add(directions[place], samples.positions[other] - samples.positions[place]);
            break;
        }
    }
    return opposed;
}

}  // namespace scanmill::growing
