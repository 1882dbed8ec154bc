// SPDX-License-Identifier: GPL-3.0-or-later
#include "cocone/peeling.hpp"

#include <algorithm>
#include <atomic>
#include <bit>
#include <utility>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/geometry/tets/circumspheres.hpp"

namespace scanmill::cocones {

namespace {

constexpr std::size_t chunk = 1 << 12;
/// Two triangles that meet with this cosine or less between their normals lie on each other.
constexpr double folded_cosine = -0.9;

/// By vertex: whether it is good, see peel().
Array<u8> good_points(const TetMesh& tets, const SurfaceMesh& surface, std::span<const u8> flat, Context& context) {
    const TriangleMesh& mesh = surface.mesh;
    const std::span<const u32> opposite = surface.opposite;
    const std::size_t count = tets.positions.size();
    Array<u32> triangles_at(count, 0u), first(count, half_edges::boundary);
    for (u32 h = 0; h < opposite.size(); ++h) {
        const u32 vertex = half_edges::start(mesh, h);
        ++triangles_at[vertex];
        first[vertex] = std::min(first[vertex], h);
    }
    Array<u8> good(count, u8(0));
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            if (triangles_at[vertex] == 0) continue;
            // Half-edges from the vertex, in clockwise order.
            u32 walked = 0, h = first[vertex];
            do {
                h = opposite[h];
                if (h == half_edges::boundary) break;
                h = half_edges::after(h);
                ++walked;
            } while (h != first[vertex]);
            good[vertex] = h != half_edges::boundary && walked == triangles_at[vertex];
        }
    });
    for_each_chunk(context.threads(), opposite.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        for (std::size_t i = begin; i < end; ++i) {
            const u32 h = static_cast<u32>(i);
            if (opposite[h] == half_edges::boundary || opposite[h] < h) continue;
            const Vec3 a = area_vector(tets.positions.span(), mesh.triangles[h / 3]),
                       b = area_vector(tets.positions.span(), mesh.triangles[opposite[h] / 3]);
            const double cosine = a.dot(b), size = a.norm() * b.norm();
            for (const u32 vertex : {half_edges::start(mesh, h), half_edges::end(mesh, h)})
                if (cosine <= folded_cosine * size || (cosine < 0 && flat[vertex] == 0))
                    std::atomic_ref(good[vertex]).store(0, std::memory_order_relaxed);
        }
    });
    return good;
}

/// By cell, bit i: corner i is a good point, and there the cell is on the outer side of the surface. From the outer
/// side of each facet of the surface, the bits of its good corners spread through the other facets at these corners.
Array<u8> outer_corners(const TetMesh& tets, const Surface& surface, std::span<const u8> good, Context& context) {
    Array<u8> outer(tets.cells.size(), u8(0));
    for_each_chunk(context.threads(), outer.size(), chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        std::vector<Side> stack;  // cells and corners
        const auto reach = [&](u32 cell, int corner) {
            const u8 bit = static_cast<u8>(1 << corner);
            if ((std::atomic_ref(outer[cell]).fetch_or(bit, std::memory_order_relaxed) & bit) == 0)
                stack.push_back({cell, corner});
        };
        for (std::size_t c = begin; c < end; ++c) {
            const u32 seed = static_cast<u32>(c);
            for (unsigned bits = surface.facets.of(seed) & ~unsigned(surface.inner[seed]); bits != 0; bits &= bits - 1)
                for (int corner = 0; corner < 4; ++corner)
                    if (corner != std::countr_zero(bits) &&
                        good[tets.cells[seed][static_cast<std::size_t>(corner)]] == 1)
                        reach(seed, corner);
            while (!stack.empty()) {
                const auto [cell, corner] = stack.back();
                stack.pop_back();
                const u32 vertex = tets.cells[cell][static_cast<std::size_t>(corner)];
                for (int i = 0; i < 4; ++i) {
                    const u32 across = tets.neighbours[cell][static_cast<std::size_t>(i)];
                    if (i != corner && across != TetMesh::outside_hull && !surface.facets.contains(cell, i))
                        reach(across, corner_of(tets, across, vertex));
                }
            }
        }
    });
    return outer;
}

class Peel {
public:
    Peel(const Diagram& diagram, const Surface& surface, const SurfaceMesh& mesh, std::span<const u8> flat,
         Context& context)
        : tets_(diagram.tets),
          surface_(surface),
          context_(context),
          good_(good_points(tets_, mesh, flat, context)),
          outer_(outer_corners(tets_, surface, good_, context)),
          components_(tets_.positions.size()),
          outside_of_(tets_.positions.size(), Outside::unknown),
          is_out_(tets_.cells.size(), u8(0)) {
        for (const Triangle& t : mesh.mesh.triangles)
            for (std::size_t k = 0; k < 3; ++k)
                if (good_[t[k]] == 1 && good_[t[(k + 1) % 3]] == 1) components_.unite(t[k], t[(k + 1) % 3]);
    }

