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
#include "scanmill/base/elementary.hpp"
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
/// Least limit of the logarithm of a position's mean distance over that of its neighbours.
constexpr double least_log_limit = 0.25;
/// The standard deviation of a normal distribution over its median absolute deviation.
constexpr double deviation_per_mad = 1.4826;
/// A position hovers if its nearest position and the plane of its neighbours are both farther away than this share of
/// its mean distance to them.
constexpr double hovering_share = 0.6;
/// Largest surface variation of a position and its neighbours in one surface, and largest distance of the position from
/// their plane, in mean distances of the neighbours.
constexpr double flat_variation = 0.0125, flat_height = 0.5;
/// Positions are sparse above this many mean distances of the surface. Sparse positions are scattered over a volume if
/// their surface variation is above `scattered_variation`; a ball has 1/3.
constexpr double sparse_factor = 2.5, scattered_variation = 0.05;
/// A cluster of scattered positions belongs to the surface if at least this share of it is linked to the surface.
constexpr double linked_share = 0.15;
/// Neighbours are linked up to a distance of this many mean distances of either.
constexpr double longest_link = 6;
/// With Method::radius, neighbours are also linked at most up to this many radii.
constexpr double links_per_radius = 2;
constexpr double infinite = std::numeric_limits<double>::infinity();
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
    /// By position: its mean distance to its neighbours.
    Array<double> means;
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
    Neighbourhoods result{PointTree(points, context.threads()), 0, {}, {}, {}, {}, 0};
    context.check_cancelled();
    context.progress(0.2);
    const std::size_t size = result.positions().size();
    result.each = std::min<std::size_t>(params.neighbours, size - 1);
    result.nearest.resize(size * result.each);
    result.distances.resize(size);
    result.means.resize(size);
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
            double sum = 0;
            for (const Neighbour& neighbour : neighbours) sum += std::sqrt(neighbour.squared);
            result.means[index] = neighbours.empty() ? 0 : sum / static_cast<double>(neighbours.size());
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

/// Mean plus `factor` standard deviations (divisor n - 1) of the distances of all points.
double statistical_limit(const Neighbourhoods& all, double factor) {
    // The least distance is subtracted, so that equal distances deviate by exactly 0.
    const double least = *std::ranges::min_element(all.distances);
    double points = 0, distances = 0, squares = 0;
    for (std::size_t i = 0; i < all.distances.size(); ++i) {
        const double count = all.repeats[i], distance = all.distances[i] - least;
        points += count;
        distances += count * distance;
        squares += count * distance * distance;
    }
    const double mean = distances / points;
    const double variance = points > 1 ? (squares - distances * mean) / (points - 1) : 0;
    return (least + mean + factor * std::sqrt(std::max(0.0, variance))) * (1 + rounding);
}

/// By position: the logarithm of its mean distance over the median of its neighbours' mean distances.
std::vector<double> log_ratios(const Neighbourhoods& all, Context& context) {
    std::vector<double> ratios(all.means.size(), 0);
    if (all.each == 0) return ratios;
    for_each_chunk(context.threads(), ratios.size(), chunk_size, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        std::vector<double> around(all.each);
        for (std::size_t i = begin; i < end; ++i) {
            std::ranges::transform(all.of(static_cast<u32>(i)), around.begin(),
                                   [&](u32 other) { return all.means[other]; });
            ratios[i] = elementary::log(all.means[i] / median(around));
        }
    });
    return ratios;
}

/// The median of the ratios plus `factor` standard deviations, which are estimated by the median absolute deviation.
double robust_limit(std::vector<double> ratios, double factor) {
    const double middle = median(ratios);
    for (double& ratio : ratios) ratio = std::abs(ratio - middle);
    return std::max(least_log_limit, middle + factor * deviation_per_mad * median(ratios));
}

/// The shape of the surface at a position.
struct Shape {
    double variation = 0;  ///< Scatter::surface_variation of the position and its neighbours
    double height = 0;  ///< distance from the plane of its neighbours
    double nearest = 0;  ///< distance to the nearest of them
};

/// Pre: at least one neighbour.
Shape shape_at(const Neighbourhoods& all, u32 index, Array<Vec3>& offsets) {
    const Vec3& position = all.positions()[index];
    offsets.clear();
    for (const u32 other : all.of(index)) offsets.push_back(all.positions()[other] - position);
    const Scatter others = scatter_of(offsets);
    const double nearest = std::sqrt(squared_distance(offsets.front(), Vec3::Zero()));
    offsets.push_back(Vec3::Zero());
    return {scatter_of(offsets).surface_variation, std::abs(others.normal.dot(others.centroid)), nearest};
}

