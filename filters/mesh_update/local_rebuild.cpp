// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh_update/local_rebuild.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cassert>
#include <numeric>
#include <optional>
#include <unordered_map>
#include <unordered_set>

#include "cocone/peeling.hpp"
#include "delaunay/delaunay.hpp"
#include "mesh_update/nested_context.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/tets/incremental_solid.hpp"
#include "scanmill/geometry/tets/solid_boundary.hpp"

namespace scanmill::updating {

namespace {

constexpr u32 invalid_index = ~u32(0);
/// Width of the collar and of the guard, in spacings. Near its end a sample has no reliable surface; the guard keeps
/// that away from the collar. On smooth meshes one spacing is enough; at sharp edges, three refuse fewest changes.
constexpr double width_in_spacings = 3;
/// Without a seam, the collar is doubled this often.
constexpr int most_widenings = 1;
/// Distance of the far points from the centre of a region along each axis, in half diagonals of its box. 1.5 is too
/// near: a third of the changes of a box are refused. 4 and 10 give equal results.
constexpr double far_distance = 4;

template <class Value>
void sort_unique(std::vector<Value>& values) {
    std::ranges::sort(values);
    values.erase(std::unique(values.begin(), values.end()), values.end());
}

bool contains(std::span<const u32> sorted, u32 value) { return std::ranges::binary_search(sorted, value); }

/// The directed edge as a key.
u64 directed(u32 from, u32 to) { return u64{from} << 32 | to; }
u64 reversed(u64 edge) { return edge >> 32 | edge << 32; }

struct Given {
    const TriangleMesh& mesh;
    std::span<const u32> opposite;
    const FacetTree& tree;
    std::span<const Vec3> points;
    std::span<const u32> discarded;

    /// The number of the mesh's vertices. Vertices from here on are points.
    u32 first_point() const { return static_cast<u32>(mesh.positions.size()); }
    const Vec3& position(u32 vertex) const {
        return vertex < first_point() ? mesh.positions[vertex] : points[vertex - first_point()];
    }
    std::string place(u32 vertex) const {
        const Vec3 p = mesh.frame.origin + position(vertex);
        return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z());
    }
    /// The vertices of the facets, ascending.
    std::vector<u32> vertices_of(std::span<const u32> facets) const {
        std::vector<u32> vertices;
        for (const u32 facet : facets)
            vertices.insert(vertices.end(), mesh.triangles[facet].begin(), mesh.triangles[facet].end());
        sort_unique(vertices);
        return vertices;
    }
};

[[noreturn]] void refuse(std::string sentence) {
    throw Error("{}", std::move(sentence))
        .hint("use `rebuild: whole`, which makes the whole surface anew and has no seam");
}

// Step 1: what is near a change.

/// The part of the mesh that one new surface is made for. All lists ascend.
struct Region {
    std::vector<u32> removed, points;
    double spacing = 0;
    double width = 0;             ///< width of the collar and of the guard
    std::vector<u32> core;        ///< the removed facets and the collar
    std::vector<u32> guard;       ///< the guard
    std::vector<u32> core_vertices;
};

class RegionFinder {
public:
    RegionFinder(const Given& given, double widening, Context& context)
        : given_(given),
          widening_(widening),
          context_(context) {}

    /// The region of a change, or of several together.
    Region find(std::vector<u32> removed, std::vector<u32> points, double spacing) const {
        Region region;
        region.removed = std::move(removed);
        region.points = std::move(points);
        region.spacing = spacing;
        sort_unique(region.removed);
        sort_unique(region.points);
        region.width = widening_ * width_in_spacings * std::max(spacing, edge_beside(region.removed));
        region.core = core_of(region);
        region.core_vertices = given_.vertices_of(region.core);
        region.guard = guard_of(region);
        return region;
    }

private:
    /// The median edge of the facets beside the removed ones.
    double edge_beside(std::span<const u32> removed) const {
        std::vector<double> lengths;
        for (const u32 facet : removed)
            for (u32 h = 3 * facet; h < 3 * facet + 3; ++h)
                if (const u32 beside = given_.opposite[h] / 3; !contains(removed, beside))
                    for (std::size_t k = 0; k < 3; ++k) {
                        const Triangle& t = given_.mesh.triangles[beside];
                        lengths.push_back((given_.position(t[k]) - given_.position(t[(k + 1) % 3])).norm());
                    }
        if (lengths.empty())
            refuse(fmt::format("seam: the change at {} removes {} triangles and leaves nothing of the mesh beside them",
                               given_.place(given_.mesh.triangles[removed[0]][0]), removed.size()));
        return median(lengths);
    }

