// SPDX-License-Identifier: GPL-3.0-or-later
#include "fill_holes/fill_holes.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <atomic>
#include <limits>
#include <numeric>
#include <span>
#include <unordered_map>
#include <unordered_set>
#include <vector>

#include "fill_holes/loop_filling.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"

namespace scanmill {

namespace {

constexpr double doubtful_share = 0.05;  // of the whole area, filled
/// With more edges, all triangulations of a loop take too long: 100 have 161,700 triangles, at about 1 µs each.
constexpr std::size_t most_edges_to_avoid = 100;
constexpr u32 nobody = ~u32(0);

/// The boundary of a mesh as loops in which no vertex is repeated.
class Boundary {
public:
    explicit Boundary(const TriangleMesh& mesh) : mesh_(mesh), opposite_(half_edges::opposites(mesh)) {
        for (u32 h = 0; h < opposite_.size(); ++h)
            if (opposite_[h] == half_edges::boundary) outgoing_.push_back(h);
        link_fans();
        separate_loops();
    }

    std::span<const u32> opposite() const { return opposite_; }
    const std::vector<std::vector<u32>>& loops() const { return loops_; }
    std::span<const u32> half_edges() const { return outgoing_; }
    /// The half-edges of the loops along the boundary.
    u32 next(u32 h) const { return next_.at(h); }
    u32 before(u32 h) const { return before_.at(h); }
    u32 start(u32 h) const { return half_edges::start(mesh_, h); }

    /// The boundary half-edge of the fan of `out` that ends where `out` starts. Calls visit(half-edge) for every
    /// half-edge of the fan that starts there, `out` first.
    template <class Visit>
    u32 incoming(u32 out, Visit&& visit) const {
        for (u32 h = out;;) {
            visit(h);
            const u32 in = half_edges::before(h);
            if (opposite_[in] == half_edges::boundary) return in;
            h = opposite_[in];
        }
    }
    /// The same for all fans around the vertex that the gaps between them join.
    template <class Visit>
    void around(u32 out, Visit&& visit) const {
        u32 h = out;
        do h = next(incoming(h, visit));
        while (h != out);
    }

private:
    /// At a vertex with several fans the boundary goes on in the next fan, so a gap between two fans is not crossed.
    void link_fans() {
        std::vector<u32> by_vertex(outgoing_);
        std::ranges::stable_sort(by_vertex, {}, [&](u32 h) { return start(h); });
        for (std::size_t first = 0, last; first < by_vertex.size(); first = last) {
            for (last = first + 1; last < by_vertex.size() && start(by_vertex[last]) == start(by_vertex[first]);)
                ++last;
            for (std::size_t i = first; i < last; ++i)
                next_[incoming(by_vertex[i], [](u32) {})] = by_vertex[i + 1 < last ? i + 1 : first];
        }
    }

    void separate_loops() {
        std::unordered_set<u32> visited;
        for (const u32 first : outgoing_) {
            if (visited.contains(first)) continue;
            std::vector<u32> path;
            std::unordered_map<u32, std::size_t> at;  // by vertex: its position in the path
            for (u32 h = first; visited.insert(h).second; h = next_.at(h)) {
                if (const auto found = at.find(start(h)); found != at.end()) {
                    const auto begin = path.begin() + static_cast<std::ptrdiff_t>(found->second);
                    loops_.emplace_back(begin, path.end());
                    path.erase(begin, path.end());
                    for (const u32 cut : loops_.back()) at.erase(start(cut));
                }
                at[start(h)] = path.size();
                path.push_back(h);
            }
            loops_.push_back(std::move(path));
        }
        for (std::vector<u32>& loop : loops_) {
            std::ranges::rotate(loop, std::ranges::min_element(loop));
            for (std::size_t i = 0; i < loop.size(); ++i) {
                const u32 after = loop[(i + 1) % loop.size()];
                next_[loop[i]] = after;
                before_[after] = loop[i];
            }
        }
        std::ranges::sort(loops_, {}, [](const std::vector<u32>& loop) { return loop.front(); });
    }

