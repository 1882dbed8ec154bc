// SPDX-License-Identifier: GPL-3.0-or-later
#include "tessellate/tessellate.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/bounds.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"
#include "tessellate/grid.hpp"

namespace scanmill {

namespace {

using namespace tessellation;

constexpr std::size_t chunk = 64;  // edges or triangles
constexpr unsigned uniform_fan = 4, least_fan = 2;  // segments of a fan
constexpr unsigned most_subdivision = 1024;
constexpr double least_decrease = 0.7;  // least ratio of the errors before and after the segments are doubled
constexpr double rounding = 1e-14;  // values at points of the mesh below this share of the diagonal count as 0

Barycentric corner(u32 i) {
    Barycentric at = Barycentric::Zero();
    at[i] = 1;
    return at;
}

class Tessellation {
public:
    Tessellation(const PatchComplex& patches, const TessellateParams& params, Execution& execution)
        : patches_(patches),
          subdivision_(params.subdivision),
          max_error_(params.max_error ? std::optional(params.max_error->value()) : std::nullopt),
          segments_(params.segments),
          execution_(execution) {
        if (subdivision_ < 1 || subdivision_ > most_subdivision)
            throw Error("subdivision must be from 1 to {}; it is {}", most_subdivision, subdivision_)
                .hint(fmt::format("the default is {}", TessellateParams().subdivision));
        if (max_error_ && !(*max_error_ > 0))
            throw Error("max-error must be above 0; it is {:g}", *max_error_)
                .hint("without it all edges get `subdivision` segments");
    }

    TriangleMesh mesh(double* left) {
        structure_ = structure_of(patches_);
        zero_ = rounding * bounding_box(patches_.positions.span()).diagonal();
        number_corners();
        max_error_ ? build_within_error(left) : static_cast<void>(build(subdivision_));
        collect_points();
        connect();
        return finished();
    }

private:
    void build_strip(std::size_t e, unsigned most) {
        const EdgeTets& edge = structure_.edges[e];
        Strip& strip = strips_[e];
        const bool is_fixed = segments_ || !max_error_;
        strip.segments = segments_    ? std::clamp(segments_(make_edge(edge.a, edge.b)), 1u, most_subdivision)
                         : max_error_ ? 1
                                      : most;
        strip.fan = edge.is_border() ? 0 : is_fixed ? uniform_fan : least_fan;
        tessellation::build(strip, patches_, structure_, edge, zero_, is_fixed ? std::nullopt : max_error_, most);
    }

    // Grids.

    u32 row_vertex(std::size_t e, std::size_t s, unsigned k) const {
        const EdgeTets& edge = structure_.edges[e];
        const Strip& strip = strips_[e];
        if (s == 0) return number_of_corner_[edge.a];
        if (s > strip.samples.size()) return number_of_corner_[edge.b];
        return strip.first_vertex + strip.number(s - 1, k);
    }

    /// The samples on the edges of triangle f, from corner i to the next.
    std::array<Row, 3> rows_of(std::size_t f) const {
        std::array<Row, 3> rows;
        for (std::size_t i = 0; i < 3; ++i) {
            const std::size_t e = structure_.triangles[f].edges[i];
            const Strip& strip = strips_[e];
            const bool is_first = structure_.edges[e].triangles[0] == f;
            const std::size_t last = strip.samples.size() + 1;
            for (std::size_t n = 0; n <= last; ++n) {
                const std::size_t s = is_first ? n : last - n;
                rows[i].vertices.push_back(row_vertex(e, s, is_first ? 0 : strip.fan));
                const bool is_end = n == 0 || n == last;
                rows[i].shares.push_back(n == 0 ? 0 : n == last ? 1 : strip.samples[s - 1].share[is_first ? 0 : 1]);
                rows[i].insets.push_back(is_end ? 0 : strip.samples[s - 1].inset[is_first ? 0 : 1]);
            }
        }
        return rows;
    }

    void build_grid(std::size_t f, unsigned most) {
        Grid& grid = grids_[f];
        const bool is_fixed = segments_ || !max_error_;
        grid.segments = is_fixed && !segments_ ? most : 1;
        for (const u32 e : structure_.triangles[f].edges) grid.segments = std::max(grid.segments, strips_[e].segments);
        tessellation::build(grid, patches_, structure_.triangles[f], rows_of(f), points_, zero_,
                            {is_fixed ? std::nullopt : max_error_, most});
    }

