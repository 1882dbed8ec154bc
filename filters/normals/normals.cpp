// SPDX-License-Identifier: GPL-3.0-or-later
#include "normals/normals.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numeric>
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
/// A component whose area vectors sum to more than this share of its area is open. A sphere has 0, a hemisphere 0.5, a
/// body without a seventh of its area, as where it stands on a table, up to 0.17.
constexpr double open_share = 0.25;
/// Least flux of a closed component, as a share of that of a sphere of its size and area, that shows its inside.
constexpr double least_flux = 0.01;
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
    Array<double>
        areas;  ///< mean squared distance to the nearest, in proportion to the area that a position stands for

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
    field.areas.resize(positions.size());
    std::atomic<std::size_t> done = 0;
    tree.for_each_nearest(field.each, context.threads(), [&](const NeighbourBatch& batch) {
        context.check_cancelled();
        Array<Vec3> offsets;
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const u32 index = batch.indices[i];
            offsets.assign(1, Vec3::Zero());
            std::size_t slot = index * field.each;
            double squares = 0;
            for (const Neighbour& neighbour : batch.of(i)) {
                field.nearest[slot++] = neighbour.index;
                squares += neighbour.squared;
                offsets.push_back(positions[neighbour.index] - positions[index]);
            }
            field.areas[index] = squares / static_cast<double>(field.each);
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

/// What the input shows of the sides.
struct Evidence {
    enum class Source { none, scanner, column };
    Source source = Source::none;
    std::vector<signed char> sides;  ///< by position: 1 or -1; 0 where the input does not show it
};

/// By position, the side of the mean of its points' directions. 0 if a direction is missing (0 or NaN), or if it is
/// nearly perpendicular to the normal.
template <class DirectionOf>
std::vector<signed char> sides_towards(const PointTree& tree, const NormalField& field, DirectionOf&& direction_of) {
    const std::span<const u32> index_of_row = tree.index_of_row();
    std::vector<signed char> sides(field.directions.size(), 0);
    Array<Vec3> sums(field.directions.size(), Vec3::Zero());
    for (std::size_t row = 0; row < index_of_row.size(); ++row) {
        const Vec3 direction = direction_of(row);
        const double length = direction.stableNorm();
        if (length > 0 && std::isfinite(length)) sums[index_of_row[row]] += direction / length;
    }
    for (std::size_t i = 0; i < sides.size(); ++i) {
        const double along = sums[i].dot(field.directions[i]);
        if (std::abs(along) > grazing_cosine * sums[i].norm()) sides[i] = along > 0 ? 1 : -1;
    }
    return sides;
}

Evidence evidence_of(const PointCloud& cloud, const PointTree& tree, const NormalField& field,
                     const NormalsParams& params) {
    if (params.orient == Orient::none) return {Evidence::Source::none, std::vector<signed char>(field.areas.size(), 0)};
    const auto column = [&](const char* name) -> const Column* {
        const Column* found = cloud.columns.find(name);
        return found && found->components() == 3 ? found : nullptr;
    };
    const auto along = [](const Column* found) {
        return [found](std::size_t row) -> Vec3 {
            return {found->number(row, 0), found->number(row, 1), found->number(row, 2)};
        };
    };
    if (params.scanner) {
        const Vec3 scanner = position_of(*params.scanner, "scanner") - cloud.frame.origin;
        return {Evidence::Source::scanner,
                sides_towards(tree, field, [&](std::size_t row) -> Vec3 { return scanner - cloud.positions[row]; })};
    }
    if (const Column* approach = column("approach"); approach && params.orient != Orient::column)
        return {Evidence::Source::scanner, sides_towards(tree, field, along(approach))};
    if (const Column* normal = column("normal"))
        return {Evidence::Source::column, sides_towards(tree, field, along(normal))};
    return {Evidence::Source::none, std::vector<signed char>(field.areas.size(), 0)};
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

/// A connected component of the neighbourhoods.
struct Component {
    std::size_t size = 0;
    u32 highest = 0;
    bool is_seeded = false;  ///< has a position whose side is known from the start
    std::size_t with_evidence = 0, against = 0;  ///< positions
    // Sums over the positions, weighted by their areas:
    double area = 0, squares = 0, flux = 0;
    Vec3 moment = Vec3::Zero(), normals = Vec3::Zero();

    /// The flux of the normals through the component, as a share of that of a sphere of its size and area. Positive if
    /// the normals of a closed component face outwards.
    double relative_flux() const {
        const Vec3 centroid = moment / area;
        const double radius = std::sqrt(std::max(0.0, squares / area - centroid.squaredNorm()));
        return radius > 0 ? (flux - normals.dot(centroid)) / (area * radius) : 0;
    }
    /// Whether the flux shows its inside.
    bool is_clear() const { return normals.norm() <= open_share * area && std::abs(relative_flux()) > least_flux; }
};

/// Number of components whose side is decided by their highest position alone, and number of positions in them. The
/// largest of all components does not count.
struct Guessed {
    std::size_t components = 0, positions = 0;
};

class Components {
public:
    Components(std::span<const Vec3> positions, const NormalField& field, const Graph& graph)
        : positions_(positions),
          field_(field),
          of_(positions.size()),
          sets_(graph.components()) {
        for (u32 i = 0; i < positions.size(); ++i) {
            Component& its = of_[sets_.find(i)];
            if (its.size == 0) ++count_;
            if (its.size == 0 || positions[i].z() > positions[its.highest].z()) its.highest = i;
            ++its.size;
        }
    }
    std::size_t count() const { return count_; }

    /// Gives a side to the highest position of each component that has none yet: upwards, or away from the centroid if
    /// the normal is horizontal.
    void start(std::vector<signed char>& sides) {
        Array<Vec3> sums(of_.size(), Vec3::Zero());
        for (u32 i = 0; i < positions_.size(); ++i) {
            const u32 first = sets_.find(i);
            sums[first] += positions_[i] - positions_[first];
            of_[first].is_seeded |= sides[i] != 0;
        }
        for (u32 i = 0; i < of_.size(); ++i) {
            const Component& its = of_[i];
            if (its.size == 0 || its.is_seeded) continue;
            const Vec3& normal = field_.directions[its.highest];
            const Vec3 centroid = positions_[i] + sums[i] / static_cast<double>(its.size);
            const double up = normal.z() != 0 ? normal.z() : normal.dot(positions_[its.highest] - centroid);
            sides[its.highest] = up < 0 ? -1 : 1;
        }
    }

    /// Reverses each component that start() oriented, if the evidence is against it at more positions than not; without
    /// evidence, if it is closed and its normals face inwards.
    Guessed settle(const Evidence& evidence, std::vector<signed char>& sides) {
        sum_up(evidence, sides);
        std::vector<bool> is_reversed(of_.size(), false);
        Guessed guessed, largest_guessed;
        std::size_t largest = 0;
        for (u32 i = 0; i < of_.size(); ++i) {
            const Component& its = of_[i];
            if (its.size == 0) continue;
            const bool is_guessed = !its.is_seeded && its.with_evidence == 0 && !its.is_clear();
            if (!its.is_seeded)
                is_reversed[i] = its.with_evidence > 0 ? 2 * its.against > its.with_evidence
                                                       : its.is_clear() && its.relative_flux() < 0;
            if (its.size > largest) {
                largest = its.size;
                largest_guessed = is_guessed ? Guessed{1, its.size} : Guessed{};
            }
            if (is_guessed) ++guessed.components, guessed.positions += its.size;
        }
        for (u32 i = 0; i < sides.size(); ++i)
            if (is_reversed[sets_.find(i)]) sides[i] = static_cast<signed char>(-sides[i]);
        return {guessed.components - largest_guessed.components, guessed.positions - largest_guessed.positions};
    }

    /// Positions of closed components whose normals face inwards.
    std::size_t facing_inwards(const Evidence& evidence, const std::vector<signed char>& sides) {
        sum_up(evidence, sides);
        std::size_t count = 0;
        for (const Component& its : of_)
            if (its.size > 0 && its.is_clear() && its.relative_flux() < 0) count += its.size;
        return count;
    }

private:
    void sum_up(const Evidence& evidence, const std::vector<signed char>& sides) {
        for (Component& its : of_) {
            its.with_evidence = its.against = 0;
            its.area = its.squares = its.flux = 0;
            its.moment = its.normals = Vec3::Zero();
        }
        for (u32 i = 0; i < positions_.size(); ++i) {
            const u32 first = sets_.find(i);
            Component& its = of_[first];
            its.with_evidence += evidence.sides[i] != 0;
            its.against += evidence.sides[i] * sides[i] < 0;
            const Vec3 p = positions_[i] - positions_[first], n = field_.directions[i] * sides[i];
            const double area = field_.areas[i];
            its.area += area;
            its.squares += area * p.squaredNorm();
            its.moment += area * p;
            its.normals += area * n;
            its.flux += area * n.dot(p);
        }
    }

    std::span<const Vec3> positions_;
    const NormalField& field_;
    /// By representative of the component, which is its lowest position.
    std::vector<Component> of_;
    DisjointSets sets_;
    std::size_t count_ = 0;
};

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

/// By position: 1 if the normals of most neighbours are on the other side.
std::vector<u8> contradicting(const NormalField& field, const std::vector<signed char>& sides, Context& context) {
    std::vector<u8> found(sides.size(), 0);
    for_each_chunk(context.threads(), sides.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
            std::size_t against = 0;
            for (const u32 other : field.of(i))
                against += sides[i] * sides[other] * field.directions[i].dot(field.directions[other]) < 0;
            found[i] = 2 * against > field.each;
        }
    });
    return found;
}

/// Share of the positions that are not in the largest region of their component. Neighbours are in one region if their
/// sides agree. Half of the normals of a sphere reversed: 0.5; both faces of a plate, joined at its edges: 0.
double share_beside_regions(const NormalField& field, const std::vector<signed char>& sides, const Graph& graph) {
    DisjointSets regions(sides.size()), components = graph.components();
    std::size_t all = 0;
    for (u32 i = 0; i < sides.size(); ++i) {
        all += sides[i] != 0;
        for (const u32 other : field.of(i))
            if (sides[i] * sides[other] * field.directions[i].dot(field.directions[other]) > 0) regions.unite(i, other);
    }
    std::vector<std::size_t> size(sides.size(), 0), largest(sides.size(), 0);
    for (u32 i = 0; i < sides.size(); ++i)
        if (sides[i] != 0) ++size[regions.find(i)];
    for (u32 i = 0; i < sides.size(); ++i) {
        std::size_t& most = largest[components.find(i)];
        most = std::max(most, size[i]);
    }
    const std::size_t inside = std::accumulate(largest.begin(), largest.end(), std::size_t{0});
    return all > 0 ? static_cast<double>(all - inside) / static_cast<double>(all) : 0;
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
    const bool uses_scanner =
        params.orient != Orient::tree && params.orient != Orient::none && params.orient != Orient::column;
    if (params.scanner && !uses_scanner)
        throw Error("scanner is given, but orient is `{}`, which does not use it",
                    params.orient == Orient::tree   ? "tree"
                    : params.orient == Orient::none ? "none"
                                                    : "column")
            .hint("leave scanner out, or write `orient: sensor`");
    if (params.scanner) position_of(*params.scanner, "scanner");
    require_points(cloud, "normals need at least 3");
}

/// Whether every point is turned to the scanner. Throws Error if a column that `orient` needs is missing or not usable.
bool has_scanner(const PointCloud& cloud, const NormalsParams& params) {
    if (params.orient == Orient::tree || params.orient == Orient::none) return false;
    const auto require_vectors = [&](const Column& column, const char* what) {
        if (column.components() != 3)
            throw Error("the column '{}' has {} per point; {} needs 3 numbers", column.name(),
                        column.is_list() ? "a list" : count_text(column.components(), "number", "numbers"), what)
                .hint("give the scanner's position by `scanner`, or `orient: tree`");
    };
    if (params.orient == Orient::column) {
        const Column* normal = cloud.columns.find("normal");
        if (!normal)
            throw Error("orient is `column`, but the scan has no column 'normal'")
                .hint("`orient: tree` takes the sides of the neighbours");
        require_vectors(*normal, "a normal");
        return false;
    }
    if (params.scanner) return true;
    const Column* approach = cloud.columns.find("approach");
    if (approach) require_vectors(*approach, "a direction to the scanner");
    if (!approach && params.orient == Orient::sensor)
        throw Error("orient is `sensor`, but the scan has no column 'approach' and no scanner's position is given")
            .hint("give the scanner's position by `scanner: [0 u, 0 u, 10 u]`, or `orient: tree`");
    return approach != nullptr;
}

void doubt_points(const NormalsResult& result, Context& context) {
    const double share = static_cast<double>(result.doubtful) / static_cast<double>(result.points.size());
    if (share > doubtful_share)
        context.doubt(fmt::format(
            "{} of {} points ({:.0f} %) have a doubtful normal: their neighbours lie on a line, or most neighbours "
            "have normals on the other side. More neighbours, or outlier-removal before this step, may help",
            result.doubtful, result.points.size(), 100 * share));
}

void doubt_guesses(const Guessed& guessed, std::size_t positions, Context& context) {
    const double share = static_cast<double>(guessed.positions) / static_cast<double>(positions);
    if (share > doubtful_share)
        context.doubt(fmt::format(
            "{} turned by {} alone: {:.0f} % of the positions may be inside out; give the scanner's position, or more "
            "neighbours",
            count_text(guessed.components, "connected component beside the largest is",
                       "connected components beside the largest are"),
            by_count(guessed.components, "its highest point", "their highest points"), 100 * share));
}

/// Whether the sides of the column `normal` are used. Doubts a column that contradicts itself.
bool keeps_column(const NormalField& field, const std::vector<signed char>& sides, const Graph& graph,
                  const NormalsParams& params, Context& context) {
    if (params.orient == Orient::tree) return false;
    const std::vector<u8> found = contradicting(field, sides, context);
    const double share = static_cast<double>(std::ranges::count(found, u8(1))) / static_cast<double>(found.size());
    const double beside = share_beside_regions(field, sides, graph);
    const bool is_kept = params.orient == Orient::column || share <= doubtful_share;
    const char* consequence = is_kept ? "the sides of the column are kept; `orient: tree` takes those of the neighbours"
                                      : "the neighbours decide; `orient: column` keeps the sides of the column";
    if (share > doubtful_share)
        context.doubt(
            fmt::format("the column 'normal' contradicts itself: at {:.0f} % of the positions, most neighbours "
                        "have normals on the other side; {}",
                        100 * share, consequence));
    else if (beside > doubtful_share)
        context.doubt(
            fmt::format("the column 'normal' contradicts itself: {:.0f} % of the positions are in regions that "
                        "face to the other side than the largest region beside them; {}",
                        100 * beside, consequence));
    return is_kept;
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
    context.metric("against", static_cast<double>(result.against));
    context.metric("doubtful", static_cast<double>(result.doubtful));
    context.metric("components", static_cast<double>(result.components));
    context.progress(1);
}

}  // namespace