    const TriangleMesh& mesh_;
    Array<u32> opposite_;
    std::vector<u32> outgoing_;
    std::unordered_map<u32, u32> next_, before_;
    std::vector<std::vector<u32>> loops_;
};

double length_of(const TriangleMesh& mesh, std::span<const u32> loop) {
    double length = 0;
    for (const u32 h : loop)
        length += (mesh.positions[half_edges::end(mesh, h)] - mesh.positions[half_edges::start(mesh, h)]).norm();
    return length;
}

/// The surroundings of a loop, and the mesh's vertices that theirs are.
struct Cutout {
    LoopSurroundings part;
    std::vector<u32> vertices;

    Cutout(const TriangleMesh& mesh, const Boundary& boundary, std::span<const u32> loop) {
        std::vector<u32> rows;
        std::unordered_set<u32> at_loop;  // half-edges that start at a vertex of the loop, in its cycle of fans
        for (const u32 h : loop)
            boundary.around(h, [&](u32 around) {
                rows.push_back(around / 3);
                at_loop.insert(around);
            });
        std::ranges::sort(rows);
        rows.erase(std::ranges::unique(rows).begin(), rows.end());
        const auto local = [&](u32 h) {
            const auto found = std::ranges::lower_bound(rows, h / 3);
            return found == rows.end() || *found != h / 3 ? half_edges::boundary
                                                          : static_cast<u32>(found - rows.begin()) * 3 + h % 3;
        };
        const u32 count = static_cast<u32>(3 * rows.size());
        const auto global = [&](u32 h) { return 3 * rows[h / 3] + h % 3; };
        part.opposite.resize(count);
        for (u32 h = 0; h < count; ++h) {
            const u32 other = boundary.opposite()[global(h)];
            part.opposite[h] = other == half_edges::boundary ? other : local(other);
        }
        part.before_on_boundary.assign(count, half_edges::boundary);
        DisjointSets corners(count);  // of one vertex
        for (u32 h = 0; h < count; ++h) {
            if (part.opposite[h] != half_edges::boundary) {
                corners.unite(h, half_edges::after(part.opposite[h]));
            } else if (at_loop.contains(global(h))) {
                part.before_on_boundary[h] = local(boundary.before(global(h)));
                corners.unite(h, half_edges::after(part.before_on_boundary[h]));
            } else {
                u32 in = half_edges::before(h);
                while (part.opposite[in] != half_edges::boundary) in = half_edges::before(part.opposite[in]);
                part.before_on_boundary[h] = in;
            }
        }
        std::vector<u32> number(count, nobody);
        part.triangles.resize(rows.size());
        for (u32 h = 0; h < count; ++h) {
            u32& vertex = number[corners.find(h)];
            if (vertex == nobody) {
                vertex = static_cast<u32>(vertices.size());
                vertices.push_back(half_edges::start(mesh, global(h)));
                part.positions.push_back(mesh.positions[vertices.back()]);
            }
            part.triangles[h / 3][h % 3] = vertex;
        }
        part.loop = local(loop.front());
    }
};

/// A loop with its filling, which becomes plainer while it intersects something.
struct Hole {
    std::span<const u32> loop;
    FillingStage stage;
    bool open = false;
    std::vector<Vec3> positions;
    /// Indices below #vertices are the mesh's vertices.
    std::vector<Triangle> triangles;

    void demote() {
        if (stage == FillingStage::avoiding)
            open = true;
        else
            stage = static_cast<FillingStage>(static_cast<int>(stage) - 1);
        positions.clear();
        triangles.clear();
    }
};

/// The mesh with all fillings.
struct Assembly {
    Array<Vec3> positions;
    Array<Triangle> triangles;
    /// By triangle behind the mesh's: its hole.
    std::vector<u32> owners;

