// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/column_weights.hpp"

#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

/// "; columns of one number: w and quality", or that there are none.
std::string single_columns(const PointCloud& cloud) {
    std::vector<std::string> names;
    for (const Column& column : cloud.columns)
        if (column.components() == 1) names.push_back(column.name());
    return names.empty() ? "; no column has one number" : fmt::format("; columns of one number: {}", enumerated(names));
}

const Column& column_named(const PointCloud& cloud, const std::string& name) {
    if (const Column* column = cloud.columns.find(name)) {
        if (column->components() == 1) return *column;
        throw Error("weights need a column of one number per point; '{}' has {}{}", name,
                    column->is_list() ? "lists" : counted(column->components(), "number", "numbers"),
                    single_columns(cloud))
            .hint("`weights: spacing` needs no column");
    }
    std::vector<std::string> names{"spacing"};
    for (const Column& column : cloud.columns) names.push_back(column.name());
    const std::string meant = did_you_mean(name, names);
    names.erase(names.begin());
    throw Error("the points have no column '{}' to take weights from; {}{}", name,
                names.empty() ? "they have no columns" : fmt::format("their columns: {}", enumerated(names)), meant)
        .hint("`weights: spacing` needs no column");
}

}  // namespace

Array<double> column_weights(const PointCloud& cloud, const std::string& name, double factor) {
    const Column& column = column_named(cloud, name);
    Array<double> weights(cloud.size());
    std::size_t unusable = 0, first = 0;
    for (std::size_t row = 0; row < weights.size(); ++row) {
        weights[row] = factor * column.number(row);
        if (weights[row] >= 0 && weights[row] <= largest_weight) continue;
        if (unusable++ == 0) first = row;
    }
    if (unusable > 0)
        throw Error(
            "weights must be numbers from 0 to {:.0e}; {} of {} in the column '{}' are not, the first is that of point "
            "{}: {}{}",
            largest_weight, unusable, weights.size(), name, first, column.number(first),
            factor == 1 ? "" : fmt::format(" times {}", factor))
            .hint(
                "a weight is a squared length in the scan's unit, 0 for a point without one; `weights: spacing` "
                "computes them");
    return weights;
}

}  // namespace scanmill
