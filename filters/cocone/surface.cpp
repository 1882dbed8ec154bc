// SPDX-License-Identifier: GPL-3.0-or-later
#include "cocone/surface.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cassert>
#include <deque>

#include "cocone/candidates.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"

namespace scanmill::cocones {

namespace {

std::size_t count(const TetMesh& tets, const FacetSet& set) {
    std::size_t number = 0;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
        for (unsigned bits = set.of(cell); bits != 0; bits &= bits - 1)
            number += owns_facet(tets, cell, std::countr_zero(bits));
    return number;
}

/// Outliers can have candidates among themselves. At 5 % outliers, up to 8 % of them are flat; of known models with 400
/// points and more, at least 40 % are, except for one of which no point is.
constexpr double least_flat = 0.2;

/// Takes a manifold from the candidates by walking over their outer side.
class SurfaceWalk {
public:
    SurfaceWalk(const Diagram& diagram, FacetSet& left, std::span<const u8> umbrellas, std::span<const u8> flat,
                Context& context)
        : tets_(diagram.tets),
          cells_at_(diagram.cells_at),
          left_(left),
          umbrellas_(umbrellas),
          flat_(flat),
          context_(context),
          taken_(tets_.cells.size()),
          inner_(tets_.cells.size(), u8(0)),
          settled_(tets_.cells.size(), std::uint16_t(0)),
          left_count_(count(tets_, left)),
          component_of_(tets_.positions.size()) {}

    /// Walks over every component of the candidates that has a vertex with an umbrella, beginning at its lowest vertex.
    /// If components with flat points enough have most of the vertices, the others are left out. Then walks over the
    /// facets that these walks did not reach, where they have a corner with an umbrella, from the lowest vertex up.
    void run() {
        find_components();
        std::vector<u32> vertices;
        for (u32 vertex = 0; vertex < components_.size(); ++vertex)
            if (components_[vertex].is_accepted) vertices.push_back(components_[vertex].lowest);
        for (const u32 vertex : vertices) walk(seen_from_below(vertex));
        if (left_count_ > 0) walk_over_rest();
        remove_surplus();
    }

    FacetSet take_facets() { return std::move(taken_); }
    Array<u8> take_inner() { return std::move(inner_); }

private:
    /// A component of the candidates, connected through vertices.
    struct Component {
        u32 lowest = TetMesh::outside_hull;
        u32 vertices = 0, umbrellas = 0, flat = 0;
        bool is_accepted = false;
    };

    void find_components() {
        std::vector<bool> is_used(tets_.positions.size());
        for (u32 cell = 0; cell < tets_.cells.size(); ++cell) {
            if ((cell & 0xfffff) == 0) context_.check_cancelled();
            for (unsigned bits = left_.of(cell); bits != 0; bits &= bits - 1) {
                const Triangle corners = corners_of(tets_, {cell, std::countr_zero(bits)});
                component_of_.unite(corners[0], corners[1]);
                component_of_.unite(corners[0], corners[2]);
                for (const u32 vertex : corners) is_used[vertex] = true;
            }
        }
        components_.resize(tets_.positions.size());
        for (u32 vertex = 0; vertex < components_.size(); ++vertex) {
            if (!is_used[vertex]) continue;
            Component& its = components_[component_of_.find(vertex)];
            if (its.vertices == 0 || is_lower(tets_.positions[vertex], tets_.positions[its.lowest]))
                its.lowest = vertex;
            ++its.vertices;
            its.umbrellas += umbrellas_[vertex];
            its.flat += flat_[vertex];
        }
        const auto is_sampled = [](const Component& its) {
            return its.umbrellas > 0 && its.flat >= least_flat * its.vertices;
        };
        std::size_t all = 0, in_sampled = 0;
        for (const Component& its : components_) {
            all += its.vertices;
            if (is_sampled(its)) in_sampled += its.vertices;
        }
        is_sampled_ = 2 * in_sampled > all;
        for (Component& its : components_) its.is_accepted = is_sampled_ ? is_sampled(its) : its.umbrellas > 0;
    }