    Assembly(const TriangleMesh& mesh, std::span<const Hole> holes)
        : positions(mesh.positions.begin(), mesh.positions.end()),
          triangles(mesh.triangles.begin(), mesh.triangles.end()) {
        const u32 vertices = static_cast<u32>(mesh.positions.size());
        for (u32 i = 0; i < holes.size(); ++i) {
            const u32 shift = static_cast<u32>(positions.size()) - vertices;
            positions.insert(positions.end(), holes[i].positions.begin(), holes[i].positions.end());
            for (Triangle triangle : holes[i].triangles) {
                for (u32& vertex : triangle)
                    if (vertex >= vertices) vertex += shift;
                triangles.push_back(triangle);
                owners.push_back(i);
            }
        }
    }
};

BoundingBox box_of(const Array<Vec3>& positions, const Triangle& triangle) {
    BoundingBox box;
    for (const u32 vertex : triangle) box.add(positions[vertex]);
    return box;
}

/// Finds which fillings intersect something, or repeat an edge.
class Conflicts {
public:
    Conflicts(const TriangleMesh& mesh, std::span<const Hole> holes, unsigned threads)
        : mesh_(mesh),
          vertices_(static_cast<u32>(mesh.positions.size())),
          count_(static_cast<u32>(mesh.triangles.size())),
          tree_(mesh.positions.span(), mesh.triangles.span(), threads),
          lowest_(lowest_at_position(mesh.positions.span())) {
        std::vector<bool> is_rim(mesh.positions.size(), false);
        for (const Hole& hole : holes)
            for (const u32 h : hole.loop) is_rim[half_edges::start(mesh, h)] = true;
        for (const Triangle& triangle : mesh.triangles)
            for (std::size_t i = 0; i < 3; ++i)
                if (const u32 a = triangle[i], b = triangle[(i + 1) % 3]; is_rim[a] && is_rim[b])
                    rim_edges_.insert(key(a, b));
    }

    /// Demotes the fillings that have to give way; false if there is none.
    bool resolve(const Assembly& all, std::vector<Hole>& holes, const Execution& execution) const {
        const u32 added = static_cast<u32>(all.owners.size());
        if (added == 0) return false;
        const auto joined_row = [&](u32 row) { return joined(all.triangles[row]); };
        const TriangleTree fillings(all.positions, std::span(all.triangles).subspan(count_), execution.threads());
        std::vector<u32> begin{0};
        for (u32 i = 1; i <= added; ++i)
            if (i == added || all.owners[i] != all.owners[i - 1]) begin.push_back(i);

        std::vector<std::vector<u32>> losers(begin.size());
        losers.back() = owners_of_repeated_edges(all, begin, holes);
        for_each_chunk(execution.threads(), begin.size() - 1, 1, [&](std::size_t hole, std::size_t) {
            Array<u32> near;
            const u32 owner = all.owners[begin[hole]];
            for (u32 i = begin[hole]; i < begin[hole + 1]; ++i) {
                if ((i & 255) == 0) execution.check_cancelled();
                const BoundingBox box = box_of(all.positions, all.triangles[count_ + i]);
                const auto meets = [&](u32 other) {
                    return other != count_ + i &&
                           triangles_intersect(all.positions, joined_row(count_ + i), joined_row(other));
                };
                near.clear();
                tree_.meeting(box, near);
                bool gives_way = std::ranges::any_of(near, meets);
                near.clear();
                if (!gives_way) fillings.meeting(box, near);
                for (const u32 row : near) {
                    const u32 other = all.owners[row];
                    if (!meets(count_ + row)) continue;
                    if (other == owner) gives_way = true;
                    if (other != owner) losers[hole].push_back(loser_of(owner, other, holes));
                }
                if (gives_way) {
                    losers[hole] = {owner};
                    break;
                }
            }
        });
        std::vector<bool> demoted(holes.size(), false);
        bool any = false;
        for (const std::vector<u32>& some : losers)
            for (const u32 loser : some)
                if (!demoted[loser]) {
                    holes[loser].demote();
                    demoted[loser] = any = true;
                }
        return any;
    }

