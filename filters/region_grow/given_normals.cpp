// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/given_normals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "region_grow/normal_signs.hpp"
#include "scanmill/filter/error.hpp"

namespace scanmill::growing {

namespace {

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

/// Turns a principal normal to where the given ones around it point.
void turn_like_neighbours(const Neighbourhoods& neighbourhoods, const std::vector<bool>& given, u32 place,
                          Array<Vec3>& directions) {
    double sum = 0;
    for (u32 other : neighbourhoods.of(place))
        if (given[other]) sum += directions[other].dot(directions[place]);
    if (sum < 0) directions[place] = -directions[place];
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

}  // namespace

bool take_given_normals(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                        PointNormals& normals, Context& context) {
    const Column* column = cloud.columns.find("normal");
    if (!column) return false;
    require_vectors(*column, cloud.size());
    const std::vector<std::optional<Vec3>> directions = directions_of(*column, samples);
    std::vector<bool> given(samples.size(), false);
    std::size_t missing = 0, lying = 0;
    for (u32 place = 0; place < samples.size(); ++place) {
        if (!directions[place]) {
            ++missing;
            continue;
        }
        const Vec3& normal = *directions[place];
        if (lies_in_surface(samples, neighbourhoods, place, normal, normals.directions[place])) ++lying;
        normals.directions[place] = normal;
        given[place] = true;
    }
    if (missing == samples.size()) {
        context.warn(
            fmt::format("none of the {} normals has a direction; they are taken from the neighbours", missing));
        return false;
    }
    require_across(lying, samples.size() - missing, context);
    if (missing > 0)
        context.warn(fmt::format("{} of {} normals are zero or not finite; they are taken from the neighbours", missing,
                                 samples.size()));
    const OpposedNormals opposed = opposed_normals(samples, neighbourhoods, normals.directions, given);
    if (opposed.are_mixed(samples.size() - missing)) {
        context.warn(fmt::format(
            "{} of {} normals of the column 'normal' point the other way than their nearest neighbour's, as where "
            "nobody oriented them, or two sides touch; their directions are used, their signs are not",
            opposed.count, samples.size() - missing));
        return false;
    }
    for (u32 place = 0; place < samples.size(); ++place)
        if (!given[place]) turn_like_neighbours(neighbourhoods, given, place, normals.directions);
    return true;
}

}  // namespace scanmill::growing