    // Levels.

    /// Lifts all points with at most `most` segments per edge. Returns the largest distance that is found between the
    /// triangles and the surface.
    double build(unsigned most) {
        strips_.assign(structure_.edges.size(), {});
        for_each_chunk(execution_.threads(), strips_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (std::size_t e = begin; e < end; ++e) build_strip(e, most);
        });
        std::size_t next = corners_;
        for (Strip& strip : strips_) {
            strip.first_vertex = static_cast<u32>(next);
            next += strip.points.size();
        }
        require_countable(next);
        points_.resize(corners_);
        for (const Strip& strip : strips_) points_.insert(points_.end(), strip.points.begin(), strip.points.end());
        grids_.assign(structure_.triangles.size(), {});
        for_each_chunk(execution_.threads(), grids_.size(), chunk, [&](std::size_t begin, std::size_t end) {
            execution_.check_cancelled();
            for (std::size_t f = begin; f < end; ++f) build_grid(f, most);
        });
        double worst = 0;
        for (const Strip& strip : strips_) worst = std::max(worst, strip.worst);
        for (const Grid& grid : grids_) worst = std::max(worst, grid.worst);
        return worst;
    }

    void build_within_error(double* distance_left) {
        const unsigned most = std::bit_floor(subdivision_);
        const double worst = build(most);
        if (distance_left) *distance_left = 0;
        if (worst <= *max_error_ || segments_) return;
        // The error falls with the square of the number of segments, but not where the surface jumps.
        const bool can_double = 2 * most <= most_subdivision;
        const double coarse = can_double ? worst : build(most / 2), fine = can_double ? build(2 * most) : worst;
        const bool leaps = fine > least_decrease * coarse;
        if (distance_left && leaps) {
            *distance_left = build(most);
            return;
        }
        Error error("with {} segments per edge the triangles are up to {:.3g} from the surface; max-error is {:.3g}",
                    most, worst, *max_error_);
        unsigned enough = can_double ? 2 * most : most;
        for (double estimate = fine; estimate > *max_error_ && enough <= most_subdivision; enough *= 2)
            estimate *= fine / coarse;
        error.set_hint(leaps                        ? "the surface jumps there; a larger max-error needs fewer segments"
                       : enough <= most_subdivision ? fmt::format("subdivision {} suffices", enough)
                                                    : "use a larger max-error, or `decimate` with a smaller one");
        throw error;
    }

    static void require_countable(std::size_t vertices) {
        if (vertices >= none)
            throw Error("the mesh would have {} vertices; at most {} are possible", vertices, none - 1)
                .hint("use a smaller subdivision, or a larger max-error");
    }

    // The result: vertices of the mesh below, then strip by strip, then grid by grid.

    void number_corners() {
        number_of_corner_.assign(patches_.positions.size(), none);
        for (const TriangleTets& t : structure_.triangles)
            for (const u32 v : t.corners) number_of_corner_[v] = 0;
        corners_ = 0;
        for (u32& number : number_of_corner_)
            if (number != none) number = corners_++;
        points_.resize(corners_);
        corner_normals_.resize(structure_.triangles.size());
        for (std::size_t f = 0; f < structure_.triangles.size(); ++f) {
            const TriangleTets& t = structure_.triangles[f];
            for (u32 i = 0; i < 3; ++i) {
                const PatchCell here(patches_, t.rows[1][t.count == 3 ? i : 0]);
                const Vec3 normal = here.gradient(corner(t.count == 3 ? 1 : i)).normalized();
                corner_normals_[f][i] = normal;
                SurfacePoint& point = points_[number_of_corner_[t.corners[i]]];
                point.position = patches_.positions[t.corners[i]];
                point.normal = normal;
            }
        }
    }

    void collect_points() {
        std::size_t next = points_.size();
        for (Grid& grid : grids_) {
            grid.first_vertex = static_cast<u32>(next);
            next += grid.points.size();
        }
        require_countable(next);
        points_.reserve(next);
        for (const Grid& grid : grids_) points_.insert(points_.end(), grid.points.begin(), grid.points.end());
    }

