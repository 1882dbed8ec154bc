// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/point_weights.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "delaunay/column_weights.hpp"
#include "delaunay/spacing_weights.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"

namespace scanmill {

namespace {

constexpr std::string_view hidden_name = "hidden", older = "-of-points", spacing_name = "spacing";
/// Of a scan with weights; as alpha-solid needs it.
constexpr double least_weighted_size = 1e-100, largest_weighted_size = 1e100;

/// Squares of distances stand beside weights.
void require_squares(const PointCloud& cloud) {
    const double size = bounding_box(cloud.positions.span()).diagonal();
    if (!(size > least_weighted_size && size < largest_weighted_size))
        throw Error(
            "with weights needs a scan between {:.0e} and {:.0e} in size, so that squares of lengths are "
            "numbers; it is {:.3g} {}",
            least_weighted_size, largest_weighted_size, size, symbol(cloud.frame.unit))
            .hint("give it in a larger or smaller unit, or leave weights away");
}

/// Rows by place, those of one place by row.
Array<u32> rows_by_place(std::span<const Vec3> positions) {
    Array<u32> rows(positions.size());
    std::iota(rows.begin(), rows.end(), 0);
    std::ranges::sort(rows, [&](u32 a, u32 b) {
        const Vec3 &p = positions[a], &q = positions[b];
        if (p == q) return a < b;
        return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end());
    });
    return rows;
}

/// Fills `duplicates` and gives all points of a place its largest weight; the number of places where they differed.
std::size_t merge_places(std::span<const Vec3> positions, PointWeights& points) {
    const Array<u32> rows = rows_by_place(positions);
    std::size_t different = 0;
    for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
        for (end = begin + 1; end < rows.size() && positions[rows[end]] == positions[rows[begin]]; ++end)
            points.duplicates.push_back(rows[end]);
        const std::span<const u32> place = std::span(rows).subspan(begin, end - begin);
        double largest = 0, least = HUGE_VAL;
        for (u32 row : place) {
            largest = std::max(largest, points.weights[row]);
            least = std::min(least, points.weights[row]);
        }
        for (u32 row : place) points.weights[row] = largest;
        different += least < largest;
    }
    std::ranges::sort(points.duplicates);
    return different;
}

}  // namespace

PointWeights point_weights(const PointCloud& cloud, const DelaunayParams& params, Context& context) {
    if (!(params.factor >= 0 && std::isfinite(params.factor)))
        throw Error("factor must be a number of 0 or more; it is {}", params.factor)
            .hint("1 takes the weights as they are");
    require_squares(cloud);
    const bool by_spacing = *params.weights == spacing_name;
    if (by_spacing && cloud.columns.find(spacing_name))
        context.warn(
            "`weights: spacing` computes the weights; the points' column 'spacing' is not read. Under another name it "
            "could be");
    if (by_spacing && params.factor > largest_spacing_factor)
        throw Error("with `weights: spacing` factor must be at most {}; it is {}", largest_spacing_factor,
                    params.factor)
            .hint("1 makes a weight the square of the local spacing; a column may hold any weights");
    PointWeights points;
    points.weights = by_spacing ? spacing_weights(cloud.positions.span(), params.factor, context)
                                : column_weights(cloud, *params.weights, params.factor);
    if (by_spacing && *std::ranges::max_element(points.weights) > largest_weight)
        throw Error("needs a scan whose spacing is below {:.0e}, so that weights are numbers",
                    std::sqrt(largest_weight))
            .hint("give it in a larger unit");
    if (const std::size_t different = merge_places(cloud.positions.span(), points); different > 0)
        context.warn(fmt::format("at {} points with different weights were merged; the largest weight counts",
                                 counted(different, "place", "places")));
    return points;
}

ColumnTable with_hidden(const ColumnTable& columns, std::size_t vertices, std::span<const u32> rows, Context& context) {
    ColumnTable result;
    for (const Column& column : columns) {
        if (column.name() != hidden_name) {
            result.add(column);
            continue;
        }
        std::string name(hidden_name);
        while (columns.find(name)) name += older;
        context.warn(fmt::format("the points have a column 'hidden' already; it is called '{}' now", name));
        result.add(column.renamed(name));
    }
    Array<u8> hidden(vertices);
    std::ranges::fill(hidden, u8(0));
    for (u32 row : rows) hidden[row] = 1;
    result.add(Column(std::string(hidden_name), 1, Buffer<u8>(std::move(hidden))));
    return result;
}

}  // namespace scanmill