/// The mean distance that is usual on the surface: the median over the positions that lie in a surface with their
/// neighbours, of at most 10,000 that are spread over all. Without such positions, the median over all of these.
double usual_distance(const Neighbourhoods& all) {
    constexpr std::size_t most = 10'000;
    const std::size_t count = all.means.size(), step = count / most + 1;
    std::vector<double> flat, any;
    Array<Vec3> offsets;
    for (std::size_t i = 0; i < count; i += step) {
        any.push_back(all.means[i]);
        if (shape_at(all, static_cast<u32>(i), offsets).variation <= scattered_variation) flat.push_back(all.means[i]);
    }
    return median(flat.empty() ? any : flat);
}

/// What is known of a position. A position that passed and is not sparse counts as one in a surface.
struct Judgement {
    bool is_suspect = false;
    bool is_sparse = false;
    bool is_hovering = false;
    bool is_scattered = false;  ///< sparse, and not in one surface with its neighbours
    bool is_cut_off = false;  ///< in a cluster of scattered positions that is not part of the surface
    bool is_in_surface = true;

    bool is_usable() const { return !is_hovering && !is_cut_off; }
    bool connects() const { return is_usable() && (!is_suspect || !is_sparse || is_in_surface); }
};

Array<Judgement> judged(const Neighbourhoods& all, std::span<const u8> is_suspect, Context& context) {
    Array<Judgement> judgements(is_suspect.size());
    if (all.each == 0) return judgements;
    const double usual = usual_distance(all), sparse = sparse_factor * usual;
    for_each_chunk(context.threads(), judgements.size(), chunk_size, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        Array<Vec3> offsets;
        std::vector<double> around(all.each);
        for (std::size_t i = begin; i < end; ++i) {
            Judgement& its = judgements[i];
            its.is_suspect = is_suspect[i] != 0;
            its.is_sparse = all.means[i] > sparse;
            if (!its.is_suspect && !its.is_sparse) continue;
            const u32 index = static_cast<u32>(i);
            const Shape shape = shape_at(all, index, offsets);
            std::ranges::transform(all.of(index), around.begin(), [&](u32 other) { return all.means[other]; });
            const double least = hovering_share * all.means[i];
            its.is_hovering = its.is_suspect && all.means[i] > usual && shape.nearest > least && shape.height > least;
            its.is_scattered = its.is_sparse && shape.variation > scattered_variation;
            its.is_in_surface = shape.variation <= flat_variation && shape.height <= flat_height * median(around);
        }
    });
    return judgements;
}

bool are_mutual(const Neighbourhoods& all, u32 index, u32 other) {
    return std::ranges::find(all.of(other), index) != all.of(other).end();
}

/// Cuts off clusters of positions in whose neighbourhoods most are scattered, unless enough of a cluster is linked to
/// the surface.
void cut_off_scattered(const Neighbourhoods& all, Array<Judgement>& judgements, Context& context) {
    const u32 count = static_cast<u32>(judgements.size());
    std::vector<bool> is_member(count, false);
    DisjointSets clusters(count);
    for (u32 i = 0; i < count; ++i) {
        if (!judgements[i].is_scattered || judgements[i].is_hovering) continue;
        std::size_t scattered = 1;
        for (const u32 other : all.of(i)) scattered += judgements[other].is_scattered;
        is_member[i] = 2 * scattered > all.each + 1;
    }
    context.check_cancelled();
    std::vector<u32> size(count, 0), linked(count, 0);
    for (u32 i = 0; i < count; ++i) {
        if (!is_member[i]) continue;
        for (const u32 other : all.of(i))
            if (is_member[other] && are_mutual(all, i, other)) clusters.unite(i, other);
    }
    for (u32 i = 0; i < count; ++i) {
        if (!is_member[i]) continue;
        ++size[clusters.find(i)];
        linked[clusters.find(i)] += std::ranges::any_of(all.of(i), [&](u32 other) {
            const Judgement& its = judgements[other];
            return !its.is_suspect && !its.is_scattered && are_mutual(all, i, other);
        });
    }
    for (u32 i = 0; i < count; ++i)
        judgements[i].is_cut_off =
            is_member[i] && linked[clusters.find(i)] < linked_share * static_cast<double>(size[clusters.find(i)]);
}

