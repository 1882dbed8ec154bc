// SPDX-License-Identifier: GPL-3.0-or-later
#include "cocone/sampling.hpp"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "scanmill/base/elementary.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/geometry/tets/circumspheres.hpp"

namespace scanmill::cocones {

namespace {

constexpr std::size_t chunk = 1 << 12;
/// Measured on a square patch, a hemisphere, a sphere and a torus: with 16 neighbours and a gap of 100 degrees, all
/// points of the boundary loops are found and no other; with 10 neighbours and 90 degrees, 22 points of the torus, too.
constexpr std::size_t gap_neighbours = 16;
constexpr std::size_t spacing_neighbours = 6;

/// The flat points by the test with poles.
class Flatness {
public:
    Flatness(const Diagram& diagram, const CoconeParams& params, Context& context)
        : diagram_(diagram),
          tets_(diagram.tets),
          least_cosine_(elementary::turn_of(params.normal_angle.in_radians()).cosine),
          ratio_(params.ratio),
          context_(context) {}

    Array<u8> flat() {
        const std::size_t count = tets_.positions.size();
        Array<u8> flat(count, u8(1)), is_thin(count, u8(1));
        for_each_chunk(context_.threads(), tets_.cells.size(), chunk, [&](std::size_t begin, std::size_t end) {
            context_.check_cancelled();
            const auto clear = [](u8& flag) { std::atomic_ref(flag).store(0, std::memory_order_relaxed); };
            for_each_hit(begin, end, [&](u32 p, u32 q, u32 r, const VoronoiEdge& edge) {
                const bool thin = is_thin_at(p, edge);
                if (!thin) clear(is_thin[p]);
                if (!thin || !agree(p, q) || !agree(p, r)) clear(flat[p]);
            });
        });
        // A flat point passes flatness on to its neighbours. The result does not depend on the order.
        std::vector<u32> queue;
        const auto spread_to = [&](u32 v) {
            if (flat[v] == 1 || is_thin[v] == 0) return;
            bool found = false;
            for_each_neighbour(v, [&](u32 q) { found |= flat[q] == 1 && agree(v, q); });
            if (!found) return;
            flat[v] = 1;
            queue.push_back(v);
        };
        for (u32 v = 0; v < count; ++v) {
            if ((v & 0xffff) == 0) context_.check_cancelled();
            spread_to(v);
        }
        for (std::size_t i = 0; i < queue.size(); ++i) {
            const u32 v = queue[i];
            for_each_neighbour(v, spread_to);
        }
        return flat;
    }

private:
    bool agree(u32 p, u32 q) const {
        return std::abs(diagram_.poles.directions[p].dot(diagram_.poles.directions[q])) >= least_cosine_;
    }

    /// Calls visit(p, q, r, dual edge) for each facet of these cells whose dual edge meets the cocone of its corner p.
    /// The other corners q and r are then cocone neighbours of p.
    template <class Visit>
    void for_each_hit(std::size_t begin, std::size_t end, const Visit& visit) const {
        for (std::size_t c = begin; c < end; ++c) {
            const u32 cell = static_cast<u32>(c);
            for (int i = 0; i < 4; ++i) {
                const unsigned hits = unsigned(diagram_.hits[cell]) >> (4 * i) & 15u;
                if (hits == 0 || !owns_facet(tets_, cell, i)) continue;
                const VoronoiEdge edge = dual_edge(tets_, diagram_.centres, cell, i);
                const auto& facet = outward_facet[static_cast<std::size_t>(i)];
                for (std::size_t k = 0; k < 3; ++k)
                    if ((hits >> facet[k] & 1u) != 0)
                        visit(corner(cell, facet[k]), corner(cell, facet[(k + 1) % 3]),
                              corner(cell, facet[(k + 2) % 3]), edge);
            }
        }
    }

    /// Calls visit(q) for the cocone neighbours q of v and for the points that have v as one, some several times.
    template <class Visit>
    void for_each_neighbour(u32 v, const Visit& visit) const {
        for (const u32 cell : diagram_.cells_at[v])
            for_each_hit(cell, cell + 1, [&](u32 p, u32 q, u32 r, const VoronoiEdge&) {
                if (p == v) {
                    visit(q);
                    visit(r);
                } else if (q == v || r == v) {
                    visit(p);
                }
            });
    }

    u32 corner(u32 cell, int i) const { return tets_.cells[cell][static_cast<std::size_t>(i)]; }