    std::vector<u32> core_of(const Region& region) const {
        std::vector<Vec3> seeds;
        for (const u32 vertex : given_.vertices_of(region.removed)) seeds.push_back(given_.position(vertex));
        const PointTree tree(seeds, context_.threads());
        NeighbourBuffer buffer;
        std::unordered_map<u32, bool> near;
        const auto is_near = [&](u32 vertex) {
            const auto [found, is_new] = near.try_emplace(vertex);
            if (is_new)
                found->second =
                    tree.nearest_to(given_.position(vertex), 1, buffer).front().squared < region.width * region.width;
            return found->second;
        };
        std::vector<u32> core = region.removed;
        std::unordered_set<u32> seen(core.begin(), core.end());
        for (std::size_t i = 0; i < core.size(); ++i) {
            if ((i & 0xfff) == 0) context_.check_cancelled();
            for (u32 h = 3 * core[i]; h < 3 * core[i] + 3; ++h) {
                const u32 beside = given_.opposite[h] / 3;
                if (seen.contains(beside) || std::ranges::none_of(given_.mesh.triangles[beside], is_near)) continue;
                seen.insert(beside);
                core.push_back(beside);
            }
        }
        std::ranges::sort(core);
        return core;
    }

    /// The facets whose boxes come within the width of a cube of this width that contains a vertex of the core.
    std::vector<u32> guard_of(const Region& region) const {
        std::vector<std::array<double, 3>> cubes;
        for (const u32 vertex : region.core_vertices) {
            const Vec3 cube = (given_.position(vertex) / region.width).array().floor();
            cubes.push_back({cube.x(), cube.y(), cube.z()});
        }
        sort_unique(cubes);
        std::unordered_set<u32> seen(region.core.begin(), region.core.end());
        std::vector<u32> guard;
        Array<u32> rows;
        for (const auto& [x, y, z] : cubes) {
            context_.check_cancelled();
            BoundingBox box;
            box.add(region.width * Vec3(x - 1, y - 1, z - 1));
            box.add(region.width * Vec3(x + 2, y + 2, z + 2));
            rows.clear();
            given_.tree.meeting(box, rows);
            for (const u32 row : rows)
                if (seen.insert(row).second) guard.push_back(row);
        }
        std::ranges::sort(guard);
        return guard;
    }