    void walk_over_rest() {
        std::vector<u32> vertices;
        for (u32 cell = 0; cell < tets_.cells.size(); ++cell)
            for (unsigned bits = left_.of(cell); bits != 0; bits &= bits - 1)
                for (const u32 vertex : corners_of(tets_, {cell, std::countr_zero(bits)})) vertices.push_back(vertex);
        std::ranges::sort(vertices);
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        std::ranges::sort(vertices, is_lower, [&](u32 vertex) -> const Vec3& { return tets_.positions[vertex]; });
        // When a vertex is reached, no facet is left at a lower one.
        for (const u32 vertex : vertices)
            while (components_[component_of_.find(vertex)].is_accepted && has_facet_left(vertex))
                walk(seen_from_below(vertex));
    }

    /// Whether a facet with a corner that owns an umbrella, and with a flat one, is left at the vertex. Drops the
    /// others. If no component is well sampled, flat corners do not matter.
    bool has_facet_left(u32 vertex) {
        bool found = false;
        for (const u32 cell : cells_at_[vertex])
            for (unsigned bits = left_.of(cell); bits != 0; bits &= bits - 1) {
                const Side side{cell, std::countr_zero(bits)};
                const Triangle corners = corners_of(tets_, side);
                if (std::ranges::find(corners, vertex) == corners.end()) continue;
                const auto any = [&](std::span<const u8> flags) {
                    return std::ranges::any_of(corners, [&](u32 corner) { return flags[corner] == 1; });
                };
                if (any(umbrellas_) && (any(flat_) || !is_sampled_))
                    found = true;
                else
                    drop(side);
            }
        return found;
    }

    /// A candidate at the vertex with its outer side towards lower x. Pre: there is one, and none at a lower vertex of
    /// the component.
    OrientedFacet seen_from_below(u32 vertex) const {
        std::vector<u32> cells(cells_at_[vertex].begin(), cells_at_[vertex].end());
        std::ranges::sort(cells);
        std::vector<u32> queue;
        std::vector<bool> seen(cells.size());
        const auto visit = [&](u32 cell) {
            const auto i = static_cast<std::size_t>(std::ranges::lower_bound(cells, cell) - cells.begin());
            if (!seen[i]) {
                seen[i] = true;
                queue.push_back(cell);
            }
        };
        const auto [downwards, excess] = cell_downwards(cells, vertex);
        if (excess > 0) {
            // No cell contains the direction to lower x: it leaves the hull.
            for (const u32 cell : cells)
                for (int i = 0; i < 4; ++i)
                    if (tets_.neighbours[cell][static_cast<std::size_t>(i)] == TetMesh::outside_hull &&
                        tets_.cells[cell][static_cast<std::size_t>(i)] != vertex) {
                        if (left_.contains(cell, i)) return {{cell, i}, true};
                        visit(cell);
                    }
        }
        if (queue.empty()) visit(downwards);
        for (std::size_t k = 0; k < queue.size(); ++k)
            for (int i = 0; i < 4; ++i) {
                const u32 cell = queue[k];
                if (tets_.cells[cell][static_cast<std::size_t>(i)] == vertex) continue;
                if (left_.contains(cell, i)) return {{cell, i}, false};
                if (const u32 next = tets_.neighbours[cell][static_cast<std::size_t>(i)]; next != TetMesh::outside_hull)
                    visit(next);
            }
        // All candidates at the vertex are seen from beyond the hull alone.
        for (const u32 cell : cells)
            for (int i = 0; i < 4; ++i)
                if (left_.contains(cell, i) && tets_.cells[cell][static_cast<std::size_t>(i)] != vertex)
                    return {{cell, i}, false};
        assert(false);
        return {{cells[0], 0}, false};
    }

