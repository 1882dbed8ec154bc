// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill_holes/closing_solid.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <boost/graph/adjacency_list.hpp>
#include <boost/graph/boykov_kolmogorov_max_flow.hpp>
#include <limits>
#include <map>
#include <optional>
#include <set>
#include <tuple>
#include <utility>

#include "delaunay/flatness.hpp"
#include "delaunay/triangulate.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/tets/canonical_cells.hpp"
#include "scanmill/geometry/tets/edge_walk.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"
#include "scanmill/geometry/tets/vertex_stars.hpp"

namespace scanmill {

namespace {

/// Largest number of attempts to remove edges with four triangles, by labelling the cells around them inside.
constexpr int most_attempts = 20;

/// Cost of a suggested triangle as a share of its area. It is low because a fair triangulation has more area than the
/// flattest one.
constexpr double cost_of_suggested = 0.1;

/// Areas of the mesh's triangles that claim a cell for the inside and for the outside, and the component of these
/// triangles.
struct Claim {
    double inside = 0, outside = 0;
    u32 component = 0;
};

class Closing {
public:
    Closing(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t given, Context& context)
        : positions_(positions),
          triangles_(triangles),
          given_(given),
          context_(context) {}

    ClosingSolid run() {
        RawTriangulation raw = triangulate(positions_, context_);
        if (raw.dimension < 3) return {};
        CanonicalCells canonical =
            canonical_cells(std::move(raw.cells), std::move(raw.neighbours), positions_.size(), context_.threads());
        tets_.positions = Array<Vec3>(positions_.begin(), positions_.end());
        tets_.cells = std::move(canonical.cells);
        tets_.neighbours = std::move(canonical.neighbours);
        stars_.emplace(tets_);
        claim();
        label();
        drop_specks();
        for (int attempt = 0; attempt < most_attempts; ++attempt) {
            mend_vertices();
            drop_specks();
            ClosingSolid solid = boundary();
            const std::vector<Edge> pinched = edges_of_four(solid);
            if (pinched.empty()) return solid;
            for (const auto& [a, b] : pinched)
                for (const u32 cell : stars_->cells_at(a))
                    if (std::ranges::find(tets_.cells[cell], b) != tets_.cells[cell].end()) labels_[cell] = 1;
        }
        return {};
    }

private:
    static constexpr u32 hull = TetMesh::outside_hull;

    Triangle facet(u32 cell, std::size_t i) const {
        Triangle corners;
        for (std::size_t k = 0; k < 3; ++k)
            corners[k] = tets_.cells[cell][static_cast<std::size_t>(outward_facet[i][k])];
        return corners;
    }

    double area(const Triangle& triangle) const {
        const auto& [a, b, c] = triangle;
        return (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]).norm() / 2;
    }

    double volume(u32 cell) const {
        const auto& [a, b, c, d] = tets_.cells[cell];
        const Vec3& from = positions_[a];
        return std::abs((positions_[b] - from).cross(positions_[c] - from).dot(positions_[d] - from)) / 6;
    }

    /// Cost of a boundary that contains the facet.
    double cost(const Triangle& corners) const {
        const bool is_suggested =
            std::ranges::binary_search(suggested_, smallest_first(corners)) ||
            std::ranges::binary_search(suggested_, smallest_first({corners[0], corners[2], corners[1]}));
        return (is_suggested ? cost_of_suggested : 1) * area(corners);
    }

    void claim() {
        const Array<u32> lowest = lowest_at_position(positions_);
        std::vector<Triangle> directed;
        for (Triangle triangle : triangles_) {
            for (u32& vertex : triangle) vertex = lowest[vertex];
            directed.push_back(smallest_first(triangle));
        }
        const auto first_guess = directed.begin() + static_cast<std::ptrdiff_t>(given_);
        suggested_.assign(first_guess, directed.end());
        directed.erase(first_guess, directed.end());
        std::ranges::sort(directed);
        std::ranges::sort(suggested_);
        DisjointSets components(positions_.size());
        join_vertices(directed, components);
        const auto exists = [&](const Triangle& triangle) {
            return std::ranges::binary_search(directed, smallest_first(triangle));
        };
        claims_.resize(tets_.cells.size());
        double hull_out = 0, hull_in = 0;
        for (u32 cell = 0; cell < claims_.size(); ++cell) {
            if ((cell & 0xffff) == 0) context_.check_cancelled();
            for (std::size_t i = 0; i < 4; ++i) {
                const Triangle corners = facet(cell, i);
                const bool out = exists(corners), in = exists({corners[0], corners[2], corners[1]});
                if (!out && !in) continue;
                const double its = area(corners);
                claims_[cell].component = components.find(corners[0]);
                if (out) claims_[cell].inside += its;
                if (in) claims_[cell].outside += its;
                if (tets_.neighbours[cell][i] == hull) (out ? hull_out : hull_in) += its;
            }
        }
        reversed_ = hull_in > hull_out;
        if (reversed_)
            for (Claim& claim : claims_) std::swap(claim.inside, claim.outside);
    }

