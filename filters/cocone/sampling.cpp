// SPDX-License-Identifier: GPL-3.0-or-later
#include "cocone/sampling.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "scanmill/base/elementary.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/geometry/tets/circumspheres.hpp"

namespace scanmill::cocones {

namespace {

constexpr std::size_t chunk = 1 << 12;
/// Measured on a square patch, a hemisphere, a sphere and a torus: with 16 neighbours and a gap of 100 degrees, all
/// points of the rims are found and no other; with 10 neighbours and 90 degrees, 22 points of the torus, too.
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
        Array<u8> flat(count), is_thin(count);
        for_each_chunk(context_.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
            context_.check_cancelled();
            for (std::size_t vertex = begin; vertex < end; ++vertex) {
                const u32 v = static_cast<u32>(vertex);
                is_thin[v] = has_thin_cell(v);
                flat[v] = is_thin[v] == 1 && has_agreeing_neighbours(v);
            }
        });
        // A flat point passes flatness on to its neighbours. The result does not depend on the order.
        std::vector<u32> queue;
        const auto spread_to = [&](u32 v) {
            if (flat[v] == 1 || is_thin[v] == 0) return;
            bool found = false;
            for_each_neighbour(v, true, [&](u32 q) { found |= flat[q] == 1 && agree(v, q); });
            if (!found) return;
            flat[v] = 1;
            queue.push_back(v);
        };
        for (u32 v = 0; v < count; ++v) spread_to(v);
        for (std::size_t i = 0; i < queue.size(); ++i) {
            const u32 v = queue[i];
            for_each_neighbour(v, true, spread_to);
        }
        return flat;
    }

private:
    bool agree(u32 p, u32 q) const {
        return std::abs(diagram_.poles.directions[p].dot(diagram_.poles.directions[q])) >= least_cosine_;
    }

    /// Calls visit(q) for the cocone neighbours q of v; with `both`, also for the points that have v as one. A point
    /// may be visited several times.
    template <class Visit>
    void for_each_neighbour(u32 v, bool both, const Visit& visit) const {
        for (const u32 cell : diagram_.cells_at[v]) {
            const Tetrahedron& corners = tets_.cells[cell];
            const unsigned hits = diagram_.hits[cell];
            for (unsigned i = 0; i < 4; ++i) {
                if (corners[i] == v) continue;
                const unsigned own = static_cast<unsigned>(std::ranges::find(corners, v) - corners.begin());
                for (unsigned j = 0; j < 4; ++j) {
                    if (j == i || j == own) continue;
                    const bool is_one = (hits >> (4 * i + own) & 1u) != 0;
                    if (is_one || (both && (hits >> (4 * i + j) & 1u) != 0)) visit(corners[j]);
                }
            }
        }
    }

    bool has_agreeing_neighbours(u32 v) const {
        bool all = true;
        for_each_neighbour(v, false, [&](u32 q) { all &= agree(v, q); });
        return all;
    }

    /// Whether the cell reaches, in the tangent plane, at most 1 / ratio of the distance to the nearer pole.
    bool has_thin_cell(u32 v) const {
        const Cocone cocone{tets_.positions[v], diagram_.poles.directions[v], 0};
        const double most = diagram_.poles.heights[v] / ratio_;
        for (const u32 cell : diagram_.cells_at[v]) {
            const Tetrahedron& corners = tets_.cells[cell];
            const unsigned own = static_cast<unsigned>(std::ranges::find(corners, v) - corners.begin());
            for (unsigned i = 0; i < 4; ++i)
                if ((diagram_.hits[cell] >> (4 * i + own) & 1u) != 0 &&
                    !(cocone.squared_reach(dual_edge(tets_, diagram_.centres, cell, static_cast<int>(i))) <=
                      most * most))
                    return false;
        }
        return true;
    }

    const Diagram& diagram_;
    const TetMesh& tets_;
    double least_cosine_, ratio_;
    Context& context_;
};

/// The widest angle between neighbouring directions from the origin to the given points, in their tangent plane.
double widest_gap(std::span<const Vec3> points) {
    if (points.empty()) return 2 * std::numbers::pi;
    const auto [u, v] = directions_across(scatter_of(points).normal);
    std::array<double, gap_neighbours> angles;
    for (std::size_t i = 0; i < points.size(); ++i) {
        const double cosine = points[i].dot(u), sine = points[i].dot(v);
        angles[i] = sine < 0 ? 2 * std::numbers::pi - angle_of(cosine, -sine) : angle_of(cosine, sine);
    }
    std::sort(angles.begin(), angles.begin() + static_cast<std::ptrdiff_t>(points.size()));
    double widest = angles[0] + 2 * std::numbers::pi - angles[points.size() - 1];
    for (std::size_t i = 1; i < points.size(); ++i) widest = std::max(widest, angles[i] - angles[i - 1]);
    return widest;
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
    result.spacing.resize(positions.size());
    result.boundary.resize(positions.size());

    const PointTree tree(positions, context.threads());
    Array<u32> row_of(positions.size());
    for (u32 row = 0; row < positions.size(); ++row) row_of[tree.index_of_row()[row]] = row;
    const double least_gap = params.gap_angle.in_radians();
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
            const double gap = widest_gap(std::span(near).first(neighbours.size()));
            result.boundary[row] = result.flat[row] == 0 || gap > least_gap;
        }
    });
    result.boundary_points = static_cast<std::size_t>(std::ranges::count(result.boundary, u8(1)));
    return result;
}

}  // namespace scanmill::cocones