    void connect() {
        has_creases_ = std::ranges::any_of(structure_.edges, &EdgeTets::is_sharp);
        if (has_creases_) collect_creases();
        for (u32 f = 0; f < grids_.size(); ++f) {
            patch_ = f;
            tessellation::connect(grids_[f], grids_[f].first_vertex, rows_of(f),
                                  [&](u32, u32 a, u32 b, u32 c) { add(a, b, c); });
        }
        for (std::size_t e = 0; e < strips_.size(); ++e) {
            const EdgeTets& edge = structure_.edges[e];
            const unsigned fan = strips_[e].fan;
            for (std::size_t s = 0; s <= strips_[e].samples.size(); ++s)
                for (unsigned k = 0; k < fan; ++k) {
                    patch_ = edge.triangles[2 * k >= fan];
                    const u32 a = row_vertex(e, s, k), b = row_vertex(e, s, k + 1), c = row_vertex(e, s + 1, k + 1),
                              d = row_vertex(e, s + 1, k);
                    add(a, b, c);
                    add(a, c, d);
                }
        }
    }

    /// Collects the edges along creases, and the normals beyond them.
    void collect_creases() {
        beyond_.resize(points_.size());
        std::vector<bool> is_sharp(corners_, false);
        for (std::size_t e = 0; e < strips_.size(); ++e) {
            const EdgeTets& edge = structure_.edges[e];
            if (!edge.is_sharp) continue;
            const Strip& strip = strips_[e];
            for (std::size_t s = 0; s <= strip.samples.size(); ++s)
                creases_.push_back(make_edge(row_vertex(e, s, strip.fan / 2), row_vertex(e, s + 1, strip.fan / 2)));
            for (std::size_t i = 0; i < strip.points.size(); ++i)
                beyond_[strip.first_vertex + i] = {edge.triangles[1], strip.second_normals[i]};
            is_sharp[number_of_corner_[edge.a]] = is_sharp[number_of_corner_[edge.b]] = true;
        }
        std::ranges::sort(creases_);
        // At the ends of creases, the normal is the mean of the normals of the triangles there.
        for (u32 v = 0; v < corners_; ++v)
            if (is_sharp[v]) points_[v].normal = Vec3::Zero();
        for (std::size_t f = 0; f < structure_.triangles.size(); ++f)
            for (std::size_t i = 0; i < 3; ++i) {
                const u32 v = number_of_corner_[structure_.triangles[f].corners[i]];
                if (is_sharp[v]) points_[v].normal += corner_normals_[f][i];
            }
        for (u32 v = 0; v < corners_; ++v)
            if (is_sharp[v]) points_[v].normal.normalize();
    }

    void add(u32 a, u32 b, u32 c) {
        if (a == b || b == c || c == a) return;
        out_.push_back({a, b, c});
        out_patches_.push_back(patch_);
        out_sides_.push_back(std::min({points_[a].side, points_[b].side, points_[c].side}));
        if (!has_creases_) return;
        for (const u32 v : {a, b, c}) {
            const Vec3 normal = normal_at(v);
            out_normals_.insert(out_normals_.end(), normal.data(), normal.data() + 3);
        }
    }

    /// The normal at a vertex of a triangle that is being added, on its side of creases.
    Vec3 normal_at(u32 vertex) const {
        if (vertex < corners_) {
            const auto& corners = structure_.triangles[patch_].corners;
            for (std::size_t i = 0; i < 3; ++i)
                if (number_of_corner_[corners[i]] == vertex) return corner_normals_[patch_][i];
        }
        const Beyond& beyond = beyond_[vertex];
        return beyond.triangle == patch_ && !beyond.normal.isZero(0) ? beyond.normal : points_[vertex].normal;
    }

    TriangleMesh finished() {
        TriangleMesh mesh;
        mesh.frame = patches_.frame;
        Array<Vec3> positions(points_.size());
        Array<double> normals(3 * points_.size());
        for (std::size_t v = 0; v < points_.size(); ++v) {
            positions[v] = points_[v].position;
            const Vec3 normal = has_creases_ && !beyond_[v].normal.isZero(0)
                                    ? (points_[v].normal + beyond_[v].normal).normalized()
                                    : points_[v].normal;
            for (std::size_t i = 0; i < 3; ++i) normals[3 * v + i] = normal[static_cast<Eigen::Index>(i)];
        }
        mesh.positions = std::move(positions);
        mesh.triangles = std::move(out_);
        mesh.sharp_edges = std::move(creases_);
        mesh.vertex_columns.add(Column("normal", 3, Buffer<double>(std::move(normals))));
        mesh.face_columns.add(Column("patch", 1, Buffer<u32>(std::move(out_patches_))));
        mesh.face_columns.add(Column("side", 1, Buffer<u8>(std::move(out_sides_))));
        if (has_creases_) mesh.face_columns.add(Column("corner-normals", 9, Buffer<double>(std::move(out_normals_))));
        return mesh;
    }