    /// Labels claimed cells by their claims, and the other cells by the minimum cut.
    void label() {
        using namespace boost;
        using Traits = adjacency_list_traits<vecS, vecS, directedS>;
        using Graph = adjacency_list<
            vecS, vecS, directedS,
            property<
                vertex_index_t, long,
                property<vertex_color_t, default_color_type,
                         property<vertex_distance_t, long, property<vertex_predecessor_t, Traits::edge_descriptor>>>>,
            property<edge_capacity_t, double,
                     property<edge_residual_capacity_t, double, property<edge_reverse_t, Traits::edge_descriptor>>>>;
        const u32 count = static_cast<u32>(claims_.size());
        labels_.assign(count, 0);
        std::vector<u32> node(count, hull), free;
        for (u32 cell = 0; cell < count; ++cell) {
            labels_[cell] = claims_[cell].inside > claims_[cell].outside;
            if (claims_[cell].inside == claims_[cell].outside) {
                node[cell] = static_cast<u32>(free.size());
                free.push_back(cell);
            }
        }
        const u32 source = static_cast<u32>(free.size()), sink = source + 1;
        Graph graph(sink + 1);
        const auto connect = [&](u32 from, u32 to, double there, double back) {
            const auto one = add_edge(from, to, graph).first, other = add_edge(to, from, graph).first;
            put(edge_capacity, graph, one, there);
            put(edge_capacity, graph, other, back);
            put(edge_reverse, graph, one, other);
            put(edge_reverse, graph, other, one);
        };
        for (const u32 cell : free) {
            context_.check_cancelled();
            double inside = 0, outside = 0;
            for (std::size_t i = 0; i < 4; ++i) {
                const u32 other = tets_.neighbours[cell][i];
                const double its = cost(facet(cell, i));
                if (other == hull || (node[other] == hull && labels_[other] == 0))
                    outside += its;
                else if (node[other] == hull)
                    inside += its;
                else if (cell < other)
                    connect(node[cell], node[other], its, its);
            }
            if (inside > 0) connect(source, node[cell], inside, 0);
            if (outside > 0) connect(node[cell], sink, outside, 0);
        }
        boykov_kolmogorov_max_flow(graph, source, sink);
        context_.check_cancelled();
        for (u32 i = 0; i < free.size(); ++i)
            labels_[free[i]] = get(vertex_color, graph, i) == color_traits<default_color_type>::black();
    }

    /// Mends vertices where the boundary is not one closed fan. Each change removes surplus parts, so this ends.
    void mend_vertices() {
        for (bool changes = true; changes;) {
            changes = false;
            context_.check_cancelled();
            const Array<Triangle> boundary = boundary_triangles(tets_, labels_, context_.threads());
            for (const u32 vertex : boundary_defects(boundary, positions_.size(), context_.threads()).vertices)
                while (mend(vertex)) changes = true;
        }
    }