    const Given& given_;
    double widening_;
    Context& context_;
};

/// Unites regions where a facet of one's core is in the other's core or guard. Returns whether there were any.
bool unite_near(std::vector<Region>& regions, const RegionFinder& finder) {
    DisjointSets sets(regions.size());
    std::unordered_map<u32, u32> region_of;  // by facet of a core
    for (u32 i = 0; i < regions.size(); ++i)
        for (const u32 facet : regions[i].core)
            if (const auto [found, is_new] = region_of.try_emplace(facet, i); !is_new) sets.unite(found->second, i);
    for (u32 i = 0; i < regions.size(); ++i)
        for (const u32 facet : regions[i].guard)
            if (const auto found = region_of.find(facet); found != region_of.end()) sets.unite(found->second, i);
    std::vector<Region> united;
    for (u32 i = 0; i < regions.size(); ++i) {
        if (sets.find(i) != i) continue;
        Region all = std::move(regions[i]);
        const std::size_t alone = all.removed.size();
        for (u32 j = i + 1; j < regions.size(); ++j) {
            if (sets.find(j) != i) continue;
            all.removed.insert(all.removed.end(), regions[j].removed.begin(), regions[j].removed.end());
            all.points.insert(all.points.end(), regions[j].points.begin(), regions[j].points.end());
            all.spacing = std::max(all.spacing, regions[j].spacing);
        }
        if (all.removed.size() > alone) all = finder.find(std::move(all.removed), std::move(all.points), all.spacing);
        united.push_back(std::move(all));
    }
    const bool is_less = united.size() < regions.size();
    regions = std::move(united);
    return is_less;
}

std::vector<Region> regions_of(const Given& given, std::span<const LocalChange> changes, double widening,
                               Context& context) {
    const RegionFinder finder(given, widening, context);
    std::vector<Region> regions;
    for (const LocalChange& change : changes)
        if (!change.removed.empty()) regions.push_back(finder.find(change.removed, change.points, change.spacing));
    while (unite_near(regions, finder)) {
    }
    return regions;
}

// Step 2: the new surface.

struct NewSurface {
    explicit NewSurface(std::vector<Triangle> given) : triangles(std::move(given)) {
        std::unordered_set<u64> crowded;
        for (u32 row = 0; row < triangles.size(); ++row)
            for (std::size_t k = 0; k < 3; ++k) {
                const u32 from = triangles[row][k], to = triangles[row][(k + 1) % 3];
                if (from == invalid_index || to == invalid_index) continue;
                if (!triangle_at.try_emplace(directed(from, to), row).second) crowded.insert(directed(from, to));
            }
        for (const u64 edge : crowded) {
            triangle_at.erase(edge);
            triangle_at.erase(reversed(edge));
        }
    }

    /// Corners are vertices of the given mesh, its number of vertices plus rows of points, or invalid_index for a far
    /// point.
    std::vector<Triangle> triangles;
    /// Far points are in no key. An edge with more than two triangles is not in the map.
    std::unordered_map<u64, u32> triangle_at;  ///< by directed edge
};

/// The region's vertices and points, and far points around them. The column `vertex` numbers them as in NewSurface.
PointCloud points_of(const Given& given, const Region& region) {
    std::vector<u32> vertices = given.vertices_of(region.guard);
    vertices.insert(vertices.end(), region.core_vertices.begin(), region.core_vertices.end());
    sort_unique(vertices);
    std::erase_if(vertices, [&](u32 vertex) { return contains(given.discarded, vertex); });
    for (const u32 row : region.points) vertices.push_back(given.first_point() + row);
    Array<Vec3> positions;
    BoundingBox box;
    for (const u32 vertex : vertices) {
        positions.push_back(given.position(vertex));
        box.add(positions.back());
    }
    const Vec3 centre = (box.low + box.high) / 2;
    const double distance = far_distance * box.diagonal() / 2;
    for (int i = 0; i < 8; ++i) {
        positions.push_back(centre + distance * Vec3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1));
        vertices.push_back(invalid_index);
    }
    PointCloud cloud;
    cloud.frame = given.mesh.frame;
    cloud.positions = std::move(positions);
    cloud.columns.add(Column("vertex", 1, Buffer<u32>(Array<u32>(vertices.begin(), vertices.end()))));
    return cloud;
}

/// The cells behind facets of the surface that are facets of the mesh and remain.
std::vector<cocones::Side> known_inside(const Given& given, const Region& region, const TetMesh& tets,
                                        std::span<const u32> vertices, const cocones::Surface& surface) {
    std::unordered_map<u64, u32> apex;  // by directed edge of a remaining facet
    for (const std::vector<u32>* facets : {&region.core, &region.guard})
        for (const u32 facet : *facets)
            if (!contains(region.removed, facet)) {
                const auto& [a, b, c] = given.mesh.triangles[facet];
                apex.insert({{directed(a, b), c}, {directed(b, c), a}, {directed(c, a), b}});
            }
    std::vector<cocones::Side> inside;
    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
        for (int corner = 0; corner < 4; ++corner) {
            if (!surface.facets.contains(cell, corner)) continue;
            const auto [a, b, c] = cocones::corners_of(tets, {cell, corner});
            const auto found = apex.find(directed(vertices[a], vertices[b]));
            if (found != apex.end() && found->second == vertices[c]) inside.push_back({cell, corner});
        }
    return inside;
}

