// SPDX-License-Identifier: GPL-3.0-or-later
#include "delaunay/point_weights.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <numeric>
#include <vector>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr std::string_view hidden_name = "hidden", older = "-of-points", spacing_name = "spacing";

/// Rows sorted by position, and by number at one position.
Array<u32> rows_by_position(std::span<const Vec3> positions) {
    Array<u32> rows(positions.size());
    std::iota(rows.begin(), rows.end(), 0);
    std::ranges::sort(rows, [&](u32 a, u32 b) {
        return positions[a] == positions[b] ? a < b : is_lower(positions[a], positions[b]);
    });
    return rows;
}

/// Fills `duplicates` and gives all points of a position their largest weight. Returns the number of positions where
/// the weights differed.
std::size_t merge_duplicates(std::span<const Vec3> positions, PointWeights& points) {
    const Array<u32> rows = rows_by_position(positions);
    std::size_t different = 0;
    for (std::size_t begin = 0, end = 0; begin < rows.size(); begin = end) {
        for (end = begin + 1; end < rows.size() && positions[rows[end]] == positions[rows[begin]]; ++end)
            points.duplicates.push_back(rows[end]);
        const std::span<const u32> equal = std::span(rows).subspan(begin, end - begin);
        double largest = 0, least = HUGE_VAL;
        for (u32 row : equal) {
            largest = std::max(largest, points.weights[row]);
            least = std::min(least, points.weights[row]);
        }
        for (u32 row : equal) points.weights[row] = largest;
        different += least < largest;
    }
    std::ranges::sort(points.duplicates);
    return different;
}

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
                    column->is_list() ? "lists" : count_text(column->components(), "number", "numbers"),
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

constexpr std::size_t chunk = 1 << 12;
/// Largest difference between the weights of two points, as a share of their squared distance. With 1, a point could
/// lie exactly on the border of its own power cell.
constexpr double most_of_distance = 0.9;

double mean_distance(std::span<const Neighbour> neighbours) {
    double sum = 0;
    for (const Neighbour& neighbour : neighbours) sum += std::sqrt(neighbour.squared);
    return sum / static_cast<double>(neighbours.size());
}

/// For each distinct point, the other points that may limit its weight.
using Pairs = std::vector<std::vector<u32>>;

/// Lowers every weight to the value that the present weights of other points allow. Returns false if no weight changed.
bool lower_once(std::span<const Vec3> points, const Pairs& pairs, const Array<double>& weights, Array<double>& lowered,
                unsigned threads) {
    std::atomic<bool> changed = false;
    for_each_chunk(threads, points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t point = begin; point < end; ++point) {
            double weight = weights[point];
            for (u32 other : pairs[point])
                weight =
                    std::min(weight, weights[other] + most_of_distance * (points[other] - points[point]).squaredNorm());
            lowered[point] = weight;
            if (weight < weights[point]) changed.store(true, std::memory_order_relaxed);
        }
    });
    return changed;
}

}  // namespace

PointWeights point_weights(const PointCloud& cloud, const DelaunayParams& params, Context& context) {
    if (!(params.factor >= 0 && std::isfinite(params.factor)))
        throw Error("factor must be a number of 0 or more; it is {}", params.factor)
            .hint("1 uses the weights unchanged");
    const bool by_spacing = *params.weights == spacing_name;
    if (by_spacing && cloud.columns.find(spacing_name))
        context.warn(
            "`weights: spacing` computes the weights; the points' column 'spacing' is not read. Rename the column to "
            "use it");
    if (by_spacing && params.factor > largest_spacing_factor)
        throw Error("with `weights: spacing`, factor must be at most {}; it is {}", largest_spacing_factor,
                    params.factor)
            .hint("1 makes a weight the square of the local spacing; a column may hold larger weights");
    PointWeights points;
    points.weights = by_spacing ? spacing_weights(cloud.positions.span(), params.factor, context)
                                : column_weights(cloud, *params.weights, params.factor);
    if (const std::size_t different = merge_duplicates(cloud.positions.span(), points); different > 0)
        context.warn(fmt::format("at {} points with different weights were merged; the largest weight counts",
                                 count_text(different, "position", "positions")));
    return points;
}

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

Array<double> spacing_weights(std::span<const Vec3> positions, double factor, Context& context) {
    const PointTree tree(positions);
    const std::span<const Vec3> points = tree.positions();
    context.progress(0.05);

    Array<double> weights(points.size());
    Pairs pairs(points.size());
    for_each_chunk(context.threads(), points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        NeighbourBuffer buffer;
        for (std::size_t i = begin; i < end; ++i) {
            const u32 point = static_cast<u32>(i);
            const double spacing = mean_distance(tree.nearest(point, spacing_neighbours, buffer));
            weights[point] = factor * (spacing * spacing);
            // Points farther away do not limit this weight, because no weight is below 0.
            for (const Neighbour& other : tree.within(point, weights[point] / most_of_distance, buffer))
                pairs[point].push_back(other.index);
        }
    });
    context.progress(0.2);

    // Weights only fall, and the fixed point does not depend on the order of lowering.
    Array<double> lowered(points.size());
    while (lower_once(points, pairs, weights, lowered, context.threads())) {
        context.check_cancelled();
        std::swap(weights, lowered);
    }
    context.progress(0.25);

    Array<double> per_row(positions.size());
    for (std::size_t row = 0; row < per_row.size(); ++row) per_row[row] = weights[tree.index_of_row()[row]];
    return per_row;
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
        context.warn(fmt::format("the points already have a column 'hidden'; it was renamed '{}'", name));
        result.add(column.renamed(name));
    }
    Array<u8> hidden(vertices);
    std::ranges::fill(hidden, u8(0));
    for (u32 row : rows) hidden[row] = 1;
    result.add(Column(std::string(hidden_name), 1, Buffer<u8>(std::move(hidden))));
    return result;
}

}  // namespace scanmill