    /// The cell at the vertex that contains the direction to lower x, and the cosine by which the direction is outside
    /// of it: at most 0, unless it leaves the hull or by rounding.
    std::pair<u32, double> cell_downwards(std::span<const u32> cells, u32 vertex) const {
        std::pair<u32, double> best{cells[0], 2};
        for (const u32 cell : cells) {
            double largest = -1;
            for (int i = 0; i < 4; ++i)
                if (tets_.cells[cell][static_cast<std::size_t>(i)] != vertex)
                    largest = std::max(
                        largest, -area_vector(tets_.positions.span(), corners_of(tets_, {cell, i})).normalized().x());
            if (largest < best.second) best = {cell, largest};
        }
        return best;
    }

    Side owner_of(const Side& side) const {
        return owns_facet(tets_, side.cell, side.corner) ? side : other_side(tets_, side);
    }
    bool is_settled(const Side& side, u32 third) const {
        const Side owner = owner_of(side);
        return (settled_[owner.cell] >> (4 * owner.corner + corner_of(tets_, owner.cell, third)) & 1) != 0;
    }
    void settle(const Side& side, u32 third) {
        const Side owner = owner_of(side);
        settled_[owner.cell] = static_cast<std::uint16_t>(
            settled_[owner.cell] | 1u << (4 * owner.corner + corner_of(tets_, owner.cell, third)));
    }
    /// Whether the taken facet has its outer side where `facet` has it.
    bool has_orientation(const OrientedFacet& facet) const {
        if ((inner_[facet.side.cell] >> facet.side.corner & 1) != 0) return facet.inner;
        return !facet.inner;
    }
    void drop(const Side& side) {
        left_.remove(tets_, side);
        --left_count_;
    }
    void take(const OrientedFacet& facet) {
        drop(facet.side);
        taken_.add(tets_, facet.side);
        const Side inner = facet.inner ? facet.side : other_side(tets_, facet.side);
        if (inner.is_cell()) inner_[inner.cell] = static_cast<u8>(inner_[inner.cell] | 1 << inner.corner);
        for (const u32 third : corners_of(tets_, facet.side)) queues_[0].push_back({facet, third});
    }
    std::array<u32, 2> edge_of(const Side& side, u32 third) const {
        Triangle corners = corners_of(tets_, side);
        std::ranges::rotate(corners, std::ranges::find(corners, third));
        return {corners[1], corners[2]};
    }
    u32 third_at(const Side& side, u32 a, u32 b) const {
        for (const u32 vertex : corners_of(tets_, side))
            if (vertex != a && vertex != b) return vertex;
        return a;
    }

    /// Walks over a component, across certain edges first. So if fronts of different orientation meet, they meet where
    /// the surface is uncertain.
    void walk(const OrientedFacet& seed) {
        take(seed);
        for (std::size_t steps = 0; true; ++steps) {
            if ((steps & 0xffff) == 0) context_.check_cancelled();
            const auto queue = std::ranges::find_if(queues_, [](const auto& its) { return !its.empty(); });
            if (queue == queues_.end()) return;
            const OpenEdge edge = queue->front();
            queue->pop_front();
            cross(edge.facet, edge.third, static_cast<std::size_t>(queue - queues_.begin()));
        }
    }

    /// Continues the surface across an edge, unless the edge is less certain than `most` allows; then the edge waits.
    void cross(const OrientedFacet& facet, u32 third, std::size_t most) {
        if (is_settled(facet.side, third) || !taken_.contains(facet.side)) return;
        const auto [a, b] = edge_of(facet.side, third);
        facets_seen(
            tets_, facet, third, [&](const Side& side) { return left_.contains(side) || taken_.contains(side); },
            others_);
        if (others_.empty()) return;
        const auto is_taken = [&](const OrientedFacet& other) { return taken_.contains(other.side); };
        const auto taken = std::ranges::count_if(others_, is_taken);
        const bool is_ambiguous = others_.size() > 1;
        const std::size_t ends = std::size_t(umbrellas_[a]) + umbrellas_[b];
        if (taken > 1 || (is_ambiguous && ends == 0)) return;
        const std::size_t uncertainty = is_ambiguous ? 2 : ends == 2 ? 0 : 1;
        if (uncertainty > most) {
            queues_[uncertainty].push_back({facet, third});
            return;
        }
        const OrientedFacet next = taken > 0 ? *std::ranges::find_if(others_, is_taken) : others_.front();
        const u32 its_third = third_at(next.side, a, b);
        if (taken > 0) {
            if (is_settled(next.side, its_third) || !has_orientation(next)) return;
        } else {
            take(next);
        }
        settle(facet.side, third);
        settle(next.side, its_third);
        for (const OrientedFacet& other : others_)
            if (left_.contains(other.side)) drop(other.side);
    }