/// The boundary's triangles, after cells were added around those vertices in `is_mended` where it is not a manifold,
/// cells with the smallest circumspheres first. At the end of the sample mending would close what must stay open.
Array<Triangle> mended_boundary(const cocones::Diagram& diagram, Array<u8> labels, std::span<const u8> is_mended,
                                Context& context) {
    const TetMesh& tets = diagram.tets;
    Array<Triangle> triangles = boundary_triangles(tets, labels, context.threads());
    const Array<u32> defects = boundary_defects(triangles, tets.positions.size(), context.threads()).vertices;
    std::vector<u32> suspects;
    for (const u32 vertex : defects)
        if (is_mended[vertex] == 1) suspects.push_back(vertex);
    if (suspects.empty()) return triangles;
    Array<double> squared(tets.cells.size());
    for (std::size_t cell = 0; cell < squared.size(); ++cell)
        squared[cell] = (diagram.centres[cell] - tets.positions[tets.cells[cell][0]]).squaredNorm();
    IncrementalSolid solid(tets, std::move(labels), suspects);
    solid.repair(squared, context);
    return boundary_triangles(tets, solid.labels(), context.threads());
}

NewSurface new_surface(const Given& given, const Region& region, const CoconeParams& params, Context& context) {
    NestedContext silent(context);
    const TetMesh input = delaunay(points_of(given, region), {}, silent).tets;
    cocones::require_usable(input, params);
    const SpatialTets spatial = in_spatial_order(input, silent);
    const TetMesh& tets = spatial.tets;
    const cocones::Diagram diagram(tets, params.cone_angle.in_radians(), silent);
    const cocones::Sampling samples = cocones::sampling(diagram, params, silent);
    const cocones::Surface surface = cocones::surface_of(diagram, samples, params, silent);

    const std::span<const u32> column = input.vertex_columns.find("vertex")->values<u32>();
    std::vector<u32> vertices;
    Array<u8> is_mended;
    for (const u32 vertex : spatial.vertices) {
        vertices.push_back(column[vertex]);
        is_mended.push_back(vertices.back() != invalid_index && (vertices.back() >= given.first_point() ||
                                                                 contains(region.core_vertices, vertices.back())));
    }
    cocones::Peeling peeling = cocones::peel(diagram, surface, cocones::SurfaceMesh(tets, surface), samples.flat,
                                             silent, known_inside(given, region, tets, vertices, surface));

    std::vector<Triangle> triangles;
    for (Triangle triangle : mended_boundary(diagram, std::move(peeling.labels), is_mended, silent)) {
        for (u32& vertex : triangle) vertex = vertices[vertex];
        triangles.push_back(triangle);
    }
    return NewSurface(std::move(triangles));
}

// Step 3: the exchange.

class Exchange {
public:
    Exchange(const Given& given, const Region& region, const NewSurface& surface)
        : given_(given),
          region_(region),
          surface_(surface) {
        for (const std::vector<u32>* facets : {&region.core, &region.guard})
            for (const u32 facet : *facets)
                for (std::size_t k = 0; k < 3; ++k) facet_at_.emplace(edge_of(given.mesh.triangles[facet], k), facet);
    }

    void run(const Context& context) {
        for (const u32 facet : region_.removed) replace(facet);
        for (u32 row = 0; row < surface_.triangles.size(); ++row)
            if (std::ranges::any_of(surface_.triangles[row], [&](u32 vertex) { return is_point(vertex); })) take(row);
        for (std::size_t i = 0, j = 0; i < replaced.size() || j < taken.size();) {
            if (((i + j) & 0xfff) == 0) context.check_cancelled();
            if (i < replaced.size())
                pass_from_replaced(replaced[i++]);
            else
                pass_from_taken(taken[j++]);
        }
        if (beyond_ > 0)
            refuse(fmt::format(
                "seam: the new surface does not join the mesh within {:.4g} {} of the change at {}; {} "
                "of their triangles differ beyond, the first at {}",
                region_.width, symbol(given_.mesh.frame.unit),
                given_.place(given_.mesh.triangles[region_.removed[0]][0]), beyond_, given_.place(first_beyond_)));
        finish();
    }