/// Unites neighbours that are at most `most` apart: mutual ones, and those of a position that lies in their surface. A
/// sparse suspect that does not lie in its surface joins only the nearest mutual neighbour that is not of its kind, so
/// it never connects others.
void unite_neighbours(const Neighbourhoods& all, std::span<const Judgement> judgements, double most, DisjointSets& sets,
                      Context& context) {
    const std::span<const Vec3> positions = all.positions();
    const auto is_near = [&](u32 index, u32 other) {
        const double longest = std::min(most, longest_link * std::min(all.means[index], all.means[other]));
        return squared_distance(positions[index], positions[other]) <= longest * longest;
    };
    for (u32 index = 0; index < positions.size(); ++index) {
        if (index % chunk_size == 0) context.check_cancelled();
        if (!judgements[index].connects()) continue;
        for (const u32 other : all.of(index)) {
            if (!judgements[other].connects() || sets.find(index) == sets.find(other)) continue;
            if (is_near(index, other) && (judgements[index].is_in_surface || are_mutual(all, index, other)))
                sets.unite(index, other);
        }
    }
    for (u32 index = 0; index < positions.size(); ++index) {
        if (judgements[index].connects() || !judgements[index].is_usable()) continue;
        const auto joined = std::ranges::find_if(all.of(index), [&](u32 other) {
            return judgements[other].connects() && is_near(index, other) && are_mutual(all, index, other);
        });
        if (joined != all.of(index).end()) sets.unite(index, *joined);
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

bool has_passed(const Judgement& its) { return !its.is_suspect && its.is_usable(); }

/// A passed position with its component and its grid cell.
struct Cluster {
    u32 label;
    Vec3 cell;
    u32 index;
    auto key() const { return std::tuple(label, cell.x(), cell.y(), cell.z(), index); }
};

/// The passed positions outside the largest component, by component and cell.
std::vector<Cluster> clusters_of(const Neighbourhoods& all, std::span<const Judgement> judgements, double edge,
                                 const Components& components) {
    const u32 largest = components.largest();
    std::vector<Cluster> clusters;
    for (u32 index = 0; index < judgements.size(); ++index)
        if (has_passed(judgements[index]) && components.label[index] != largest)
            clusters.push_back({components.label[index], (all.positions()[index] / edge).array().floor(), index});
    std::ranges::sort(clusters, {}, &Cluster::key);
    return clusters;
}

/// Unites passed positions within the radius that are not among each other's nearest, as in groups of many points side
/// by side. Searches from all components but the largest. A dense group can be smaller than the radius, so there is one
/// search per grid cell.
void unite_groups(const Neighbourhoods& all, std::span<const Judgement> judgements, double radius, DisjointSets& sets,
                  Context& context) {
    if (!(radius > 0)) return;
    const std::span<const Vec3> positions = all.positions();
    const Components components(sets, judgements.size());
    constexpr double cells_per_radius = 8;
    const double edge = radius / cells_per_radius;
    const std::vector<Cluster> clusters = clusters_of(all, judgements, edge, components);
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
            context.check_cancelled();
            const std::span<const Cluster> cell(&clusters[begins[i]], begins[i + 1] - begins[i]);
            u32 last = cell.front().label;
            for (const Neighbour& neighbour :
                 all.tree.within(cell.front().index, cell.size() > 1 ? most : least, buffer)) {
                const u32 label = components.label[neighbour.index];
                if (!has_passed(judgements[neighbour.index]) || label == last || label == cell.front().label) continue;
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

/// What the components of all positions are like.
struct Outliers {
    Array<u8> is_outlier;  ///< by position
    std::size_t largest = 0;  ///< positions of the largest component
    std::size_t components = 0;  ///< kept ones
    double removed_area = 0;  ///< share of the area of positions in a surface
};

Outliers outliers_of(const Neighbourhoods& all, std::span<const Judgement> judgements, double radius, double most,
                     double share, Context& context) {
    const std::size_t count = judgements.size();
    DisjointSets sets(count);
    unite_neighbours(all, judgements, most, sets, context);
    context.progress(0.9);
    unite_groups(all, judgements, radius, sets, context);
    const Components components(sets, count);
    // By component. A position stands for an area in proportion to the square of its mean distance.
    std::vector<double> area(count, 0);
    std::vector<u32> scattered(count, 0);
    double whole = 0;
    const auto area_of = [&](std::size_t i) {
        return judgements[i].is_in_surface && judgements[i].is_usable() ? all.means[i] * all.means[i] : 0;
    };
    for (std::size_t i = 0; i < count; ++i) {
        area[components.label[i]] += area_of(i);
        scattered[components.label[i]] += judgements[i].is_scattered;
        whole += area_of(i);
    }
    const u32 largest = components.largest();
    Outliers found;
    found.largest = components.size[largest];
    const std::size_t fewest = std::min<std::size_t>(found.largest, all.each + 1);
    std::vector<bool> is_kept(count, false);
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t size = components.size[i];
        const bool is_large =
            static_cast<double>(size) >= share * static_cast<double>(count) || (whole > 0 && area[i] >= share * whole);
        is_kept[i] = size >= std::max<std::size_t>(fewest, 1) && is_large && 2 * scattered[i] <= size;
        found.components += is_kept[i];
    }
    if (found.components == 0 && static_cast<double>(found.largest) >= share * static_cast<double>(count)) {
        is_kept[largest] = true;  // all are scattered
        found.components = 1;
    }
    found.is_outlier.resize(count);
    double removed = 0;
    for (std::size_t i = 0; i < count; ++i) {
        found.is_outlier[i] = !is_kept[components.label[i]];
        if (found.is_outlier[i] != 0) removed += area_of(i);
    }
    found.removed_area = whole > 0 ? removed / whole : 0;
    return found;
}

void doubt_share(const OutlierRemovalResult& result, std::size_t points, double removed_area, Context& context) {
    const double share = static_cast<double>(result.removed) / static_cast<double>(points);
    if (share > doubtful_share)
        context.doubt(fmt::format(
            "{} of {} points are outliers ({:.0f} %); if they belong to the object, raise factor or radius, or lower "
            "min-component",
            result.removed, points, 100 * share));
    else if (removed_area > doubtful_share)
        context.doubt(fmt::format(
            "the {} outliers cover {:.0f} % of the area of all points that lie in a surface; if they belong to the "
            "object, raise radius, or lower min-component",
            result.removed, 100 * removed_area));
}

}  // namespace

OutlierRemovalResult outlier_removal(const PointCloud& cloud, const OutlierRemovalParams& params, Context& context) {
    require_valid(cloud, params);
    const Neighbourhoods all = neighbourhoods_of(cloud.positions.span(), params, context);
    const std::size_t positions = all.positions().size();
    const double radius =
        params.radius.in() == Length::In::spacing ? params.radius.amount() * all.spacing : params.radius.value();
    const double share = params.min_component.value();
    const bool by_components = share > 0, by_ratio = by_components && params.method == Method::statistical;

    OutlierRemovalResult result;
    Array<u8> is_suspect(positions);
    if (by_ratio) {
        std::vector<double> ratios = log_ratios(all, context);
        result.log_limit = robust_limit(ratios, params.factor);
        std::ranges::transform(ratios, is_suspect.begin(), [&](double ratio) { return u8(ratio > result.log_limit); });
    } else {
        result.limit = params.method == Method::statistical ? statistical_limit(all, params.factor) : radius;
        std::ranges::transform(all.distances, is_suspect.begin(),
                               [&](double distance) { return u8(distance > result.limit); });
    }
    context.progress(0.83);
    Array<Judgement> judgements(positions);
    Outliers found;
    if (by_components) {
        judgements = judged(all, is_suspect, context);
        cut_off_scattered(all, judgements, context);
        context.progress(0.87);
        found = outliers_of(all, judgements, radius, by_ratio ? infinite : links_per_radius * radius, share, context);
        result.components = found.components;
    } else {
        found.is_outlier = is_suspect;
    }

    const std::span<const u32> index_of_row = all.tree.index_of_row();
    for (u32 row = 0; row < cloud.size(); ++row) {
        const u32 index = index_of_row[row];
        result.suspects += is_suspect[index];
        result.hovering += judgements[index].is_hovering;
        result.scattered += judgements[index].is_cut_off;
        if (found.is_outlier[index] == 0) result.kept.push_back(row);
    }
    result.removed = cloud.size() - result.kept.size();
    if (!params.mark) require_kept(result.kept.size(), cloud.size(), params, result.limit, found.largest, positions);
    doubt_share(result, cloud.size(), found.removed_area, context);
    result.points = params.mark           ? marked(cloud, index_of_row, found.is_outlier, context)
                    : result.removed == 0 ? cloud
                                          : gather(cloud, result.kept);

    context.metric("kept", static_cast<double>(result.kept.size()));
    context.metric("removed", static_cast<double>(result.removed));
    context.metric("suspects", static_cast<double>(result.suspects));
    if (by_ratio)
        context.metric("log-limit", result.log_limit, Unit::number);
    else
        context.metric("limit", result.limit, Unit::length);
    if (by_components) {
        context.metric("hovering", static_cast<double>(result.hovering));
        context.metric("scattered", static_cast<double>(result.scattered));
        context.metric("components", static_cast<double>(result.components));
    }
    context.progress(1);
    return result;
}

}  // namespace scanmill