    /// The triangles of least total area that close the loop, do not intersect the mesh and repeat none of its edges;
    /// of equal ones those that join the first vertices. Empty if there are none, or too many to try.
    std::vector<Triangle> least_triangulation(std::span<const u32> loop, const Execution& execution) const {
        const std::size_t count = loop.size();
        if (count > most_edges_to_avoid) return {};
        constexpr double none = std::numeric_limits<double>::infinity();
        std::vector<double> least(count * count, none);
        std::vector<std::size_t> third(count * count, 0);
        const auto vertex = [&](std::size_t i) { return half_edges::start(mesh_, loop[i]); };
        const auto is_free = [&](std::size_t i, std::size_t j) {
            return j == i + 1 || (i == 0 && j + 1 == count) || !rim_edges_.contains(key(vertex(i), vertex(j)));
        };
        for (std::size_t i = 0; i + 1 < count; ++i) least[i * count + i + 1] = 0;
        for (std::size_t span = 2; span < count; ++span) {
            execution.check_cancelled();
            for (std::size_t i = 0; i + span < count; ++i) {
                const std::size_t j = i + span;
                if (!is_free(i, j)) continue;
                double& best = least[i * count + j];
                for (std::size_t k = i + 1; k < j; ++k) {
                    const double parts = least[i * count + k] + least[k * count + j];
                    if (!(parts < best)) continue;
                    // The loop has the surface on its left, the filling the other way round.
                    const Triangle triangle{vertex(j), vertex(k), vertex(i)};
                    const Vec3 &a = mesh_.positions[triangle[0]], &b = mesh_.positions[triangle[1]],
                               &c = mesh_.positions[triangle[2]];
                    const double area = parts + (b - a).cross(c - a).norm();
                    if (!(area < best) || meets_mesh(triangle)) continue;
                    best = area;
                    third[i * count + j] = k;
                }
            }
        }
        std::vector<Triangle> triangles;
        if (least[count - 1] == none) return triangles;
        std::vector<std::array<std::size_t, 2>> sections{{0, count - 1}};
        while (!sections.empty()) {
            const auto [i, j] = sections.back();
            sections.pop_back();
            if (j == i + 1) continue;
            const std::size_t k = third[i * count + j];
            triangles.push_back({vertex(j), vertex(k), vertex(i)});
            sections.push_back({i, k});
            sections.push_back({k, j});
        }
        return triangles;
    }

private:
    /// Vertices of the mesh at one position are one corner.
    Triangle joined(Triangle triangle) const {
        for (u32& vertex : triangle)
            if (vertex < vertices_) vertex = lowest_[vertex];
        return triangle;
    }

    bool meets_mesh(const Triangle& triangle) const {
        BoundingBox box;
        for (const u32 vertex : triangle) box.add(mesh_.positions[vertex]);
        Array<u32> near;
        tree_.meeting(box, near);
        return std::ranges::any_of(near, [&](u32 row) {
            return triangles_intersect(mesh_.positions.span(), joined(triangle), joined(mesh_.triangles[row]));
        });
    }

    static u64 key(u32 a, u32 b) { return u64{std::min(a, b)} << 32 | std::max(a, b); }
    static u32 loser_of(u32 one, u32 other, std::span<const Hole> holes) {
        const std::size_t edges = holes[one].loop.size(), others = holes[other].loop.size();
        return edges > others || (edges == others && one > other) ? one : other;
    }

    /// Fillings with an inner edge, between two vertices of rims, that the mesh or another filling has.
    std::vector<u32> owners_of_repeated_edges(const Assembly& all, std::span<const u32> begin,
                                              std::span<const Hole> holes) const {
        std::vector<u32> losers;
        std::unordered_map<u64, u32> owner_of;
        std::vector<u64> edges;
        for (std::size_t hole = 0; hole + 1 < begin.size(); ++hole) {
            const u32 owner = all.owners[begin[hole]];
            edges.clear();
            for (u32 i = begin[hole]; i < begin[hole + 1]; ++i)
                for (std::size_t k = 0; k < 3; ++k)
                    if (const u32 a = all.triangles[count_ + i][k], b = all.triangles[count_ + i][(k + 1) % 3];
                        a < vertices_ && b < vertices_)
                        edges.push_back(key(a, b));
            std::ranges::sort(edges);
            for (std::size_t i = 1; i < edges.size(); ++i) {
                if (edges[i] != edges[i - 1]) continue;  // an edge of the loop has one triangle of the filling
                if (rim_edges_.contains(edges[i])) losers.push_back(owner);
                const auto [found, is_new] = owner_of.try_emplace(edges[i], owner);
                if (!is_new) losers.push_back(loser_of(owner, found->second, holes));
            }
        }
        return losers;
    }

