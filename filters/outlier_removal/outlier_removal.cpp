// SPDX-License-Identifier: GPL-3.0-or-later
#include "outlier_removal/outlier_removal.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <tuple>
#include <vector>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/fit/covariance.hpp"

namespace scanmill {

namespace {

using Method = OutlierRemovalParams::Method;

constexpr u32 most_neighbours = 1000;
/// A point hovers if its nearest position and the plane of its neighbours are both farther away than this share of its
/// mean distance to them.
constexpr double hovering_share = 0.6;
/// Largest surface variation of a flat suspect and its neighbours.
constexpr double flat_variation = 0.0125;
/// Mutual neighbours are connected up to a distance of this many limits.
constexpr double reach = 2;
/// The result is doubtful if more than this share of the points are outliers.
constexpr double doubtful_share = 0.1;
/// Relative tolerance at the limit: equal distances may differ by rounding, and none of them becomes a suspect.
constexpr double rounding = 1e-12;

constexpr std::size_t chunk_size = std::size_t(1) << 14;

double squared_distance(const Vec3& a, const Vec3& b) {
    const double x = a.x() - b.x(), y = a.y() - b.y(), z = a.z() - b.z();
    return (x * x + y * y) + z * z;
}

void require_valid(const PointCloud& cloud, const OutlierRemovalParams& params) {
    require_points(cloud, "outlier removal needs at least 1");
    if (params.neighbours < 1 || params.neighbours > most_neighbours)
        throw Error("neighbours is {}; it must be from 1 to {}", params.neighbours, most_neighbours)
            .hint("16 fits most scans");
    if (!(params.factor > 0) || !std::isfinite(params.factor))
        throw Error("factor is {}; it must be above 0", params.factor).hint("3 fits most scans");
    if (params.radius.in() != Length::In::spacing)
        if (const double radius = params.radius.value(); !(radius >= 0) || !std::isfinite(radius))
            throw Error("radius is {} u; it must be 0 or more", radius).hint("`3 spacing` fits most scans");
    if (const double share = params.min_component.value(); !(share >= 0 && share <= 1))
        throw Error("min-component is {}; it must be from 0 to 1", share).hint("`0.1 %` fits most scans");
}

/// The distinct positions of a cloud with their nearest neighbours.
struct Neighbourhoods {
    PointTree tree;
    /// Number of neighbours of every position: `neighbours`, or all other positions if there are fewer.
    std::size_t each;
    /// The neighbours of each position, nearest first: #positions × each.
    Array<u32> nearest;
    /// Number of points at every position.
    Array<u32> repeats;
    /// By position: the distance that the method compares with its limit.
    Array<double> distances;
    /// Median distance from a position to the nearest other one. 0 for one position, and if `radius` is not in
    /// `spacing`.
    double spacing = 0;