    Peeling run(std::span<const Side> inside) {
        for (const Side& side : inside)
            for (int k = 0; k < 4; ++k)
                if (k != side.corner && is_good(side.cell, k)) decide(side.cell, k, !is_outer(side.cell, k));
        // The good points of the hull come first: the space beyond the hull is outside.
        for_each_hull_facet([&](const Side& side) {
            const bool on_surface = surface_.facets.contains(side);
            for (int k = 0; k < 4; ++k)
                if (k != side.corner && is_good(side.cell, k))
                    decide(side.cell, k, on_surface != is_outer(side.cell, k));
        });
        for_each_hull_facet([&](const Side& side) { enter(side); });
        for (std::size_t i = 0; i < queue_.size(); ++i) {
            if ((i & 0xffff) == 0) context_.check_cancelled();
            for (int corner = 0; corner < 4; ++corner)
                if (const Side across = other_side(tets_, {queue_[i], corner}); across.is_cell()) enter(across);
        }
        remove_components_without_good_points();
        Peeling result;
        result.labels.resize(is_out_.size());
        std::ranges::transform(is_out_, result.labels.begin(), [](u8 out) { return u8(out == 0); });
        for (u32 vertex = 0; vertex < good_.size(); ++vertex) {
            if (good_[vertex] == 0) continue;
            const u32 root = components_.find(vertex);
            const bool is_reached = outside_of_[root] != Outside::unknown;
            result.good += is_reached;
            result.enclosed += !is_reached && root == vertex;
        }
        return result;
    }

private:
    /// The side of a component of good points that is outside.
    enum class Outside : u8 { unknown, outer, inner };

    template <class Visit>
    void for_each_hull_facet(const Visit& visit) const {
        for (u32 cell = 0; cell < tets_.cells.size(); ++cell)
            for (int corner = 0; corner < 4; ++corner)
                if (tets_.neighbours[cell][static_cast<std::size_t>(corner)] == TetMesh::outside_hull)
                    visit(Side{cell, corner});
    }
    u32 vertex(u32 cell, int corner) const { return tets_.cells[cell][static_cast<std::size_t>(corner)]; }
    bool is_good(u32 cell, int corner) const { return good_[vertex(cell, corner)] == 1; }
    bool is_outer(u32 cell, int corner) const { return (outer_[cell] >> corner & 1) != 0; }
    Outside& outside_of(u32 cell, int corner) { return outside_of_[components_.find(vertex(cell, corner))]; }
    void decide(u32 cell, int corner, bool outer_is_outside) {
        if (Outside& its = outside_of(cell, corner); its == Outside::unknown)
            its = outer_is_outside ? Outside::outer : Outside::inner;
    }

    /// Decides whether the outside spreads into the cell through a facet.
    void enter(const Side& side) {
        const u32 cell = side.cell;
        if (is_out_[cell] == 1) return;
        int outside = 0, inside = 0, undecided = 0;
        for (int k = 0; k < 4; ++k) {
            if (!is_good(cell, k)) continue;
            const Outside its = outside_of(cell, k);
            if (its == Outside::unknown)
                ++undecided;
            else
                ++((its == Outside::outer) == is_outer(cell, k) ? outside : inside);
        }
        if (inside > 0 ? inside >= outside : outside == 0 && undecided == 0 && is_smallest_facet(side)) return;
        is_out_[cell] = 1;
        queue_.push_back(cell);
        for (int k = 0; undecided > 0 && k < 4; ++k)
            if (is_good(cell, k)) decide(cell, k, is_outer(cell, k));
    }

    /// Components of cells that no good point supports are what the peel left of outliers, unless no point is good. If
    /// all points are good, there is none.
    void remove_components_without_good_points() {
        const auto good = static_cast<std::size_t>(std::ranges::count(good_, u8(1)));
        if (good == 0 || good == good_.size()) return;
        Array<u8> seen = is_out_;
        for (u32 seed = 0; seed < seen.size(); ++seed) {
            if ((seed & 0xffff) == 0) context_.check_cancelled();
            if (seen[seed] == 1) continue;
            seen[seed] = 1;
            queue_.assign(1, seed);
            bool has_good = false;
            for (std::size_t i = 0; i < queue_.size(); ++i)
                for (int corner = 0; corner < 4; ++corner) {
                    has_good |= is_good(queue_[i], corner);
                    const u32 across = tets_.neighbours[queue_[i]][static_cast<std::size_t>(corner)];
                    if (across == TetMesh::outside_hull || std::exchange(seen[across], u8(1)) == 1) continue;
                    queue_.push_back(across);
                }
            for (std::size_t i = 0; i < queue_.size() && !has_good; ++i) is_out_[queue_[i]] = 1;
        }
    }

    bool is_smallest_facet(const Side& side) const {
        std::array<double, 4> squared;
        for (int i = 0; i < 4; ++i) {
            const auto [a, b, c] = corners_of(tets_, {side.cell, i});
            squared[static_cast<std::size_t>(i)] =
                squared_circumradius(tets_.positions[a], tets_.positions[b], tets_.positions[c]);
        }
        return std::ranges::min_element(squared) - squared.begin() == side.corner;
    }

    const TetMesh& tets_;
    const Surface& surface_;
    Context& context_;
    Array<u8> good_, outer_;
    DisjointSets components_;
    Array<Outside> outside_of_;  ///< at the root of each component
    Array<u8> is_out_;
    std::vector<u32> queue_;
};

}  // namespace

Peeling peel(const Diagram& diagram, const Surface& surface, const SurfaceMesh& mesh, std::span<const u8> flat,
             Context& context, std::span<const Side> inside) {
    return Peel(diagram, surface, mesh, flat, context).run(inside);
}

}  // namespace scanmill::cocones