    /// Whether the edge is at most 1 / ratio of the distance to the nearer pole away where it crosses the tangent
    /// plane.
    bool is_thin_at(u32 v, const VoronoiEdge& edge) const {
        const Cocone cocone{tets_.positions[v], diagram_.poles.directions[v], 0};
        const double most = diagram_.poles.heights[v] / ratio_;
        return cocone.squared_reach(edge) <= most * most;
    }

    const Diagram& diagram_;
    const TetMesh& tets_;
    double least_cosine_, ratio_;
    Context& context_;
};

/// Whether neighbouring directions from the origin to the given points, in the plane perpendicular to a normal, leave a
/// gap wider than an angle of at most half a turn, given by cosine and sine.
bool has_gap(std::span<const Vec3> points, const Vec3& normal, const elementary::Turn& angle) {
    const auto [u, v] = directions_across(normal);
    struct Direction {
        double x, y;
        double order;  ///< grows with the direction's angle, from 0 to 4
    };
    std::array<Direction, gap_neighbours> directions;
    auto end = directions.begin();
    for (const Vec3& point : points) {
        const double x = point.dot(u), y = point.dot(v), sum = std::abs(x) + std::abs(y);
        if (sum > 0) *end++ = {x, y, y < 0 ? 3 + x / sum : 1 - x / sum};  // a point along the normal has no direction
    }
    if (end - directions.begin() < 2) return true;
    std::ranges::sort(directions.begin(), end, {}, &Direction::order);
    for (auto a = directions.begin(); a != end; ++a) {
        const auto b = a + 1 == end ? directions.begin() : a + 1;
        // Cosine and sine of the angle from a to b, counter-clockwise, times both lengths. The gap is wider if it is
        // more than half a turn, or if the sine of its difference from the limit is positive.
        const double cosine = a->x * b->x + a->y * b->y, sine = a->x * b->y - a->y * b->x;
        const double difference = b->order - a->order + (a + 1 == end ? 4 : 0);
        if (difference > 2 || sine * angle.cosine - cosine * angle.sine > 0) return true;
    }
    return false;
}

}  // namespace

Diagram::Diagram(const TetMesh& its, double cone_angle, Context& context)
    : tets(its),
      cells_at(its, context.threads()),
      centres(circumcentres(its, context)),
      poles(scanmill::poles(its, centres, cells_at, context)),
      hits(cocone_hits(its, centres, poles, cone_angle, context)) {}

Sampling sampling(const Diagram& diagram, const CoconeParams& params, Context& context) {
    const std::span<const Vec3> positions = diagram.tets.positions.span();
    Sampling result;
    result.flat = Flatness(diagram, params, context).flat();
    result.pole_flat = static_cast<std::size_t>(std::ranges::count(result.flat, u8(1)));
    result.spacing.assign(positions.size(), 0.0);
    result.boundary.assign(positions.size(), u8(0));

    const PointTree tree(positions, context.threads());
    Array<u32> row_of(positions.size());
    for (u32 row = 0; row < positions.size(); ++row) row_of[tree.index_of_row()[row]] = row;
    const elementary::Turn gap = elementary::turn_of(params.gap_angle.in_radians());
    tree.for_each_nearest(gap_neighbours, context.threads(), [&](const NeighbourBatch& batch) {
        context.check_cancelled();
        std::array<Vec3, gap_neighbours> near;
        for (std::size_t i = 0; i < batch.indices.size(); ++i) {
            const std::span<const Neighbour> neighbours = batch.of(i);
            const u32 row = row_of[batch.indices[i]];
            double sum = 0;
            const std::size_t few = std::min(spacing_neighbours, neighbours.size());
            for (std::size_t k = 0; k < few; ++k) sum += std::sqrt(neighbours[k].squared);
            result.spacing[row] = few > 0 ? sum / static_cast<double>(few) : 0;
            for (std::size_t k = 0; k < neighbours.size(); ++k)
                near[k] = tree.positions()[neighbours[k].index] - positions[row];
            const std::span<const Vec3> others = std::span(near).first(neighbours.size());
            // The pole of a flat point is as good a normal as a plane through the neighbours.
            result.boundary[row] = result.flat[row] == 0 || has_gap(others, diagram.poles.directions[row], gap);
        }
    });
    result.boundary_points = static_cast<std::size_t>(std::ranges::count(result.boundary, u8(1)));
    return result;
}

}  // namespace scanmill::cocones
