// SPDX-License-Identifier: GPL-3.0-or-later
#include "normals/normals.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <queue>
#include <tuple>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/fit/jet.hpp"
#include "scanmill/geometry/spatial/direction.hpp"
#include "scanmill/geometry/spatial/lists.hpp"

namespace scanmill {

namespace {

using Method = NormalsParams::Method;
using Orient = NormalsParams::Orient;

constexpr double least_flatness = 1e-6;  // least flatness of neighbours that determine a plane
constexpr double grazing_cosine = 0.08715574274765817;  // cosine of 85 degrees
constexpr double doubtful_share = 0.05;
constexpr double doubtful_variation = 0.1;  // a hemisphere has 1/9, a ball 1/3
constexpr std::size_t chunk = 1 << 12;

/// The normals at the positions of a tree, and the nearest neighbours of each position.
struct NormalField {
    std::size_t each = 0;
    /// The neighbours of position i are in the rows [i each, (i + 1) each).
    Array<u32> nearest;
    Array<Vec3> directions;
    std::vector<u8> undetermined;
    Array<double> variation;  ///< Scatter::surface_variation

    std::span<const u32> of(std::size_t i) const { return std::span(nearest).subspan(i * each, each); }
};

NormalField estimated(const PointTree& tree, const NormalsParams& params, Context& context) {
    const std::span<const Vec3> positions = tree.positions();
    NormalField field;
    field.each = std::min<std::size_t>(params.neighbours, positions.size() - 1);
    field.nearest.resize(positions.size() * field.each);
    field.directions.resize(positions.size());
    field.undetermined.resize(positions.size());
    field.variation.resize(positions.size());
    std::atomic<std::size_t> done = 0;
    tree.for_each_nearest(field.each, context.threads(), [&](const NeighbourBatch& batch) {
        context.check_cancelled();
        Array<Vec3> offsets;
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const u32 index = batch.indices[i];
            offsets.assign(1, Vec3::Zero());
            std::size_t slot = index * field.each;
            for (const Neighbour& neighbour : batch.of(i)) {
                field.nearest[slot++] = neighbour.index;
                offsets.push_back(positions[neighbour.index] - positions[index]);
            }
            const Scatter scatter = scatter_of(offsets);
            field.undetermined[index] = scatter.flatness < least_flatness;
            field.variation[index] = scatter.surface_variation;
            field.directions[index] = params.method == Method::jet ? fit_jet(offsets).normal : scatter.normal;
        }
        context.progress(0.5 * static_cast<double>(done += batch.indices.size()) /
                         static_cast<double>(positions.size()));
    });
    return field;
}

/// By position: 1 or -1 where the direction to the scanner decides, else 0.
std::vector<signed char> sides_of_sensor(const PointCloud& cloud, const PointTree& tree, const NormalField& field,
                                         const NormalsParams& params, const Column* approach) {
    const std::span<const u32> index_of_row = tree.index_of_row();
    std::vector<signed char> sides(field.directions.size(), 0);
    Array<Vec3> sums(field.directions.size(), Vec3::Zero());
    Vec3 scanner = Vec3::Zero();
    if (params.scanner) scanner = position_of(*params.scanner, "scanner") - cloud.frame.origin;
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const Vec3 direction = params.scanner
                                   ? Vec3(scanner - cloud.positions[row])
                                   : Vec3(approach->number(row, 0), approach->number(row, 1), approach->number(row, 2));
        const double length = direction.stableNorm();
        if (length > 0 && std::isfinite(length)) sums[index_of_row[row]] += direction / length;
    }
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const double along = sums[i].dot(field.directions[i]);
        if (std::abs(along) > grazing_cosine * sums[i].norm()) sides[i] = along > 0 ? 1 : -1;
    }
    return sides;
}

/// For every position, its nearest positions and the positions that have it among their nearest.
class Graph {
public:
    explicit Graph(const NormalField& field)
        : field_(field),
          reverse_(field.directions.size(), [&](auto&& add) {
              for (u32 i = 0; i < field.directions.size(); ++i)
                  for (const u32 to : field.of(i)) add(to, i);
          }) {}
    template <class Action>
    void for_each_neighbour(u32 i, Action&& action) const {
        for (const u32 other : field_.of(i)) action(other);
        for (const u32 other : reverse_[i]) action(other);
    }
    DisjointSets components() const {
        DisjointSets sets(field_.directions.size());
        for (u32 i = 0; i < field_.directions.size(); ++i)
            for (const u32 other : field_.of(i)) sets.unite(i, other);
        return sets;
    }

private:
    const NormalField& field_;
    Lists<> reverse_;
};

/// Number of components whose side is decided by their highest position alone, and number of positions in them. The
/// largest of all components does not count.
struct Guessed {
    std::size_t components = 0, positions = 0;
};