    const PatchComplex& patches_;
    unsigned subdivision_;
    std::optional<double> max_error_;
    const std::function<unsigned(Edge)>& segments_;
    Execution& execution_;
    PatchStructure structure_;
    double zero_ = 0;  ///< values up to it count as 0
    std::vector<Strip> strips_;
    std::vector<Grid> grids_;
    std::vector<u32> number_of_corner_;  ///< by point of the complex
    u32 corners_ = 0;
    std::vector<SurfacePoint> points_;  ///< points of the corners and strips; in the end also those of the grids
    std::vector<std::array<Vec3, 3>> corner_normals_;  ///< normals at the corners of the mesh's triangles
    bool has_creases_ = false;
    struct Beyond {
        u32 triangle = none;  ///< the second triangle at a crease
        Vec3 normal = Vec3::Zero();
    };
    std::vector<Beyond> beyond_;  ///< by point
    Array<Edge> creases_;
    u32 patch_ = 0;  ///< patch of the triangles that are being added
    Array<double> out_normals_;
    Array<Triangle> out_;
    Array<u32> out_patches_;
    Array<u8> out_sides_;
};

}  // namespace

TriangleMesh tessellate(const PatchComplex& patches, const TessellateParams& params, Execution& execution,
                        double* left) {
    return without_equal_corners(Tessellation(patches, params, execution).mesh(left));
}

TriangleMesh without_equal_corners(const TriangleMesh& mesh) {
    DisjointSets joined(mesh.positions.size());
    bool is_any = false;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i)
            if (const u32 a = t[i], b = t[(i + 1) % 3]; mesh.positions[a] == mesh.positions[b]) {
                joined.unite(a, b);
                is_any = true;
            }
    if (!is_any) return mesh;

    TriangleMesh result = mesh;
    Array<Triangle> triangles;
    Array<u32> rows;
    for (u32 row = 0; row < mesh.triangles.size(); ++row) {
        Triangle t = mesh.triangles[row];
        for (u32& corner : t) corner = joined.find(corner);
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
        triangles.push_back(t);
        rows.push_back(row);
    }
    Array<Edge> sharp;
    for (const auto& [a, b] : mesh.sharp_edges)
        if (const Edge edge = make_edge(joined.find(a), joined.find(b)); edge[0] != edge[1]) sharp.push_back(edge);
    std::ranges::sort(sharp);
    sharp.erase(std::unique(sharp.begin(), sharp.end()), sharp.end());
    result.triangles = std::move(triangles);
    result.sharp_edges = std::move(sharp);
    result.face_columns = mesh.face_columns.gather(rows);
    result = without_unused_vertices(result);
    const MeshTopology before = topology(mesh), after = topology(result);
    return (before.genus && !after.genus) || (before.closed && !after.closed) ? mesh : result;
}

double largest_bulge(const PatchComplex& patches, unsigned segments, Execution& execution) {
    const PatchStructure structure = structure_of(patches);
    const double zero = rounding * bounding_box(patches.positions.span()).diagonal();
    std::vector<double> largest(structure.edges.size() / chunk + 1, 0.0);
    for_each_chunk(execution.threads(), structure.edges.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        double& bulge = largest[begin / chunk];
        for (std::size_t e = begin; e < end; ++e) {
            const EdgeTets& edge = structure.edges[e];
            if (!edge.is_sharp) continue;
            Strip strip;
            strip.segments = segments;
            strip.fan = least_fan;
            tessellation::build(strip, patches, structure, edge, zero, std::nullopt, segments);
            const Vec3 &a = patches.positions[edge.a], &b = patches.positions[edge.b];
            for (std::size_t s = 0; s < strip.samples.size(); ++s) {
                const Vec3& at = strip.points[strip.number(s, least_fan / 2)].position;
                bulge = std::max(bulge, (nearest_on_segment(at, a, b) - at).norm());
            }
        }
    });
    return std::ranges::max(largest);
}

}  // namespace scanmill