    std::span<const Vec3> positions() const { return tree.positions(); }
    std::span<const u32> of(u32 index) const { return std::span(nearest).subspan(index * each, each); }
};

/// The mean distance from a point to its `count` nearest other points: `duplicates` of them at its own position, the
/// others at the positions of `neighbours`.
double mean_distance(std::span<const Neighbour> neighbours, std::span<const u32> repeats, std::size_t duplicates,
                     std::size_t count) {
    if (count == 0) return 0;
    std::size_t left = count - std::min(count, duplicates);
    double sum = 0;
    for (const Neighbour& neighbour : neighbours) {
        if (left == 0) break;
        const std::size_t taken = std::min<std::size_t>(left, repeats[neighbour.index]);
        sum += static_cast<double>(taken) * std::sqrt(neighbour.squared);
        left -= taken;
    }
    return sum / static_cast<double>(count);
}

/// The distance from a point to its `count`-th nearest other point; infinite if there are fewer.
double last_distance(std::span<const Neighbour> neighbours, std::span<const u32> repeats, std::size_t duplicates,
                     std::size_t count) {
    if (duplicates >= count) return 0;
    std::size_t found = duplicates;
    for (const Neighbour& neighbour : neighbours)
        if ((found += repeats[neighbour.index]) >= count) return std::sqrt(neighbour.squared);
    return std::numeric_limits<double>::infinity();
}

Neighbourhoods neighbourhoods_of(std::span<const Vec3> points, const OutlierRemovalParams& params, Context& context) {
    Neighbourhoods result{PointTree(points, context.threads()), 0, {}, {}, {}, 0};
    context.check_cancelled();
    context.progress(0.2);
    const std::size_t size = result.positions().size();
    result.each = std::min<std::size_t>(params.neighbours, size - 1);
    result.nearest.resize(size * result.each);
    result.distances.resize(size);
    result.repeats.assign(size, 0);
    for (const u32 index : result.tree.index_of_row()) ++result.repeats[index];

    const std::size_t others = std::min<std::size_t>(params.neighbours, points.size() - 1);
    std::vector<double> nearest(result.each > 0 ? size : 0);
    std::atomic<std::size_t> done = 0;
    result.tree.for_each_nearest(params.neighbours, context.threads(), [&](const NeighbourBatch& batch) {
        context.check_cancelled();
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const u32 index = batch.indices[i];
            const std::span<const Neighbour> neighbours = batch.of(i);
            for (std::size_t k = 0; k < neighbours.size(); ++k)
                result.nearest[index * result.each + k] = neighbours[k].index;
            if (!neighbours.empty()) nearest[index] = std::sqrt(neighbours.front().squared);
            const std::size_t duplicates = result.repeats[index] - 1;
            result.distances[index] = params.method == Method::statistical
                                          ? mean_distance(neighbours, result.repeats, duplicates, others)
                                          : last_distance(neighbours, result.repeats, duplicates, params.neighbours);
        }
        const std::size_t now = done += batch.indices.size();
        context.progress(0.2 + 0.6 * static_cast<double>(now) / static_cast<double>(size));
    });
    if (params.radius.in() == Length::In::spacing && !nearest.empty()) result.spacing = median(nearest);
    return result;
}

/// Mean plus `factor` standard deviations of the distances of all points. If `repeated`, the limit is computed again
/// from the points up to the limit, until no more points are excluded.
double statistical_limit(const Neighbourhoods& all, double factor, bool repeated) {
    struct Item {
        double distance;
        u32 points;
    };
    Array<Item> items(all.distances.size());
    for (std::size_t i = 0; i < items.size(); ++i) items[i] = {all.distances[i], all.repeats[i]};
    std::ranges::sort(items, {}, &Item::distance);

    // Sums over the items up to each one. The least distance is subtracted, so that equal distances deviate by exactly
    // 0.
    struct Sums {
        double points = 0, distances = 0, squares = 0;
    };
    const double least = items.front().distance;
    Array<Sums> sums(items.size());
    Sums sum;
    for (std::size_t i = 0; i < items.size(); ++i) {
        const double points = items[i].points, distance = items[i].distance - least;
        sum.points += points;
        sum.distances += points * distance;
        sum.squares += points * distance * distance;
        sums[i] = sum;
    }
    std::size_t count = items.size();
    while (true) {
        const Sums& s = sums[count - 1];
        const double mean = s.distances / s.points;
        const double variance = s.points > 1 ? (s.squares - s.distances * mean) / (s.points - 1) : 0;
        const double limit = (least + mean + factor * std::sqrt(std::max(0.0, variance))) * (1 + rounding);
        const auto end = std::upper_bound(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(count), limit,
                                          [](double value, const Item& item) { return value < item.distance; });
        const auto passing = static_cast<std::size_t>(end - items.begin());
        if (!repeated || passing == count || passing == 0) return limit;
        count = passing;
    }
}

/// Flat suspects lie in the surface that their neighbours form; hovering ones lie above it.
enum class State : u8 { passed, flat, suspect, hovering };

/// Pre: at least one neighbour.
State state_of_suspect(const Neighbourhoods& all, u32 index, Array<Vec3>& offsets) {
    const Vec3& position = all.positions()[index];
    double sum = 0;
    offsets.clear();
    for (const u32 other : all.of(index)) {
        offsets.push_back(all.positions()[other] - position);
        sum += std::sqrt(squared_distance(all.positions()[other], position));
    }
    const double least = hovering_share * sum / static_cast<double>(offsets.size());
    const Scatter others = scatter_of(offsets);
    if (std::sqrt(squared_distance(offsets.front(), Vec3::Zero())) > least &&
        std::abs(others.normal.dot(others.centroid)) > least)
        return State::hovering;
    offsets.push_back(Vec3::Zero());
    return scatter_of(offsets).surface_variation <= flat_variation ? State::flat : State::suspect;
}

/// The state of every position. Suspects are classified only if `connected`.
Array<State> states_of(const Neighbourhoods& all, double limit, bool connected, Context& context) {
    Array<State> states(all.positions().size());
    for_each_chunk(context.threads(), states.size(), chunk_size, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        Array<Vec3> offsets;
        for (std::size_t i = begin; i < end; ++i) {
            states[i] = all.distances[i] > limit ? State::suspect : State::passed;
            if (connected && states[i] == State::suspect && all.each > 0)
                states[i] = state_of_suspect(all, static_cast<u32>(i), offsets);
        }
    });
    return states;
}