/// Orients the highest position of each component without an oriented position. `count`: number of components.
Guessed seed_components(std::span<const Vec3> positions, const NormalField& field, DisjointSets& components,
                        std::vector<signed char>& sides, std::size_t& count) {
    struct Component {
        std::size_t size = 0;
        u32 highest = 0;
        Vec3 sum = Vec3::Zero();
        bool seeded = false;
    };
    std::vector<Component> of(positions.size());
    for (u32 i = 0; i < positions.size(); ++i) {
        Component& its = of[components.find(i)];
        if (its.size == 0 || positions[i].z() > positions[its.highest].z()) its.highest = i;
        ++its.size;
        its.sum += positions[i] - positions[components.find(i)];
        its.seeded = its.seeded || sides[i] != 0;
    }
    Guessed guessed, largest_guessed;
    std::size_t largest = 0;
    for (u32 i = 0; i < positions.size(); ++i) {
        const Component& its = of[i];
        if (its.size == 0) continue;
        ++count;
        if (its.size > largest) {
            largest = its.size;
            largest_guessed = its.seeded ? Guessed{} : Guessed{1, its.size};
        }
        if (its.seeded) continue;
        ++guessed.components;
        guessed.positions += its.size;
        const Vec3& normal = field.directions[its.highest];
        const Vec3 centroid = positions[i] + its.sum / static_cast<double>(its.size);
        const double up = normal.z() != 0 ? normal.z() : normal.dot(positions[its.highest] - centroid);
        sides[its.highest] = up < 0 ? -1 : 1;
    }
    return {guessed.components - largest_guessed.components, guessed.positions - largest_guessed.positions};
}

/// Spreads sides to the other positions by Prim's algorithm, starting from all positions that have a side.
void spread(const NormalField& field, const Graph& graph, std::vector<signed char>& sides, Context& context) {
    struct Link {
        double weight;
        u32 to, from;
        auto key() const { return std::tie(weight, to, from); }
        bool operator>(const Link& other) const { return key() > other.key(); }
    };
    const std::size_t count = sides.size();
    constexpr u32 invalid_index = ~u32(0);
    std::vector<double> least(count, std::numeric_limits<double>::infinity());
    std::vector<u32> best(count, invalid_index);
    std::priority_queue<Link, std::vector<Link>, std::greater<>> queue;
    const auto offer = [&](u32 from) {
        graph.for_each_neighbour(from, [&](u32 to) {
            if (sides[to] != 0) return;
            const double weight = 1 - std::abs(field.directions[from].dot(field.directions[to]));
            if (weight > least[to] || (weight == least[to] && from >= best[to])) return;
            least[to] = weight;
            best[to] = from;
            queue.push({weight, to, from});
        });
    };
    std::size_t decided = 0;
    std::vector<u32> seeds;
    for (u32 i = 0; i < count; ++i)
        if (sides[i] != 0) seeds.push_back(i);
    for (const u32 seed : seeds) {
        if ((++decided & 0x3fff) == 0) context.check_cancelled();
        offer(seed);
    }
    while (!queue.empty()) {
        const Link link = queue.top();
        queue.pop();
        if (sides[link.to] != 0) continue;
        const double cosine = field.directions[link.from].dot(field.directions[link.to]);
        sides[link.to] = static_cast<signed char>(cosine < 0 ? -sides[link.from] : sides[link.from]);
        if ((++decided & 0x3fff) == 0) {
            context.check_cancelled();
            context.progress(0.5 + 0.4 * static_cast<double>(decided) / static_cast<double>(count));
        }
        offer(link.to);
    }
}

/// By position: 1 if its normal is undetermined, or if the normals of most neighbours are on the other side.
std::vector<u8> doubtful_positions(const NormalField& field, const std::vector<signed char>& sides, bool oriented,
                                   Context& context) {
    std::vector<u8> doubtful(field.undetermined);
    if (!oriented) return doubtful;
    for_each_chunk(context.threads(), doubtful.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
            std::size_t against = 0;
            for (const u32 other : field.of(i))
                against += sides[i] * sides[other] * field.directions[i].dot(field.directions[other]) < 0;
            if (2 * against > field.each) doubtful[i] = 1;
        }
    });
    return doubtful;
}

PointCloud with_normals(const PointCloud& cloud, std::span<const u32> index_of_row, const NormalField& field,
                        const std::vector<signed char>& sides, Context& context) {
    Array<float> values(3 * cloud.size());
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const u32 index = index_of_row[row];
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const double value = field.directions[index][static_cast<Eigen::Index>(axis)];
            values[3 * row + axis] = static_cast<float>(sides[index] < 0 ? -value : value);
        }
    }
    PointCloud result = cloud;
    add_column(result.columns, Column("normal", 3, Buffer<float>(std::move(values))), context);
    return result;
}

void require_usable(const PointCloud& cloud, const NormalsParams& params) {
    if (params.neighbours < 2 || params.neighbours > 1000)
        throw Error("neighbours must be from 2 to 1000; it is {}", params.neighbours)
            .hint("16 suits most scans; noisy scans need more");
    if (params.scanner && (params.orient == Orient::tree || params.orient == Orient::none))
        throw Error("scanner is given, but orient is `{}`, which does not use it",
                    params.orient == Orient::tree ? "tree" : "none")
            .hint("leave scanner out, or write `orient: sensor`");
    if (params.scanner) position_of(*params.scanner, "scanner");
    require_points(cloud, "normals need at least 3");
}