    /// Lets one part of the cells at the vertex change sides: the part whose change removes most surplus parts at all
    /// vertices. Ties: the part that the mesh claims least, then the smaller one. Returns false if no change removes
    /// any.
    bool mend(u32 vertex) {
        if (stars_->surplus_parts(vertex, labels_) == 0) return false;
        std::map<std::pair<bool, u32>, std::vector<u32>> parts;  // inside parts first, ascending by lowest cell
        for (u32 i = 0; i < stars_->cells().size(); ++i)
            if (const u32 part = stars_->part(i), cell = stars_->cells()[i]; part != hull)
                parts[{labels_[cell] == 0, part}].push_back(cell);
        const std::vector<u32>* best = nullptr;
        std::tuple<std::ptrdiff_t, double, double> least{0, 0, 0};
        for (auto& [key, cells] : parts) {
            std::ranges::sort(cells);
            double claimed = 0, size = 0;
            std::set<u32> corners;
            for (const u32 cell : cells) {
                const Claim& its = claims_[cell];
                claimed += labels_[cell] ? its.inside - its.outside : its.outside - its.inside;
                size += volume(cell);
                corners.insert(tets_.cells[cell].begin(), tets_.cells[cell].end());
            }
            const auto surplus = [&] {
                std::ptrdiff_t sum = 0;
                for (const u32 corner : corners)
                    sum += static_cast<std::ptrdiff_t>(stars_->surplus_parts(corner, labels_));
                return sum;
            };
            const std::ptrdiff_t before = surplus();
            swap_sides(cells);
            const std::ptrdiff_t change = surplus() - before;
            swap_sides(cells);
            if (change < 0 && (best == nullptr || std::tuple(change, claimed, size) < least)) {
                best = &cells;
                least = {change, claimed, size};
            }
        }
        if (best != nullptr) swap_sides(*best);
        return best != nullptr;
    }

    void swap_sides(std::span<const u32> cells) {
        for (const u32 cell : cells) labels_[cell] ^= 1;
    }

    /// Face-connected parts of either side change sides if no component of the mesh has most of its triangles there.
    void drop_specks() {
        const u32 count = static_cast<u32>(labels_.size());
        DisjointSets parts(count + 1);  // the last element: the space beyond the hull
        for (u32 cell = 0; cell < count; ++cell)
            for (const u32 other : tets_.neighbours[cell]) {
                if (other == hull && labels_[cell] == 0) parts.unite(cell, count);
                if (other != hull && labels_[other] == labels_[cell]) parts.unite(cell, other);
            }
        std::map<std::pair<u32, u8>, std::map<u32, double>> areas;  // by component and side: the area in each part
        for (u32 cell = 0; cell < count; ++cell) {
            const Claim& its = claims_[cell];
            const double area = labels_[cell] ? its.inside : its.outside;
            if (area > 0) areas[{its.component, labels_[cell]}][parts.find(cell)] += area;
        }
        std::vector<bool> stays(count + 1, false);
        stays[parts.find(count)] = true;
        for (const auto& [component, its] : areas)
            stays[std::ranges::max_element(its, {}, &std::pair<const u32, double>::second)->first] = true;
        for (u32 cell = 0; cell < count; ++cell)
            if (!stays[parts.find(cell)]) labels_[cell] ^= 1;
    }

    /// Finds the boundary facet that is joined to a given boundary facet at an edge, by walking around the edge inside
    /// the solid. The given facet is opposite to corner i of `cell`, and the edge is opposite to its corner `third`.
    std::array<u32, 2> mate(u32 cell, std::size_t i, u32 third) const {
        const auto across = std::ranges::find(tets_.cells[cell], third) - tets_.cells[cell].begin();
        EdgeWalk walk(tets_, cell, static_cast<int>(across), static_cast<int>(i));
        while (walk.next() != hull && labels_[walk.next()] == 1) walk.step();
        return {walk.cell(), static_cast<u32>(walk.across())};
    }

    /// Edges with four triangles, where a fan passes an edge twice. Copies of vertices are replaced by the vertices
    /// themselves.
    std::vector<Edge> edges_of_four(const ClosingSolid& solid) const {
        std::vector<Edge> directed, result;
        for (const Triangle& triangle : solid.triangles)
            for (std::size_t k = 0; k < 3; ++k) directed.push_back({triangle[k], triangle[(k + 1) % 3]});
        std::ranges::sort(directed);
        const u32 vertices = static_cast<u32>(positions_.size());
        for (std::size_t i = 1; i < directed.size(); ++i) {
            if (directed[i] != directed[i - 1]) continue;
            Edge edge = directed[i];
            for (u32& vertex : edge)
                if (vertex >= vertices) vertex = solid.copies[vertex - vertices];
            result.push_back(edge);
        }
        return result;
    }