/// Unites connected positions of which one is among the nearest of the other.
void unite_neighbours(const Neighbourhoods& all, std::span<const State> states, double limit, double radius,
                      DisjointSets& sets, Context& context) {
    const std::span<const Vec3> positions = all.positions();
    const double near = std::max(limit, radius) * std::max(limit, radius), far = reach * limit * (reach * limit);
    for (u32 index = 0; index < positions.size(); ++index) {
        if (index % chunk_size == 0) context.check_cancelled();
        if (states[index] == State::hovering) continue;
        for (const u32 other : all.of(index)) {
            if (states[other] == State::hovering || sets.find(index) == sets.find(other)) continue;
            const double squared = squared_distance(positions[index], positions[other]);
            const bool both_passed = states[index] == State::passed && states[other] == State::passed;
            const bool both_in_surface = states[index] <= State::flat && states[other] <= State::flat;
            if ((both_passed && squared <= near) ||
                (squared <= far && (both_in_surface || std::ranges::find(all.of(other), index) != all.of(other).end())))
                sets.unite(index, other);
        }
    }
}

/// `label`: by position, the representative of its set. `size`: the number of positions in a set, at its
/// representative.
struct Components {
    Array<u32> label, size;

    explicit Components(DisjointSets& sets, std::size_t count) : label(count), size(count, 0) {
        for (u32 index = 0; index < count; ++index) ++size[label[index] = sets.find(index)];
    }
    u32 largest() const { return static_cast<u32>(std::ranges::max_element(size) - size.begin()); }
};

/// A passed position with its component and its grid cell.
struct Cluster {
    u32 label;
    Vec3 cell;
    u32 index;
    auto key() const { return std::tuple(label, cell.x(), cell.y(), cell.z(), index); }
};

/// The passed positions outside the largest component, by component and cell.
std::vector<Cluster> clusters_of(const Neighbourhoods& all, std::span<const State> states, double edge,
                                 const Components& components) {
    const u32 largest = components.largest();
    std::vector<Cluster> clusters;
    for (u32 index = 0; index < states.size(); ++index)
        if (states[index] == State::passed && components.label[index] != largest)
            clusters.push_back({components.label[index], (all.positions()[index] / edge).array().floor(), index});
    std::ranges::sort(clusters, {}, &Cluster::key);
    return clusters;
}

/// Unites passed positions within the radius that are not among each other's nearest, as in groups of many points side
/// by side. Searches from all components but the largest. A dense group can be smaller than the radius, so there is one
/// search per grid cell.
void unite_groups(const Neighbourhoods& all, std::span<const State> states, double radius, DisjointSets& sets,
                  Context& context) {
    if (!(radius > 0)) return;
    const std::span<const Vec3> positions = all.positions();
    const Components components(sets, states.size());
    constexpr double cells_per_radius = 8;
    const double edge = radius / cells_per_radius;
    const std::vector<Cluster> clusters = clusters_of(all, states, edge, components);
    std::vector<std::size_t> begins;  // the first position of every cell
    for (std::size_t i = 0; i < clusters.size(); ++i)
        if (i == 0 || clusters[i].label != clusters[i - 1].label || clusters[i].cell != clusters[i - 1].cell)
            begins.push_back(i);
    begins.push_back(clusters.size());

    const auto above = [](double length) { return std::nextafter(length * length, 2 * length * length); };
    const double least = above(radius), most = above(radius + std::sqrt(3.0) * edge);
    constexpr std::size_t searches = 1 << 10;
    std::vector<std::vector<std::pair<u32, u32>>> found((begins.size() + searches - 1) / searches);
    for_each_chunk(context.threads(), begins.size() - 1, searches, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        NeighbourBuffer buffer;
        for (std::size_t i = begin; i < end; ++i) {
            const std::span<const Cluster> cell(&clusters[begins[i]], begins[i + 1] - begins[i]);
            u32 last = cell.front().label;
            for (const Neighbour& neighbour :
                 all.tree.within(cell.front().index, cell.size() > 1 ? most : least, buffer)) {
                const u32 label = components.label[neighbour.index];
                if (states[neighbour.index] != State::passed || label == last || label == cell.front().label) continue;
                const auto near = std::ranges::find_if(cell, [&](const Cluster& each) {
                    return cell.size() == 1 ||
                           squared_distance(positions[each.index], positions[neighbour.index]) < least;
                });
                if (near == cell.end()) continue;
                found[begin / searches].emplace_back(near->index, neighbour.index);
                last = label;
            }
        }
    });
    for (const auto& pairs : found)
        for (const auto& [index, other] : pairs) sets.unite(index, other);
}