NormalsResult normals(const PointCloud& cloud, const NormalsParams& params, Context& context) {
    require_usable(cloud, params);
    const bool sees = has_scanner(cloud, params);
    if (params.orient == Orient::known && !sees) {
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

    const Graph graph(field);
    Components components(positions, field, graph);
    const Evidence evidence = evidence_of(cloud, tree, field, params);
    NormalsResult result;
    result.components = components.count();
    std::vector<signed char> sides(positions.size(), 0);
    std::vector<u8> doubtful(field.undetermined);
    if (params.orient != Orient::none) {
        if (sees) sides = evidence.sides;
        components.start(sides);
        spread(field, graph, sides, context);
        const Guessed guessed = components.settle(evidence, sides);
        doubt_guesses(guessed, positions.size(), context);
        if (evidence.source == Evidence::Source::column &&
            keeps_column(field, evidence.sides, graph, params, context)) {
            for (u32 i = 0; i < sides.size(); ++i)
                if (evidence.sides[i] != 0) sides[i] = evidence.sides[i];
            if (const std::size_t count = components.facing_inwards(evidence, sides); count > 0)
                context.warn(
                    fmt::format("the column 'normal' faces inwards at {} of {} positions: surfaces from these "
                                "normals are inside out, unless the scan is that of a room or a cavity; drop the "
                                "column while reading to "
                                "orient the points without it",
                                count, positions.size()));
        }
        const std::vector<u8> beside = contradicting(field, sides, context);
        for (u32 i = 0; i < sides.size(); ++i) doubtful[i] |= beside[i];
    }
    for (const u32 index : tree.index_of_row()) {
        const bool is_evident = evidence.sides[index] != 0 && sides[index] == evidence.sides[index];
        result.oriented += sides[index] != 0;
        result.by_sensor += is_evident && sees;
        result.against += evidence.sides[index] * sides[index] < 0;
        result.doubtful += doubtful[index];
    }
    result.points = with_normals(cloud, tree.index_of_row(), field, sides, context);
    doubt_variation(std::move(field.variation), field.each, context);
    doubt_points(result, context);
    report(result, context);
    return result;
}

}  // namespace scanmill
