// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/given_normals.hpp"

#include <fmt/format.h>

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

/// Turns a principal normal to where the given ones around it point.
void turn_like_neighbours(const Neighbourhoods& neighbourhoods, const std::vector<bool>& given, u32 place,
                          Array<Vec3>& directions) {
    double sum = 0;
    for (u32 other : neighbourhoods.of(place))
        if (given[other]) sum += directions[other].dot(directions[place]);
    if (sum < 0) directions[place] = -directions[place];
}

}  // namespace

bool take_given_normals(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                        PointNormals& normals, Context& context) {
    const Column* column = cloud.columns.find("normal");
    if (!column) return false;
    require_vectors(*column, cloud.size());
    std::vector<bool> given(samples.size(), false);
    std::size_t missing = 0;
    for (std::size_t place = 0; place < samples.size(); ++place) {
        const u32 row = samples.rows[place];
        Vec3 normal(column->number(row, 0), column->number(row, 1), column->number(row, 2));
        const double largest = normal.cwiseAbs().maxCoeff();
        if (!normal.allFinite() || !(largest > 0)) {
            ++missing;
            continue;
        }
        normals.directions[place] = (normal / largest).normalized();
        given[place] = true;
    }
    if (missing == samples.size()) {
        context.warn(
            fmt::format("none of the {} normals has a direction; they are taken from the neighbours", missing));
        return false;
    }
    for (u32 place = 0; place < samples.size(); ++place)
        if (!given[place]) turn_like_neighbours(neighbourhoods, given, place, normals.directions);
    if (missing > 0)
        context.warn(fmt::format("{} of {} normals are zero or not finite; they are taken from the neighbours", missing,
                                 samples.size()));
    return true;
}

}  // namespace scanmill::growing