    std::vector<u32> replaced;  ///< facets of the mesh
    std::vector<u32> taken;  ///< rows of the new surface, ascending after run()

private:
    static u64 edge_of(const Triangle& triangle, std::size_t k) { return directed(triangle[k], triangle[(k + 1) % 3]); }
    bool is_point(u32 vertex) const { return vertex >= given_.first_point() && vertex != invalid_index; }
    /// Whether both surfaces have the edge, with a triangle on each side.
    bool is_common(u64 edge) const {
        return facet_at_.contains(edge) && facet_at_.contains(reversed(edge)) && surface_.triangle_at.contains(edge) &&
               surface_.triangle_at.contains(reversed(edge));
    }

    void report_beyond(u32 vertex) {
        if (beyond_++ == 0) first_beyond_ = vertex;
    }
    void replace(u32 facet) {
        if (!is_replaced_.insert(facet).second) return;
        if (contains(region_.core, facet))
            replaced.push_back(facet);
        else
            report_beyond(given_.mesh.triangles[facet][0]);
    }
    void take(u32 row) {
        if (!is_taken_.insert(row).second) return;
        const Triangle& triangle = surface_.triangles[row];
        const auto inside = [&](u32 vertex) { return is_point(vertex) || contains(region_.core_vertices, vertex); };
        if (std::ranges::all_of(triangle, inside))
            taken.push_back(row);
        else
            report_beyond(*std::ranges::min_element(triangle));
    }
    void pass_from_replaced(u32 facet) {
        for (std::size_t k = 0; k < 3; ++k) {
            const u64 edge = edge_of(given_.mesh.triangles[facet], k);
            if (is_common(edge))
                take(surface_.triangle_at.at(edge));
            else
                replace(given_.opposite[3 * facet + k] / 3);
        }
    }
    void pass_from_taken(u32 row) {
        for (std::size_t k = 0; k < 3; ++k) {
            const u64 edge = edge_of(surface_.triangles[row], k);
            if (is_common(edge))
                replace(facet_at_.at(edge));
            else if (const auto found = surface_.triangle_at.find(reversed(edge)); found != surface_.triangle_at.end())
                take(found->second);
            else
                report_beyond(surface_.triangles[row][k]);  // an edge of more than two triangles
        }
    }

    /// Calls visit(part, has_seam) for each connected part of the marked rows. `across(row, k)` is the row beyond edge
    /// k.
    template <class Across, class Visit>
    static void for_each_part(std::span<const u32> rows, const std::unordered_set<u32>& marked, const Across& across,
                              const Visit& visit) {
        std::unordered_set<u32> seen;
        for (const u32 seed : rows) {
            if (!seen.insert(seed).second) continue;
            std::vector<u32> part{seed};
            bool has_seam = false;
            for (std::size_t i = 0; i < part.size(); ++i)
                for (u32 k = 0; k < 3; ++k) {
                    const u32 beyond = across(part[i], k);
                    if (!marked.contains(beyond))
                        has_seam = true;
                    else if (seen.insert(beyond).second)
                        part.push_back(beyond);
                }
            visit(part, has_seam);
        }
    }
    /// Throws Error if a component of the mesh is replaced as a whole. Drops parts of the new surface without a seam.
    void finish() {
        for_each_part(
            replaced, is_replaced_, [&](u32 facet, u32 k) { return given_.opposite[3 * facet + k] / 3; },
            [&](std::span<const u32> part, bool has_seam) {
                if (!has_seam)
                    refuse(fmt::format("seam: the change at {} leaves nothing of a component of {} triangles",
                                       given_.place(given_.mesh.triangles[part[0]][0]), part.size()));
            });
        std::vector<u32> joined;
        for_each_part(
            taken, is_taken_,
            [&](u32 row, u32 k) { return surface_.triangle_at.at(reversed(edge_of(surface_.triangles[row], k))); },
            [&](std::span<const u32> part, bool has_seam) {
                if (has_seam) joined.insert(joined.end(), part.begin(), part.end());
            });
        std::ranges::sort(joined);
        taken = std::move(joined);
    }