void require_kept(std::size_t kept, std::size_t points, const OutlierRemovalParams& params, double limit,
                  std::size_t largest, std::size_t positions) {
    if (kept > 0) return;
    if (params.min_component.value() == 0)
        throw Error("{0} of {0} points are outliers: no point has {1} within {2:.4g} u; nothing is left", points,
                    count_text(params.neighbours, "other point", "other points"), limit)
            .hint("enlarge radius, or lower neighbours");
    throw Error(
        "{0} of {0} points are outliers: the largest connected component has {1} of {2} positions, less than the "
        "min-component of {3}; nothing is left",
        points, largest, positions, params.min_component.text())
        .hint("lower min-component, or enlarge radius so that more points are connected");
}

/// All points, with the column `outlier`.
PointCloud marked(const PointCloud& cloud, std::span<const u32> index_of_row, std::span<const u8> is_outlier,
                  Context& context) {
    PointCloud result = cloud;
    Array<u8> values(cloud.size());
    for (std::size_t row = 0; row < values.size(); ++row) values[row] = is_outlier[index_of_row[row]];
    add_column(result.columns, Column("outlier", 1, Buffer<u8>(std::move(values))), context);
    return result;
}

}  // namespace

OutlierRemovalResult outlier_removal(const PointCloud& cloud, const OutlierRemovalParams& params, Context& context) {
    require_valid(cloud, params);
    const Neighbourhoods all = neighbourhoods_of(cloud.positions.span(), params, context);
    const std::size_t positions = all.positions().size();
    const double radius =
        params.radius.in() == Length::In::spacing ? params.radius.amount() * all.spacing : params.radius.value();
    const double share = params.min_component.value();
    const bool connected = share > 0;

    OutlierRemovalResult result;
    result.limit = params.method == Method::statistical ? statistical_limit(all, params.factor, connected) : radius;
    const Array<State> states = states_of(all, result.limit, connected, context);
    context.progress(0.85);
    Array<u8> is_outlier(positions);
    std::size_t largest = 0;
    if (connected) {
        DisjointSets sets(positions);
        unite_neighbours(all, states, result.limit, radius, sets, context);
        context.progress(0.9);
        unite_groups(all, states, std::max(result.limit, radius), sets, context);
        const Components components(sets, positions);
        largest = components.size[components.largest()];
        const std::size_t fewest = std::min<std::size_t>(largest, params.neighbours + std::size_t(1));
        const auto is_kept = [&](std::size_t size) {
            return size >= fewest && static_cast<double>(size) >= share * static_cast<double>(positions);
        };
        for (std::size_t i = 0; i < positions; ++i) {
            is_outlier[i] = !is_kept(components.size[components.label[i]]);
            result.components += components.size[i] > 0 && is_kept(components.size[i]);
        }
    } else {
        for (std::size_t i = 0; i < positions; ++i) is_outlier[i] = states[i] != State::passed;
    }

    const std::span<const u32> index_of_row = all.tree.index_of_row();
    for (u32 row = 0; row < cloud.size(); ++row) {
        const u32 index = index_of_row[row];
        result.suspects += states[index] != State::passed;
        result.hovering += states[index] == State::hovering;
        if (!is_outlier[index]) result.kept.push_back(row);
    }
    result.removed = cloud.size() - result.kept.size();
    if (!params.mark) require_kept(result.kept.size(), cloud.size(), params, result.limit, largest, positions);
    if (static_cast<double>(result.removed) > doubtful_share * static_cast<double>(cloud.size()))
        context.doubt(fmt::format(
            "{} of {} points are outliers ({:.0f} %); if they belong to the object, raise factor or radius, or lower "
            "min-component",
            result.removed, cloud.size(),
            100 * static_cast<double>(result.removed) / static_cast<double>(cloud.size())));
    result.points = params.mark           ? marked(cloud, index_of_row, is_outlier, context)
                    : result.removed == 0 ? cloud
                                          : gather(cloud, result.kept);

    context.metric("kept", static_cast<double>(result.kept.size()));
    context.metric("removed", static_cast<double>(result.removed));
    context.metric("suspects", static_cast<double>(result.suspects));
    context.metric("limit", result.limit, Unit::length);
    if (connected) {
        context.metric("hovering", static_cast<double>(result.hovering));
        context.metric("components", static_cast<double>(result.components));
    }
    context.progress(1);
    return result;
}

}  // namespace scanmill
