// SPDX-License-Identifier: GPL-3.0-or-later
#include "smooth/smooth.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/fit/jet.hpp"

namespace scanmill {

namespace {

using Method = SmoothParams::Method;

constexpr double doubtful_error = 0.25;  // limit of Jet::error, which is about 0.5 for points that fill a ball
constexpr std::size_t chunk = 1 << 10;

/// Results of all points, by their index in the tree.
struct Moves {
    Array<Vec3> offsets;
    Array<double> errors;  ///< fit errors of the polynomials, see Jet::error
    std::vector<u8> flat;
};

/// Reusable memory of one thread.
struct Work {
    Array<Vec3> offsets;
    Array<double> weights;
    NeighbourBuffer buffer;
};

void move(u32 index, std::span<const Neighbour> neighbours, std::span<const Vec3> positions, const SmoothParams& params,
          Work& work, Moves& moves) {
    work.offsets.assign(1, Vec3::Zero());
    work.weights.clear();
    for (const Neighbour& neighbour : neighbours) work.offsets.push_back(positions[neighbour.index] - positions[index]);
    if (params.method == Method::mls && !neighbours.empty()) {
        const double reach =
            params.radius ? params.radius->value() * params.radius->value() : neighbours.back().squared;
        work.weights.push_back(1);
        for (const Neighbour& neighbour : neighbours) {
            const double inverse = 1 + neighbour.squared / (reach / 4);
            work.weights.push_back(1 / (inverse * inverse));
        }
    }
    moves.errors[index] = 0;
    moves.flat[index] = 1;
    moves.offsets[index] = Vec3::Zero();
    if (neighbours.size() < 3) return;
    const Jet jet = fit_jet(work.offsets, work.weights);
    moves.offsets[index] = jet.offset;
    moves.errors[index] = jet.error;
    moves.flat[index] = !jet.is_curved;
}

Moves moves_of(const PointTree& tree, const SmoothParams& params, Context& context) {
    const std::span<const Vec3> positions = tree.positions();
    const std::size_t count = positions.size();
    Moves moves{Array<Vec3>(count), Array<double>(count), std::vector<u8>(count)};
    std::atomic<std::size_t> done = 0;
    const auto report = [&](std::size_t more) {
        context.progress(0.9 * static_cast<double>(done += more) / static_cast<double>(count));
    };
    if (params.radius) {
        const double squared = params.radius->value() * params.radius->value();
        for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
            Work work;
            for (std::size_t i = begin; i < end; ++i) {
                if (i % 64 == 0) context.check_cancelled();
                const u32 index = static_cast<u32>(i);
                move(index, tree.within(index, squared, work.buffer), positions, params, work, moves);
            }
            report(end - begin);
        });
    } else {
        const std::size_t each = std::min<std::size_t>(params.neighbours, count - 1);
        tree.for_each_nearest(each, context.threads(), [&](const NeighbourBatch& batch) {
            context.check_cancelled();
            Work work;
            for (std::size_t i = 0; i < batch.indices.size(); ++i)
                move(batch.indices[i], batch.of(i), positions, params, work, moves);
            report(batch.indices.size());
        });
    }
    return moves;
}

/// Median fit error of the points whose neighbours determine a polynomial. Pre: there is such a point.
double median_error(const Moves& moves) {
    Array<double> errors;
    for (std::size_t i = 0; i < moves.errors.size(); ++i)
        if (!moves.flat[i]) errors.push_back(moves.errors[i]);
    return median(errors);
}

PointCloud moved_points(const PointCloud& cloud, std::span<const u32> index_of_row, const Moves& moves,
                        Context& context) {
    Array<Vec3> positions(cloud.size());
    Array<float> distances(cloud.size());
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const Vec3& offset = moves.offsets[index_of_row[row]];
        positions[row] = cloud.positions[row] + offset;
        distances[row] = static_cast<float>(offset.norm());
    }
    PointCloud result{cloud.frame, std::move(positions), cloud.columns};
    add_column(result.columns, Column("moved", 1, Buffer<float>(std::move(distances))).with_length_exponent(1),
               context);
    if (cloud.columns.find("normal"))
        context.warn(
            "the column 'normal' holds the normals from before the points moved; the filter normals computes new ones");
    return result;
}

void require_usable(const PointCloud& cloud, const SmoothParams& params) {
    if (params.neighbours < 5 || params.neighbours > 1000)
        throw Error("neighbours must be from 5 to 1000; it is {}", params.neighbours)
            .hint("24 suits most scans; more for noisier ones");
    if (params.radius && !(params.radius->value() > 0 && std::isfinite(params.radius->value())))
        throw Error("radius must be above 0; it is {:g} u", params.radius->value())
            .hint("`3 spacing` suits most scans; leave radius out to use the nearest neighbours");
    require_points(cloud, "smoothing needs at least 6");
}

}  // namespace

SmoothResult smooth(const PointCloud& cloud, const SmoothParams& params, Context& context) {
    require_usable(cloud, params);
    context.check_cancelled();
    const PointTree tree(cloud.positions.span(), context.threads());
    const std::size_t positions = tree.positions().size();
    if (positions < 6)
        throw Error("the cloud has {} at {}; smoothing needs at least 6", count_text(cloud.size(), "point", "points"),
                    count_text(positions, "distinct position", "distinct positions"))
            .hint("`scanmill info` shows what a file contains");
    const Moves moves = moves_of(tree, params, context);
    if (std::ranges::all_of(moves.flat, [](u8 it) { return it == 1; }))
        throw Error("none of the {} has neighbours that determine a surface: they are too few, or on a line",
                    count_text(positions, "position", "positions"))
            .hint(params.radius ? "raise radius, or leave it out to use the nearest neighbours"
                                : "smoothing needs at least 6 positions that are not on one line");
    SmoothResult result;
    double squares = 0;
    for (const u32 index : tree.index_of_row()) {
        const double squared = moves.offsets[index].squaredNorm();
        squares += squared;
        result.moved_max = std::max(result.moved_max, std::sqrt(squared));
        result.flat += moves.flat[index];
    }
    result.moved_rms = std::sqrt(squares / static_cast<double>(cloud.size()));
    result.points = moved_points(cloud, tree.index_of_row(), moves, context);
    if (const double error = median_error(moves); error > doubtful_error)
        context.doubt(fmt::format(
            "the neighbours of a point deviate from the surface that fits them by {:.0f} % of their distance to the "
            "point (median): they form no surface at that size; remove outliers, or change {}",
            100 * error, params.radius ? "radius" : "neighbours"));
    context.metric("moved-rms", result.moved_rms, Unit::length);
    context.metric("moved-max", result.moved_max, Unit::length);
    context.metric("flat", static_cast<double>(result.flat));
    context.progress(1);
    return result;
}

}  // namespace scanmill