    const TriangleMesh& mesh_;
    u32 vertices_, count_;
    TriangleTree tree_;
    Array<u32> lowest_;
    /// Of the mesh, between vertices of loops.
    std::unordered_set<u64> rim_edges_;
};

void fill(Hole& hole, const TriangleMesh& mesh, const Boundary& boundary, const Conflicts& conflicts,
          const Execution& execution) {
    const Cutout cutout(mesh, boundary, hole.loop);
    const u32 around = static_cast<u32>(cutout.vertices.size()), vertices = static_cast<u32>(mesh.positions.size());
    while (!hole.open) {
        if (hole.stage == FillingStage::avoiding) {
            hole.triangles = conflicts.least_triangulation(hole.loop, execution);
            hole.open = hole.triangles.empty();
            return;
        }
        LoopFilling filling = fill_loop(cutout.part, hole.stage, execution);
        if (filling.triangles.empty()) {
            hole.demote();
            continue;
        }
        hole.positions = std::move(filling.positions);
        for (Triangle& triangle : filling.triangles)
            for (u32& vertex : triangle)
                vertex = vertex < around ? cutout.vertices[vertex] : vertices + (vertex - around);
        hole.triangles = std::move(filling.triangles);
        return;
    }
}

/// Where new vertices and triangles take their values from.
struct Sources {
    Array<u32> vertices, triangles;  ///< rows, the input's first
};

Sources sources_of(const TriangleMesh& mesh, const Assembly& all, std::span<const Hole> holes) {
    const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
    Sources rows;
    rows.vertices.resize(vertices);
    rows.triangles.resize(triangles);
    std::iota(rows.vertices.begin(), rows.vertices.end(), 0);
    std::iota(rows.triangles.begin(), rows.triangles.end(), 0);
    rows.vertices.resize(all.positions.size(), nobody);
    std::size_t first = triangles;
    for (const Hole& hole : holes) {
        if (hole.triangles.empty()) continue;
        const std::size_t last = first + hole.triangles.size();
        // Breadth first from the loop; a vertex takes the position in the loop of the one that reaches it first.
        std::unordered_map<u32, u32> place;
        std::unordered_map<u32, std::vector<u32>> beside;
        for (std::size_t t = first; t < last; ++t)
            for (int i = 0; i < 3; ++i)
                for (const int j : {(i + 1) % 3, (i + 2) % 3})
                    beside[all.triangles[t][static_cast<std::size_t>(i)]].push_back(
                        all.triangles[t][static_cast<std::size_t>(j)]);
        std::vector<u32> queue;
        for (u32 i = 0; i < hole.loop.size(); ++i) {
            queue.push_back(half_edges::start(mesh, hole.loop[i]));
            place[queue.back()] = i;
        }
        for (std::size_t head = 0; head < queue.size(); ++head)
            for (const u32 vertex : beside[queue[head]])
                if (place.try_emplace(vertex, place.at(queue[head])).second) queue.push_back(vertex);
        for (const u32 vertex : queue)
            if (vertex >= vertices) rows.vertices[vertex] = half_edges::start(mesh, hole.loop[place.at(vertex)]);
        for (std::size_t t = first; t < last; ++t) {
            u32 least = nobody;
            for (const u32 vertex : all.triangles[t]) least = std::min(least, place.at(vertex));
            rows.triangles.push_back(hole.loop[least] / 3);
        }
        first = last;
    }
    return rows;
}

Vec3 twice_area(const Assembly& all, std::size_t t) {
    const auto& [a, b, c] = all.triangles[t];
    return (all.positions[b] - all.positions[a]).cross(all.positions[c] - all.positions[a]);
}

/// `column` with the vectors `added`, repeated to fill a row, in its last rows. Rows whose vector is 0 stay.
template <class Number>
Column with_directions(const Column& column, std::span<const Vec3> added) {
    const std::span<const Number> old = column.values<Number>();
    Array<Number> values(old.begin(), old.end());
    const std::size_t width = column.components(), first = column.rows() - added.size();
    for (std::size_t i = 0; i < added.size(); ++i)
        for (std::size_t k = 0; k < width && !added[i].isZero(0); ++k)
            values[(first + i) * width + k] = static_cast<Number>(added[i][static_cast<Eigen::Index>(k % 3)]);
    return {column.name(), column.components(), Buffer<Number>(std::move(values))};
}

/// The columns at `rows`; `name` has the directions `added` in its last rows; `filled` marks these.
ColumnTable extended(const ColumnTable& columns, const Array<u32>& rows, std::string_view name, u32 width,
                     std::span<const Vec3> added, std::string_view element, Context& context) {
    ColumnTable result;
    Array<u8> filled(rows.size(), 0);
    for (const Column& column : added.empty() ? columns : columns.gather(rows)) {
        if (column.name() == "filled") {
            if (column.components() == 1 && column.type() == ScalarType::uint8)
                std::ranges::copy(column.values<u8>(), filled.begin());
            else
                context.warn(fmt::format("the {} column 'filled' of the input is replaced: it is not one uint8 per row",
                                         element));
        } else if (column.name() == name && column.components() == width && column.type() == ScalarType::float32) {
            result.add(with_directions<float>(column, added));
        } else if (column.name() == name && column.components() == width && column.type() == ScalarType::float64) {
            result.add(with_directions<double>(column, added));
        } else {
            result.add(column);
        }
    }
    std::fill(filled.end() - static_cast<std::ptrdiff_t>(added.size()), filled.end(), u8{1});
    result.add(Column("filled", 1, Buffer<u8>(std::move(filled))));
    return result;
}

void set_mesh(FillHolesResult& result, const TriangleMesh& mesh, Assembly all, std::span<const Hole> holes,
              Context& context) {
    const std::size_t vertices = mesh.positions.size(), triangles = mesh.triangles.size();
    const Sources rows = sources_of(mesh, all, holes);
    std::vector<Vec3> facet_normals, vertex_normals(all.positions.size() - vertices, Vec3::Zero());
    for (std::size_t t = triangles; t < all.triangles.size(); ++t) {
        const Vec3 normal = twice_area(all, t);
        result.area += normal.norm() / 2;
        facet_normals.push_back(normal.stableNormalized());
        for (const u32 vertex : all.triangles[t])
            if (vertex >= vertices) vertex_normals[vertex - vertices] += normal;
    }
    for (Vec3& normal : vertex_normals) normal.stableNormalize();
    result.mesh = mesh;
    result.mesh.vertex_columns =
        extended(mesh.vertex_columns, rows.vertices, "normal", 3, vertex_normals, "vertex", context);
    result.mesh.face_columns =
        extended(mesh.face_columns, rows.triangles, "corner-normals", 9, facet_normals, "face", context);
    if (facet_normals.empty()) return;
    result.mesh.positions = std::move(all.positions);
    result.mesh.triangles = std::move(all.triangles);
}

void require_usable(const TriangleMesh& mesh, const FillHolesParams& params) {
    if (params.max_edges && *params.max_edges < 3)
        throw Error("max-edges must be at least 3, as a loop has no fewer edges; it is {}", *params.max_edges)
            .hint("leave max-edges out to fill loops of any number of edges");
    if (params.max_length && !(params.max_length->value() > 0))
        throw Error("max-length must be above 0; it is {:g} u", params.max_length->value())
            .hint("leave max-length out to fill loops of any length");
    if (mesh.triangles.empty())
        throw Error("the mesh has no triangles; fill-holes needs at least one")
            .hint("`scanmill info` shows what a file contains; alpha-solid and region-grow make meshes of points");
    require_consistent(mesh);
    require_finite(mesh.positions.span(), "vertices");
    std::size_t repeats = 0, first = 0;
    for (std::size_t t = mesh.triangles.size(); t-- > 0;)
        if (half_edges::has_repeated_vertex(mesh.triangles[t])) ++repeats, first = t;
    if (repeats > 0)
        throw Error("{} a repeated vertex, first triangle {}: {}, {} and {}",
                    count_text(repeats, "triangle has", "triangles have"), first, mesh.triangles[first][0],
                    mesh.triangles[first][1], mesh.triangles[first][2])
            .hint("repair drops such triangles");
}

/// Boundary half-edges whose two positions are those of another one.
std::size_t coincident_edges(const TriangleMesh& mesh, std::span<const u32> boundary) {
    if (boundary.empty()) return 0;
    const Array<u32> lowest = lowest_at_position(mesh.positions.span());
    std::vector<Edge> edges;
    for (const u32 h : boundary)
        edges.push_back(make_edge(lowest[half_edges::start(mesh, h)], lowest[half_edges::end(mesh, h)]));
    std::ranges::sort(edges);
    std::size_t coincident = 0;
    for (std::size_t i = 0; i < edges.size(); ++i)
        coincident += (i > 0 && edges[i] == edges[i - 1]) || (i + 1 < edges.size() && edges[i] == edges[i + 1]);
    return coincident;
}

void report_doubts(const FillHolesResult& result, double diagonal, std::size_t too_long, double share,
                   Context& context) {
    if (too_long > 0)
        context.doubt(
            fmt::format("{} longer than the diagonal of the mesh ({:.6g} u) filled, the longest {:.6g} u: "
                        "{} as large as the object is invented; max-length leaves such loops open",
                        count_text(too_long, "loop is", "loops are"), diagonal, result.longest,
                        by_count(too_long, "a surface", "surface")));
    if (share > doubtful_share)
        context.doubt(
            fmt::format("{:.1f} % of the surface are fillings, more than {:.0f} %", 100 * share, 100 * doubtful_share));
    if (result.failed > 0)
        context.doubt(fmt::format(
            "{} open: no filling was found that intersects neither the surface nor itself nor another filling",
            count_text(result.failed, "loop stays", "loops stay")));
}

}  // namespace

FillHolesResult fill_holes(const TriangleMesh& mesh, const FillHolesParams& params, Context& context) {
    require_usable(mesh, params);
    context.check_cancelled();
    const Boundary boundary(mesh);
    if (const std::size_t seams = coincident_edges(mesh, boundary.half_edges()); seams > 0)
        context.warn(
            fmt::format("{} at the position of another one: the surface is cut there, not missing; repair "
                        "joins such edges",
                        count_text(seams, "boundary edge is", "boundary edges are")));
    const FillingStage first_stage = params.fair ? FillingStage::faired : FillingStage::refined;
    FillHolesResult result;
    std::vector<Hole> holes;
    for (const std::vector<u32>& loop : boundary.loops()) {
        const bool fits = (!params.max_edges || loop.size() <= *params.max_edges) &&
                          (!params.max_length || length_of(mesh, loop) <= params.max_length->value());
        if (fits)
            holes.push_back({loop, first_stage, false, {}, {}});
        else
            ++result.beyond_limits;
    }

    Assembly all(mesh, {});
    if (!holes.empty()) {
        const Conflicts conflicts(mesh, holes, context.threads());
        std::atomic<std::size_t> done = 0;
        do {
            context.check_cancelled();
            done = 0;
            for_each_chunk(context.threads(), holes.size(), 1, [&](std::size_t i, std::size_t) {
                context.check_cancelled();
                if (!holes[i].open && holes[i].triangles.empty()) fill(holes[i], mesh, boundary, conflicts, context);
                context.progress(0.8 * static_cast<double>(++done) / static_cast<double>(holes.size()));
            });
            all = Assembly(mesh, holes);
        } while (conflicts.resolve(all, holes, context));
    }

    const double diagonal = surface_box(mesh).diagonal();
    std::size_t too_long = 0;
    for (const Hole& hole : holes) {
        if (hole.open) {
            ++result.failed;
            continue;
        }
        ++result.filled;
        result.plain += hole.stage != first_stage;
        const double length = length_of(mesh, hole.loop);
        result.longest = std::max(result.longest, length);
        too_long += length > diagonal;
    }
    double whole = 0;
    for (std::size_t t = 0; t < all.triangles.size(); ++t) whole += twice_area(all, t).norm() / 2;
    const std::size_t added_triangles = all.owners.size(), added_points = all.positions.size() - mesh.positions.size();
    set_mesh(result, mesh, std::move(all), holes, context);
    const double share = whole > 0 ? result.area / whole : 0;
    report_doubts(result, diagonal, too_long, share, context);

    context.metric("filled", static_cast<double>(result.filled));
    context.metric("left", static_cast<double>(result.beyond_limits + result.failed));
    context.metric("added-triangles", static_cast<double>(added_triangles));
    context.metric("added-points", static_cast<double>(added_points));
    context.metric("area", result.area, Unit::area);
    context.metric("share", share, Unit::ratio);
    context.metric("longest", result.longest, Unit::length);
    context.metric("plain", static_cast<double>(result.plain));
    context.metric("failed", static_cast<double>(result.failed));
    context.progress(1);
    return result;
}

}  // namespace scanmill