    /// Removes taken facets at edges with more than two of them, where the others continue each other, and those at
    /// edges with two that do not.
    void remove_surplus() {
        std::vector<Side> surplus;
        context_.check_cancelled();
        for (u32 cell = 0; cell < tets_.cells.size(); ++cell)
            for (unsigned bits = taken_.of(cell); bits != 0; bits &= bits - 1) {
                const Side side{cell, std::countr_zero(bits)};
                if (!owns_facet(tets_, cell, side.corner)) continue;
                for (const u32 third : corners_of(tets_, side)) {
                    if (is_settled(side, third)) continue;
                    const bool is_inner = (inner_[side.cell] >> side.corner & 1) != 0;
                    facets_seen(
                        tets_, {side, is_inner}, third, [&](const Side& its) { return taken_.contains(its); }, others_);
                    if (others_.size() > 1 || (others_.size() == 1 && !has_orientation(others_.front()))) {
                        surplus.push_back(side);
                        break;
                    }
                }
            }
        for (const Side& side : surplus) {
            taken_.remove(tets_, side);
            for (const Side& its : {side, other_side(tets_, side)})
                if (its.is_cell()) inner_[its.cell] = static_cast<u8>(inner_[its.cell] & ~(1 << its.corner));
        }
    }

    const TetMesh& tets_;
    const VertexCells& cells_at_;
    FacetSet& left_;
    std::span<const u8> umbrellas_, flat_;
    Context& context_;
    FacetSet taken_;
    Array<u8> inner_;
    /// By owner cell, bit 4 i + j: the edge of the facet opposite to corner i that is opposite to corner j has two
    /// facets that continue each other.
    Array<std::uint16_t> settled_;
    struct OpenEdge {
        OrientedFacet facet;
        u32 third;
    };
    /// Edges of taken facets that the walk has not crossed yet. First those with exactly two candidates and an umbrella
    /// at both ends, then those without such umbrellas, then those with more candidates. New edges enter the first
    /// queue.
    std::array<std::deque<OpenEdge>, 3> queues_;
    std::size_t left_count_;
    DisjointSets component_of_;
    std::vector<Component> components_;  ///< at the root of each set
    bool is_sampled_ = false;  ///< whether components with flat points enough have most of the vertices
    std::vector<OrientedFacet> others_;
};

void require_range(std::string_view name, const Angle& angle, double least, double most) {
    if (!(angle.in_degrees() >= least && angle.in_degrees() <= most))
        throw Error("{} must be an angle from {} to {} degrees; it is {}", name, least, most, angle.text())
            .hint("the defaults are those of the papers and suit most scans");
}

}  // namespace

SurfaceMesh::SurfaceMesh(const TetMesh& tets, const Surface& surface) {
    Array<Triangle> triangles;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
        for (unsigned bits = surface.facets.of(cell); bits != 0; bits &= bits - 1) {
            const Side side{cell, std::countr_zero(bits)};
            if (!owns_facet(tets, cell, side.corner)) continue;
            Triangle corners = corners_of(tets, side);
            if ((surface.inner[cell] >> side.corner & 1) == 0) std::swap(corners[1], corners[2]);
            triangles.push_back(corners);
        }
    mesh.frame = tets.frame;
    mesh.positions = tets.positions;
    mesh.triangles = std::move(triangles);
    opposite = half_edges::opposites(mesh);
}

Surface surface_of(const Diagram& diagram, const Sampling& sampling, const CoconeParams& params, Context& context) {
    const TetMesh& tets = diagram.tets;
    FacetSet chosen = candidates(diagram, sampling, params.lid_factor, context);
    Surface surface{FacetSet(0), {}, count(tets, chosen)};
    const Array<u8> umbrellas = prune(diagram, chosen, params.prune_angle.in_radians(), context);
    SurfaceWalk walk(diagram, chosen, umbrellas, sampling.flat, context);
    walk.run();
    surface.facets = walk.take_facets();
    surface.inner = walk.take_inner();
    return surface;
}

void require_usable(const TetMesh& tets, const CoconeParams& params) {
    if (tets.cells.empty()) throw Error("needs a tetrahedralisation with cells; this one has none");
    if (tets.neighbours.size() != tets.cells.size())
        throw Error("needs the neighbours of all {} cells; there are {}", tets.cells.size(), tets.neighbours.size())
            .hint("'delaunay' computes the neighbours");
    if (!tets.weights.empty())
        throw Error("needs cells made without weights; these {} points have weights", tets.weights.size())
            .hint("use 'delaunay' without `weights`");
    if (const Array<u32> hidden = hidden_vertices(tets); !hidden.empty())
        throw Error("needs every point in a cell; {} of {} points are in none, the first is {}", hidden.size(),
                    tets.positions.size(), hidden[0])
            .hint("'delaunay' without `weights` uses every point");
    require_range("cone-angle", params.cone_angle, 5, 40);
    require_range("prune-angle", params.prune_angle, 90, 170);
    require_range("normal-angle", params.normal_angle, 10, 90);
    require_range("gap-angle", params.gap_angle, 60, 180);
    if (!(params.ratio >= 1)) throw Error("ratio must be at least 1; it is {}", params.ratio);
    if (!(params.lid_factor > 0)) throw Error("lid-factor must be above 0; it is {}", params.lid_factor);
}

void refuse_empty(const TetMesh& tets, const Sampling& sampling, const Surface& surface, const std::string& reason,
                  bool suggests_noise_mode) {
    throw Error("found no surface: of {} points, {} are flat, and {} triangles are candidates{}", tets.positions.size(),
                sampling.pole_flat, surface.candidates, reason)
        .hint(
            fmt::format("the points are too noisy or too sparse for their shape; thin them first ('voxel-thin'){}, or "
                        "take 'alpha-solid'",
                        suggests_noise_mode ? ", use 'tight-cocone: {noise: big-balls}'" : ""));
}

ColumnTable with_sampling(const ColumnTable& given, const SpatialTets& spatial, const Diagram& diagram,
                          const Sampling& sampling, std::span<const Vec3> outward, Context& context) {
    constexpr std::array<std::string_view, 3> names{"pole-normal", "flat", "boundary"};
    ColumnTable result;
    for (const Column& column : given) {
        if (std::ranges::find(names, column.name()) == names.end()) {
            result.add(column);
            continue;
        }
        std::string name = column.name();
        while (given.find(name)) name += "-of-points";
        context.warn(fmt::format("the points already have a column '{}'; it was renamed '{}'", column.name(), name));
        result.add(column.renamed(name));
    }
    const std::size_t count = spatial.vertices.size();
    Array<double> normals(3 * count);
    Array<u8> flat(count), boundary(count);
    for (std::size_t vertex = 0; vertex < count; ++vertex) {
        const std::size_t row = spatial.vertices[vertex];
        const Vec3& pole = diagram.poles.directions[vertex];
        const double sign = outward[row].dot(pole) < 0 ? -1 : 1;
        for (int k = 0; k < 3; ++k) normals[3 * row + static_cast<std::size_t>(k)] = sign * pole[k];
        flat[row] = sampling.flat[vertex];
        boundary[row] = sampling.boundary[vertex];
    }
    result.add(Column("pole-normal", 3, Buffer<double>(std::move(normals))));
    result.add(Column("flat", 1, Buffer<u8>(std::move(flat))));
    result.add(Column("boundary", 1, Buffer<u8>(std::move(boundary))));
    return result;
}

}  // namespace scanmill::cocones