    /// The boundary of the solid. A vertex that still has several fans gets a copy for every fan but the first.
    ClosingSolid boundary() {
        ClosingSolid result;
        std::vector<std::array<u32, 2>> facets;
        for (u32 cell = 0; cell < labels_.size(); ++cell)
            for (u32 i = 0; i < 4 && labels_[cell] == 1; ++i)
                if (const u32 other = tets_.neighbours[cell][i]; other == hull || labels_[other] == 0) {
                    facets.push_back({cell, i});
                    result.triangles.push_back(facet(cell, i));
                }
        if (facets.empty()) return {};
        std::vector<bool> is_defect(positions_.size(), false);
        for (const u32 vertex : boundary_defects(result.triangles, positions_.size(), context_.threads()).vertices)
            is_defect[vertex] = true;
        const auto number = [&](const std::array<u32, 2>& its) {
            return static_cast<u32>(std::ranges::lower_bound(facets, its) - facets.begin());
        };
        const std::vector<Triangle> originals = result.triangles;
        const auto corner = [&](u32 f, u32 vertex) {
            return 3 * f + static_cast<u32>(std::ranges::find(originals[f], vertex) - originals[f].begin());
        };
        DisjointSets fans(3 * facets.size());
        for (u32 f = 0; f < facets.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k) {
                const u32 a = originals[f][(k + 1) % 3], b = originals[f][(k + 2) % 3];
                if (!is_defect[a] && !is_defect[b]) continue;
                const u32 other = number(mate(facets[f][0], facets[f][1], originals[f][k]));
                fans.unite(corner(f, a), corner(other, a));
                fans.unite(corner(f, b), corner(other, b));
            }
        std::vector<u32> fan_of(positions_.size(), hull);  // the first fan of a vertex keeps the vertex itself
        std::map<u32, u32> copy_of;
        for (u32 f = 0; f < facets.size(); ++f)
            for (std::size_t k = 0; k < 3; ++k) {
                const u32 vertex = originals[f][k];
                if (!is_defect[vertex]) continue;
                const u32 fan = fans.find(static_cast<u32>(3 * f + k));
                if (fan_of[vertex] == hull) fan_of[vertex] = fan;
                if (fan_of[vertex] == fan) continue;
                const auto [copy, is_new] =
                    copy_of.try_emplace(fan, static_cast<u32>(positions_.size() + result.copies.size()));
                if (is_new) result.copies.push_back(vertex);
                result.triangles[f][k] = copy->second;
            }
        if (reversed_)
            for (Triangle& triangle : result.triangles) std::swap(triangle[1], triangle[2]);
        return result;
    }

    std::span<const Vec3> positions_;
    std::span<const Triangle> triangles_;
    std::size_t given_;
    Context& context_;
    TetMesh tets_;
    std::vector<Claim> claims_;
    std::vector<u8> labels_;
    std::vector<Triangle> suggested_;
    bool reversed_ = false;
    std::optional<VertexStars> stars_;
};

}  // namespace

Triangle smallest_first(Triangle triangle) {
    std::ranges::rotate(triangle, std::ranges::min_element(triangle));
    return triangle;
}

ClosingSolid closing_solid(std::span<const Vec3> positions, std::span<const Triangle> triangles, std::size_t given,
                           const Vec3& origin, Context& context) {
    std::vector<u32> number(positions.size(), 0), row;
    for (const Triangle& triangle : triangles)
        for (const u32 vertex : triangle) number[vertex] = 1;
    std::vector<Vec3> used;
    for (u32 v = 0; v < positions.size(); ++v)
        if (std::exchange(number[v], static_cast<u32>(row.size())) == 1) {
            row.push_back(v);
            used.push_back(positions[v]);
        }
    const Extents size = extents(used, origin, context.threads());
    if (size.from_plane <= size.rounding) return {};
    std::vector<Triangle> renumbered(triangles.begin(), triangles.end());
    for (Triangle& triangle : renumbered)
        for (u32& vertex : triangle) vertex = number[vertex];
    ClosingSolid result = Closing(used, renumbered, given, context).run();
    const u32 unchanged = static_cast<u32>(used.size()), vertices = static_cast<u32>(positions.size());
    for (Triangle& triangle : result.triangles)
        for (u32& vertex : triangle) vertex = vertex < unchanged ? row[vertex] : vertex - unchanged + vertices;
    for (u32& vertex : result.copies) vertex = row[vertex];
    return result;
}

}  // namespace scanmill