/// The column `approach` if the directions come from it; throws Error if it is not usable.
const Column* sensor_column(const PointCloud& cloud, const NormalsParams& params) {
    if (params.scanner || params.orient == Orient::tree || params.orient == Orient::none) return nullptr;
    const Column* approach = cloud.columns.find("approach");
    if (approach && approach->components() != 3)
        throw Error("the column 'approach' has {} per point; a direction to the scanner needs 3 numbers",
                    approach->is_list() ? "a list" : count_text(approach->components(), "number", "numbers"))
            .hint("give the scanner's position by `scanner`, or `orient: tree`");
    if (!approach && params.orient == Orient::sensor)
        throw Error("orient is `sensor`, but the scan has no column 'approach' and no scanner's position is given")
            .hint("give the scanner's position by `scanner: [0 u, 0 u, 10 u]`, or `orient: tree`");
    return approach;
}

void report_doubts(const NormalsResult& result, const Guessed& guessed, std::size_t positions, Context& context) {
    const double count = static_cast<double>(result.points.size());
    if (static_cast<double>(result.doubtful) > doubtful_share * count)
        context.doubt(fmt::format(
            "{} of {} points ({:.0f} %) have a doubtful normal: their neighbours lie on a line, or most neighbours "
            "have normals on the other side. More neighbours, or outlier-removal before this step, may help",
            result.doubtful, result.points.size(), 100 * static_cast<double>(result.doubtful) / count));
    const double share = static_cast<double>(guessed.positions) / static_cast<double>(positions);
    if (share > doubtful_share)
        context.doubt(fmt::format(
            "{} turned by {} alone: {:.0f} % of the positions may be inside out; give the scanner's position, or more "
            "neighbours",
            count_text(guessed.components, "connected component beside the largest is",
                       "connected components beside the largest are"),
            by_count(guessed.components, "its highest point", "their highest points"), 100 * share));
}

/// Doubts the result if the neighbours of most positions surround the scan, or fill a volume.
void doubt_variation(Array<double> variation, std::size_t neighbours, Context& context) {
    if (const double share = median(variation); share > doubtful_variation)
        context.doubt(fmt::format(
            "the {} neighbours of a point form no surface: {:.0f} % of their spread is across the plane that fits "
            "them (median; a hemisphere has 11 %, a ball 33 %); take fewer neighbours, or scan more points",
            neighbours, 100 * share));
}

void report(const NormalsResult& result, Context& context) {
    context.metric("oriented", static_cast<double>(result.oriented));
    context.metric("by-sensor", static_cast<double>(result.by_sensor));
    context.metric("doubtful", static_cast<double>(result.doubtful));
    context.metric("components", static_cast<double>(result.components));
    context.progress(1);
}

}  // namespace

NormalsResult normals(const PointCloud& cloud, const NormalsParams& params, Context& context) {
    require_usable(cloud, params);
    const Column* approach = sensor_column(cloud, params);
    if (params.orient == Orient::known && !approach && !params.scanner) {
        NormalsResult unchanged;
        unchanged.points = cloud;
        report(unchanged, context);
        return unchanged;
    }
    context.check_cancelled();
    const PointTree tree(cloud.positions.span(), context.threads());
    const std::span<const Vec3> positions = tree.positions();
    if (positions.size() < 3)
        throw Error("the cloud has {}; normals need at least 3",
                    count_text(positions.size(), "distinct position", "distinct positions"))
            .hint("`scanmill info` shows what a file contains");
    const NormalField field = estimated(tree, params, context);
    if (std::ranges::all_of(field.undetermined, [](u8 it) { return it == 1; }))
        throw Error("the neighbours of each of the {} positions lie on one line; a normal needs a plane",
                    positions.size())
            .hint("a scan of single lines needs more neighbours than a line has points");

    NormalsResult result;
    std::vector<signed char> sides(positions.size(), 0);
    const bool use_sensor =
        approach || (params.scanner && params.orient != Orient::tree && params.orient != Orient::none);
    if (use_sensor) sides = sides_of_sensor(cloud, tree, field, params, approach);
    const std::vector<signed char> sensed = sides;
    const Graph graph(field);
    DisjointSets components = graph.components();
    Guessed guessed;
    if (params.orient == Orient::none) {
        for (u32 i = 0; i < positions.size(); ++i) result.components += components.find(i) == i;
    } else {
        guessed = seed_components(positions, field, components, sides, result.components);
        spread(field, graph, sides, context);
    }
    const std::vector<u8> doubtful = doubtful_positions(field, sides, params.orient != Orient::none, context);
    for (const u32 index : tree.index_of_row()) {
        result.oriented += sides[index] != 0;
        result.by_sensor += sensed[index] != 0;
        result.doubtful += doubtful[index];
    }
    result.points = with_normals(cloud, tree.index_of_row(), field, sides, context);
    doubt_variation(std::move(field.variation), field.each, context);
    report_doubts(result, guessed, positions.size(), context);
    report(result, context);
    return result;
}

}  // namespace scanmill