    const Given& given_;
    const Region& region_;
    const NewSurface& surface_;
    std::unordered_map<u64, u32> facet_at_;  ///< by directed edge
    std::unordered_set<u32> is_replaced_, is_taken_;
    std::size_t beyond_ = 0;
    u32 first_beyond_ = 0;
};

// What is promised of the result.

/// Whether the edges opposite to a vertex in its triangles form one cycle.
bool is_one_fan(std::vector<std::array<u32, 2>>& links) {
    std::ranges::sort(links);
    u32 vertex = links[0][0];
    for (std::size_t i = 0; i < links.size(); ++i) {
        const auto found = std::ranges::equal_range(links, vertex, {}, [](const auto& link) { return link[0]; });
        if (found.size() != 1 || (i > 0 && vertex == links[0][0])) return false;
        vertex = (*found.begin())[1];
    }
    return vertex == links[0][0];
}

/// Throws Error if a vertex has more than one fan. Lists the vertices without triangles.
void check_vertices(const Given& given, std::span<const Region> regions, LocalRebuild& result, const Context& context) {
    std::unordered_map<u32, u32> half_edge_at;
    for (const Region& region : regions)
        for (const u32 facet : region.core)
            for (u32 h = 3 * facet; h < 3 * facet + 3; ++h) half_edge_at.emplace(half_edges::start(given.mesh, h), h);
    std::unordered_map<u32, std::vector<std::array<u32, 2>>> links;
    for (const u32 facet : result.replaced)
        for (const u32 vertex : given.mesh.triangles[facet]) links.try_emplace(vertex);
    for (const Triangle& t : result.triangles)
        for (std::size_t k = 0; k < 3; ++k) links[t[k]].push_back({t[(k + 1) % 3], t[(k + 2) % 3]});
    std::vector<u32> vertices;
    for (const auto& entry : links) vertices.push_back(entry.first);
    std::ranges::sort(vertices);
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        if ((i & 0xfff) == 0) context.check_cancelled();
        const u32 vertex = vertices[i];
        std::vector<std::array<u32, 2>>& its = links.at(vertex);
        if (const auto found = half_edge_at.find(vertex); found != half_edge_at.end()) {
            u32 h = found->second;
            do {
                if (!contains(result.replaced, h / 3))
                    its.push_back(
                        {half_edges::end(given.mesh, h), half_edges::start(given.mesh, half_edges::before(h))});
                h = given.opposite[half_edges::before(h)];
            } while (h != found->second);
        }
        if (its.empty())
            result.dropped.push_back(vertex);
        else if (!is_one_fan(its))
            refuse(fmt::format("seam: the {} triangles at {} would not form one fan", its.size(), given.place(vertex)));
    }
}

/// Throws Error if a new triangle intersects another one.
void check_intersections(const Given& given, const LocalRebuild& result, Context& context) {
    std::unordered_map<u32, u32> number;
    std::vector<Vec3> positions;
    const auto local = [&](Triangle triangle) {
        for (u32& vertex : triangle) {
            const auto [found, is_new] = number.try_emplace(vertex, static_cast<u32>(positions.size()));
            if (is_new) positions.push_back(given.position(vertex));
            vertex = found->second;
        }
        return triangle;
    };
    std::vector<Triangle> triangles;
    for (const Triangle& triangle : result.triangles) triangles.push_back(local(triangle));
    std::unordered_set<u32> near;
    Array<u32> rows;
    for (std::size_t i = 0; i < result.triangles.size(); ++i) {
        if ((i & 0xfff) == 0) context.check_cancelled();
        BoundingBox box;
        for (const u32 vertex : result.triangles[i]) box.add(given.position(vertex));
        rows.clear();
        given.tree.meeting(box, rows);
        for (const u32 row : rows)
            if (!contains(result.replaced, row) && near.insert(row).second)
                triangles.push_back(local(given.mesh.triangles[row]));
    }
    const TriangleTree tree(positions, triangles, context.threads());
    const SelfIntersections found = self_intersections(positions, triangles, tree, context);
    std::size_t count = 0;
    std::optional<u32> first;
    for (const auto& [one, other] : found.pairs) {
        if (one >= result.triangles.size()) continue;  // the mesh intersects itself here
        if (count++ == 0) first = result.triangles[one][0];
    }
    if (first)
        refuse(fmt::format("seam: {} pairs of triangles would intersect, the first at {}", count, given.place(*first)));
}

}  // namespace

namespace {

LocalRebuild rebuilt_with(const Given& given, std::span<const LocalChange> changes, double widening,
                          const CoconeParams& params, Context& context) {
    const std::vector<Region> regions = regions_of(given, changes, widening, context);
    LocalRebuild result;
    for (const Region& region : regions) {
        const NewSurface surface = new_surface(given, region, params, context);
        Exchange exchange(given, region, surface);
        exchange.run(context);
        result.replaced.insert(result.replaced.end(), exchange.replaced.begin(), exchange.replaced.end());
        for (const u32 row : exchange.taken) result.triangles.push_back(surface.triangles[row]);
    }
    std::ranges::sort(result.replaced);
    check_vertices(given, regions, result, context);
    if (!result.triangles.empty()) check_intersections(given, result, context);

    std::vector<u32> given_points, used;
    for (const LocalChange& change : changes)
        given_points.insert(given_points.end(), change.points.begin(), change.points.end());
    sort_unique(given_points);
    for (const Triangle& triangle : result.triangles)
        for (const u32 vertex : triangle)
            if (vertex >= given.first_point()) used.push_back(vertex - given.first_point());
    sort_unique(used);
    result.unused_points = given_points.size() - used.size();
    return result;
}

}  // namespace

LocalRebuild rebuild_locally(const TriangleMesh& mesh, std::span<const u32> opposite, const FacetTree& tree,
                             std::span<const Vec3> points, std::span<const LocalChange> changes,
                             std::span<const u32> discarded, const CoconeParams& params, Context& context) {
    assert(opposite.size() == 3 * mesh.triangles.size());
    assert(std::ranges::is_sorted(discarded));
    const Given given{mesh, opposite, tree, points, discarded};
    double widening = 1;
    for (int i = 0; i < most_widenings; ++i, widening *= 2) try {
            return rebuilt_with(given, changes, widening, params, context);
        } catch (const Error&) {  // the surfaces may agree farther away
        }
    return rebuilt_with(given, changes, widening, params, context);
}

std::optional<LocalRebuild> exchanged(const TriangleMesh& mesh, std::span<const u32> opposite, const FacetTree& tree,
                                      std::span<const Vec3> points, std::span<const u32> removed,
                                      std::span<const Triangle> surface, Context& context) {
    const Given given{mesh, opposite, tree, points, {}};
    std::vector<Region> regions(1);
    Region& all = regions[0];
    all.removed.assign(removed.begin(), removed.end());
    all.core.resize(mesh.triangles.size());
    std::iota(all.core.begin(), all.core.end(), u32(0));
    all.core_vertices = given.vertices_of(all.core);
    try {
        const NewSurface closed(std::vector<Triangle>(surface.begin(), surface.end()));
        Exchange exchange(given, all, closed);
        exchange.run(context);
        LocalRebuild result;
        result.replaced = std::move(exchange.replaced);
        std::ranges::sort(result.replaced);
        for (const u32 row : exchange.taken) result.triangles.push_back(closed.triangles[row]);
        check_vertices(given, regions, result, context);
        if (!result.triangles.empty()) check_intersections(given, result, context);
        return result;
    } catch (const Error&) {
        return std::nullopt;  // no seam
    }
}

}  // namespace scanmill::updating
