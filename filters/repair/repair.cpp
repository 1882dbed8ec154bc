// SPDX-License-Identifier: GPL-3.0-or-later
#include "repair/repair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <set>

#include "repair/orient_soup.hpp"
#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/distance/sides.hpp"
#include "scanmill/geometry/distance/triangles_intersect.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/mesh/editable_mesh.hpp"
#include "scanmill/geometry/spatial/cell_grid.hpp"

namespace scanmill {

namespace {

constexpr double doubtful_share = 0.05;  // removed share of the area

double area_of(std::span<const Vec3> positions, const Triangle& triangle) {
    const auto& [a, b, c] = triangle;
    return (positions[b] - positions[a]).cross(positions[c] - positions[a]).norm() / 2;
}

class Repair {
public:
    Repair(const TriangleMesh& mesh, const RepairParams& params, Context& context)
        : mesh_(mesh),
          params_(params),
          context_(context),
          positions_(mesh.positions.begin(), mesh.positions.end()) {}

    RepairResult run() {
        stitch();
        step(0.2);
        drop_repeated();
        step(0.3);
        split();
        step(0.6);
        orient();
        step(0.7);
        carry_edges();
        replace_without_area();
        step(0.8);
        drop_small();
        step(0.9);
        assemble();
        return std::move(result_);
    }

private:
    void step(double fraction) {
        context_.check_cancelled();
        context_.progress(fraction);
    }

    void stitch() {
        joined_ = lowest_at_position(positions_);
        if (params_.stitch.value() > 0) stitch_boundary(params_.stitch.value());
        result_.was_closed = boundary_vertices().empty();
        for (u32 v = 0; v < joined_.size(); ++v) result_.stitched += joined_[v] != v;
    }

    std::vector<u32> boundary_vertices() const {
        std::vector<Edge> edges;
        for (const Triangle& triangle : mesh_.triangles)
            for (std::size_t i = 0; i < 3; ++i)
                edges.push_back(make_edge(joined_[triangle[i]], joined_[triangle[(i + 1) % 3]]));
        std::ranges::sort(edges);
        std::vector<u32> vertices;
        for (std::size_t i = 0, last; i < edges.size(); i = last) {
            for (last = i + 1; last < edges.size() && edges[last] == edges[i];) ++last;
            if (last == i + 1) vertices.insert(vertices.end(), {edges[i][0], edges[i][1]});
        }
        std::ranges::sort(vertices);
        vertices.erase(std::ranges::unique(vertices).begin(), vertices.end());
        return vertices;
    }

    void stitch_boundary(double distance) {
        CellGrid grid(bounding_box(positions_), distance);
        std::vector<std::vector<u32>> kept;  // vertices that stay, by cell
        std::vector<u32> becomes(joined_.size());
        std::iota(becomes.begin(), becomes.end(), 0);
        for (const u32 v : boundary_vertices()) {
            double nearest = distance * distance;
            u32 found = v;
            grid.any_near(positions_[v], [&](u32 cell) {
                for (const u32 other : kept[cell]) {
                    const double squared = (positions_[other] - positions_[v]).squaredNorm();
                    if (squared < nearest || (squared == nearest && other < found)) nearest = squared, found = other;
                }
                return false;
            });
            becomes[v] = found;
            if (found != v) continue;
            const u32 cell = grid.enter(positions_[v]);
            if (cell == kept.size()) kept.emplace_back();
            kept[cell].push_back(v);
        }
        for (u32& vertex : joined_) vertex = becomes[vertex];
    }

    void drop_repeated() {
        std::vector<std::pair<Triangle, u32>> by_corners;
        for (u32 row = 0; row < mesh_.triangles.size(); ++row) {
            Triangle triangle = mesh_.triangles[row];
            for (u32& vertex : triangle) vertex = joined_[vertex];
            input_area_ += area_of(positions_, mesh_.triangles[row]);
            if (half_edges::has_repeated_vertex(triangle)) {
                ++result_.repeated_vertex;
                removed_area_ += area_of(positions_, mesh_.triangles[row]);
                continue;
            }
            std::ranges::sort(triangle);
            by_corners.emplace_back(triangle, row);
        }
        if (by_corners.empty())
            throw Error("no triangle has three different corners; the mesh has {}",
                        count_text(mesh_.triangles.size(), "triangle", "triangles"))
                .hint(params_.stitch.value() > 0 ? "lower stitch: it joins vertices of one triangle"
                                                 : "`scanmill info` shows what a file contains");
        std::ranges::sort(by_corners);
        for (std::size_t i = 0; i < by_corners.size(); ++i)
            if (i > 0 && by_corners[i].first == by_corners[i - 1].first)
                ++result_.duplicates;
            else
                rows_.push_back(by_corners[i].second);
        std::ranges::sort(rows_);
        for (const u32 row : rows_) {
            Triangle triangle = mesh_.triangles[row];
            for (u32& vertex : triangle) vertex = joined_[vertex];
            triangles_.push_back(triangle);
        }
    }

    TriangleMesh current() const {
        TriangleMesh mesh;
        mesh.positions = positions_;
        mesh.triangles = Array<Triangle>(triangles_.begin(), triangles_.end());
        return mesh;
    }

    void split() {
        half_edges::for_each_edge(half_edges::by_smaller_vertex(current()),
                                  [&](u32, auto its) { result_.split_edges += its.size() > 2; });
        source_.resize(positions_.size());
        std::iota(source_.begin(), source_.end(), 0);
        separate_fans();
    }

    /// Gives vertices copies until each has one fan of triangles.
    void separate_fans() {
        if (topology(current()).genus) return;  // an oriented manifold has one fan at each vertex
        const std::vector<u32> originals = orient_soup(positions_.size(), triangles_);
        result_.split_vertices += originals.size();
        for (const u32 original : originals) {
            source_.push_back(source_[original]);
            positions_.push_back(positions_[original]);
        }
    }

    /// Whether the orientation of the triangle at `index` is the reverse of that in the input.
    bool is_reversed(std::size_t index) const {
        const Triangle& input = mesh_.triangles[rows_[index]];
        std::array<u32, 3> now;
        for (std::size_t i = 0; i < 3; ++i) now[i] = source_[triangles_[index][i]];
        const auto first = static_cast<std::size_t>(std::ranges::find(now, joined_[input[0]]) - now.begin());
        return now[(first + 1) % 3] != joined_[input[1]];
    }

    /// Open components take the orientation that more of their area had. Closed ones face outwards, or inwards round a
    /// cavity.
    void orient() {
        const Array<u32> opposite = half_edges::opposites(current());
        const u32 count = static_cast<u32>(triangles_.size());
        DisjointSets components(count);
        for (u32 h = 0; h < opposite.size(); ++h)
            if (opposite[h] != half_edges::boundary) components.unite(h / 3, opposite[h] / 3);
        std::vector<double> kept(count, 0), reversed(count, 0);
        for (u32 t = 0; t < count; ++t)  // a triangle without area counts, too
            (is_reversed(t) ? reversed : kept)[components.find(t)] +=
                std::max(area_of(positions_, triangles_[t]), std::numeric_limits<double>::min());
        for (u32 t = 0; t < count; ++t)
            if (reversed[components.find(t)] > kept[components.find(t)]) std::swap(triangles_[t][1], triangles_[t][2]);
        const Array<u8> wrong = facing_wrong(current(), context_);
        for (u32 t = 0; t < count; ++t) {
            if (wrong[t] != 0) std::swap(triangles_[t][1], triangles_[t][2]);
            result_.oriented += is_reversed(t);
        }
    }

    /// Finds the present vertices of sharp edges and of the rows of edge columns.
    void carry_edges() {
        if (mesh_.sharp_edges.empty() && mesh_.edges.empty()) return;
        std::set<Edge> sharp;
        std::map<Edge, u32> rows;
        for (const auto& [a, b] : mesh_.sharp_edges) sharp.insert(make_edge(joined_[a], joined_[b]));
        for (u32 row = 0; row < mesh_.edges.size(); ++row)
            rows.try_emplace(make_edge(joined_[mesh_.edges[row][0]], joined_[mesh_.edges[row][1]]), row);
        for (const Triangle& triangle : triangles_)
            for (std::size_t i = 0; i < 3; ++i) {
                const u32 a = triangle[i], b = triangle[(i + 1) % 3];
                const Edge input = make_edge(source_[a], source_[b]);
                if (sharp.contains(input)) sharp_.insert(make_edge(a, b));
                if (const auto found = rows.find(input); found != rows.end()) {
                    edge_rows_.emplace(found->second, make_edge(a, b));
                    rows.erase(found);
                }
            }
    }

    bool is_collinear(const Triangle& triangle) const {
        return collinear(positions_[triangle[0]], positions_[triangle[1]], positions_[triangle[2]]);
    }
    u32 longest_edge(const EditableMesh& mesh, u32 row) const {
        u32 longest = 3 * row;
        const auto length = [&](u32 h) { return (positions_[mesh.end(h)] - positions_[mesh.start(h)]).squaredNorm(); };
        for (const u32 h : {3 * row + 1, 3 * row + 2})
            if (length(h) > length(longest)) longest = h;
        return longest;
    }

    void replace_without_area() {
        for (bool again = true; again;) {
            again = false;
            context_.check_cancelled();
            std::vector<u32> flat;
            for (u32 t = 0; t < triangles_.size(); ++t)
                if (is_collinear(triangles_[t])) flat.push_back(t);
            result_.left_without_area = flat.size();
            if (flat.empty()) return;
            EditableMesh mesh(current());
            std::vector<bool> dropped(triangles_.size(), false);
            std::size_t drops = 0;
            for (const u32 t : flat) {
                if (!is_collinear(mesh.triangle(t))) continue;
                const u32 h = longest_edge(mesh, t);
                if (mesh.is_boundary(h)) {
                    dropped[t] = true;
                    ++drops;
                } else if (mesh.can_flip(h) && !is_collinear(mesh.triangle(mesh.opposite(h) / 3))) {
                    const u32 a = mesh.start(h), b = mesh.end(h), c = mesh.apex(h);
                    if (sharp_.erase(make_edge(a, b)) > 0) sharp_.insert({make_edge(a, c), make_edge(c, b)});
                    mesh.flip(h);
                    ++result_.flipped;
                    again = true;
                }
            }
            result_.without_area += drops;
            for (u32 t = 0; t < triangles_.size(); ++t) triangles_[t] = mesh.triangle(t);
            if (drops == 0) continue;
            again = true;
            keep([&](std::size_t t) { return !dropped[t]; });
            if (triangles_.empty())
                throw Error("the corners of every triangle are on one line").hint("such a mesh has no surface");
            separate_parts();
        }
        if (result_.left_without_area > 0)
            context_.warn(fmt::format("{} without area: a flip of their longest edge would repeat an existing edge",
                                      count_text(result_.left_without_area, "triangle stays", "triangles stay")));
    }

    /// Splits vertices where a removed triangle was all that joined two fans.
    void separate_parts() {
        const std::vector<Triangle> before = triangles_;
        separate_fans();
        std::map<Edge, Edge> moved;
        for (std::size_t t = 0; t < before.size(); ++t)
            for (std::size_t i = 0; i < 3 && before[t] != triangles_[t]; ++i)
                moved[make_edge(before[t][i], before[t][(i + 1) % 3])] =
                    make_edge(triangles_[t][i], triangles_[t][(i + 1) % 3]);
        std::set<Edge> sharp;
        for (const Edge& edge : sharp_) {
            const auto found = moved.find(edge);
            sharp.insert(found == moved.end() ? edge : found->second);
        }
        sharp_ = std::move(sharp);
        for (auto& [row, edge] : edge_rows_)
            if (const auto found = moved.find(edge); found != moved.end()) edge = found->second;
    }

    template <class Keeps>
    void keep(Keeps&& keeps) {
        std::size_t size = 0;
        for (std::size_t t = 0; t < triangles_.size(); ++t)
            if (keeps(t)) {
                triangles_[size] = triangles_[t];
                rows_[size++] = rows_[t];
            }
        triangles_.resize(size);
        rows_.resize(size);
    }

    void drop_small() {
        const double share = params_.min_component.value();
        if (!(share > 0)) return;
        const Array<u32> opposite = half_edges::opposites(current());
        DisjointSets components(triangles_.size());
        for (u32 h = 0; h < opposite.size(); ++h)
            if (opposite[h] < half_edges::no_half_edge) components.unite(h / 3, opposite[h] / 3);
        std::vector<double> areas(triangles_.size(), 0);
        double whole = 0;
        for (u32 t = 0; t < triangles_.size(); ++t) {
            const double area = area_of(positions_, triangles_[t]);
            areas[components.find(t)] += area;
            whole += area;
        }
        const auto is_small = [&](u32 t) { return areas[components.find(t)] < share * whole; };
        std::size_t count = 0;
        double largest = 0, largest_small = 0;
        for (u32 t = 0; t < triangles_.size(); ++t) {
            if (components.find(t) == t) {
                ++count;
                largest = std::max(largest, areas[t]);
                result_.removed_components += is_small(t);
                if (is_small(t)) largest_small = std::max(largest_small, areas[t]);
            }
            if (is_small(t)) {
                ++result_.small;
                removed_area_ += area_of(positions_, triangles_[t]);
            }
        }
        if (result_.removed_components == count)
            throw Error(
                "each of the {} components is below min-component: the largest has {:.3g} % of the area, and "
                "{:.3g} % are needed",
                count, 100 * largest / whole, 100 * share)
                .hint("lower min-component; if the mesh is a soup of separate triangles, raise stitch");
        if (result_.small > 0)
            context_.warn(fmt::format(
                "{} of {} removed, with {}: each has less than {:g} % of the area, the largest "
                "{:.2g} %",
                result_.removed_components, count_text(count, "component is", "components are"),
                count_text(result_.small, "triangle", "triangles"), 100 * share, 100 * largest_small / whole));
        keep([&](std::size_t t) { return !is_small(static_cast<u32>(t)); });
    }

    void assemble() {
        TriangleMesh mesh;
        mesh.frame = mesh_.frame;
        mesh.vertex_columns = result_.split_vertices > 0 ? mesh_.vertex_columns.gather(source_) : mesh_.vertex_columns;
        mesh.positions = positions_;
        mesh.triangles = Array<Triangle>(triangles_.begin(), triangles_.end());
        mesh.face_columns =
            rows_.size() == mesh_.triangles.size() ? mesh_.face_columns : mesh_.face_columns.gather(rows_);
        turn_corner_normals(mesh.face_columns);
        if (!sharp_.empty() || !edge_rows_.empty()) set_edges(mesh);
        result_.mesh = without_unused_vertices(mesh);
        result_.unused_points = mesh.positions.size() - result_.mesh.positions.size() - result_.stitched;
        if (removed_area_ > doubtful_share * input_area_)
            context_.doubt(
                fmt::format("{:.1f} % of the area were removed: {} of small components, {} that stitch "
                            "collapses",
                            100 * removed_area_ / input_area_, count_text(result_.small, "triangle", "triangles"),
                            result_.repeated_vertex));
    }

    /// Reorders the face column `corner-normals`: three normals per triangle, in the order of its corners.
    void turn_corner_normals(ColumnTable& columns) const {
        ColumnTable result;
        for (const Column& column : columns) {
            const bool is_it = column.name() == "corner-normals" && column.components() == 9;
            if (is_it && column.type() == ScalarType::float32)
                result.add(turned<float>(column));
            else if (is_it && column.type() == ScalarType::float64)
                result.add(turned<double>(column));
            else
                result.add(column);
        }
        columns = std::move(result);
    }

    template <class Number>
    Column turned(const Column& column) const {
        const std::span<const Number> old = column.values<Number>();
        Array<Number> values(old.begin(), old.end());
        for (std::size_t t = 0; t < triangles_.size(); ++t) {
            const Triangle& input = mesh_.triangles[rows_[t]];
            std::array<std::size_t, 3> corners;  // by corner: its number in the input's triangle
            for (std::size_t i = 0; i < 3; ++i)
                corners[i] = static_cast<std::size_t>(
                    std::ranges::find(input, source_[triangles_[t][i]], [&](u32 v) { return joined_[v]; }) -
                    input.begin());
            if (std::ranges::count(corners, std::size_t{3}) > 0) {  // flipped
                const auto& [a, b, c] = triangles_[t];
                const Vec3 normal = (positions_[b] - positions_[a]).cross(positions_[c] - positions_[a]);
                const Vec3 unit = normal.stableNormalized();
                for (std::size_t k = 0; k < 9; ++k)
                    values[9 * t + k] = static_cast<Number>(unit[static_cast<Eigen::Index>(k % 3)]);
                continue;
            }
            const Number sign = is_reversed(t) ? Number{-1} : Number{1};
            for (std::size_t k = 0; k < 9 && corners != std::array<std::size_t, 3>{0, 1, 2}; ++k)
                values[9 * t + k] = sign * old[9 * t + 3 * corners[k / 3] + k % 3];
        }
        return {column.name(), column.components(), Buffer<Number>(std::move(values))};
    }

    void set_edges(TriangleMesh& mesh) {
        std::set<Edge> edges;
        for (const Triangle& triangle : triangles_)
            for (std::size_t i = 0; i < 3; ++i) edges.insert(make_edge(triangle[i], triangle[(i + 1) % 3]));
        Array<Edge> sharp, kept;
        for (const Edge& edge : sharp_)
            if (edges.contains(edge)) sharp.push_back(edge);
        Array<u32> rows;
        for (const auto& [row, edge] : edge_rows_)
            if (edges.contains(edge)) {
                rows.push_back(row);
                kept.push_back(edge);
            }
        mesh.sharp_edges = std::move(sharp);
        mesh.edge_columns = mesh_.edge_columns.gather(rows);
        mesh.edges = std::move(kept);
    }

    const TriangleMesh& mesh_;
    const RepairParams& params_;
    Context& context_;
    RepairResult result_;
    /// Positions of the input, then of copies.
    Array<Vec3> positions_;
    /// The vertex that each vertex of the input is joined to.
    Array<u32> joined_;
    /// Per vertex the row of the input's vertex whose values it has.
    Array<u32> source_;
    std::vector<Triangle> triangles_;
    /// Per triangle its row in the input.
    Array<u32> rows_;
    std::set<Edge> sharp_;
    std::map<u32, Edge> edge_rows_;
    double input_area_ = 0, removed_area_ = 0;
};

void require_usable(const TriangleMesh& mesh, const RepairParams& params) {
    const double stitch = params.stitch.value(), share = params.min_component.value();
    if (!(stitch >= 0) || !std::isfinite(stitch))
        throw Error("stitch must be 0 or more; it is {:g} u", stitch).hint("0 joins vertices at equal positions only");
    if (!(share >= 0 && share <= 1))
        throw Error("min-component must be from 0 to 100 %; it is {:g} %", 100 * share)
            .hint("`1 %` removes components with less than a hundredth of the area");
    require_triangles(mesh, "repair needs at least one");
}

/// Whether all `edges` are edges of triangles, without repeats.
bool are_edges(std::span<const Edge> edges, const TriangleMesh& mesh) {
    std::set<Edge> missing(edges.begin(), edges.end());
    if (missing.size() < edges.size()) return false;
    for (u32 h = 0; !missing.empty() && h < 3 * mesh.triangles.size(); ++h)
        missing.erase(make_edge(half_edges::start(mesh, h), half_edges::end(mesh, h)));
    return missing.empty();
}

/// Whether the mesh needs no repair. In rare cases false although a closer look would find that it needs none.
bool is_sound(const TriangleMesh& mesh, const MeshTopology& shape, const RepairParams& params, Context& context) {
    if (!shape.genus || shape.unused_vertices > 0) return false;
    if (params.stitch.value() > 0 && !shape.closed) return false;
    if (params.min_component.value() > 0 && shape.components > 1) return false;
    const std::span<const Vec3> positions = mesh.positions.span();
    const Array<u32> lowest = lowest_at_position(positions);
    for (u32 v = 0; v < lowest.size(); ++v)
        if (lowest[v] != v) return false;
    std::vector<u32> corners(positions.size(), 0);
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 v : triangle) ++corners[v];
    for (const auto& [a, b, c] : mesh.triangles) {
        // If two triangles have the same corners, all three corners are in two triangles.
        if (corners[a] == 2 && corners[b] == 2 && corners[c] == 2) return false;
        if (collinear(positions[a], positions[b], positions[c])) return false;
    }
    return are_edges(mesh.edges.span(), mesh) && are_edges(mesh.sharp_edges.span(), mesh) &&
           std::ranges::count(facing_wrong(mesh, context), u8(1)) == 0;
}

/// Explains why a mesh without boundary has one after the repair.
std::string why_opened(std::size_t split_edges, std::size_t removed_triangles) {
    if (split_edges > 0)
        return fmt::format(
            "{} three or more triangles, where parts touch or share a wall, and the parts were separated there; write "
            "them to separate files, or compare the volume after `fill-holes`",
            count_text(split_edges, "edge had", "edges had"));
    if (removed_triangles > 0)
        return fmt::format("{} removed that closed it; mesh the points again",
                           count_text(removed_triangles, "triangle was", "triangles were"));
    return "the surface is one-sided, such as a Klein bottle, and was cut; it encloses no volume; mesh the points "
           "again";
}

}  // namespace

RepairResult repair(const TriangleMesh& mesh, const RepairParams& params, Context& context) {
    require_usable(mesh, params);
    context.check_cancelled();
    const MeshTopology before = topology(mesh);
    const bool is_unchanged = is_sound(mesh, before, params, context);
    RepairResult result =
        is_unchanged ? RepairResult{.mesh = mesh, .was_closed = before.closed} : Repair(mesh, params, context).run();
    const MeshTopology after = is_unchanged ? before : topology(result.mesh);
    const std::size_t removed = mesh.triangles.size() - result.mesh.triangles.size();
    if (after.boundary_loops > 0 && result.was_closed)
        context.doubt(fmt::format("the mesh had no boundary, and has {} now: {}",
                                  count_text(after.boundary_loops, "boundary loop", "boundary loops"),
                                  why_opened(result.split_edges, removed)));
    context.metric("oriented", static_cast<double>(result.oriented));
    context.metric("stitched", static_cast<double>(result.stitched));
    context.metric("split-vertices", static_cast<double>(result.split_vertices));
    context.metric("split-edges", static_cast<double>(result.split_edges));
    context.metric("removed-triangles", static_cast<double>(removed));
    context.metric("removed-components", static_cast<double>(result.removed_components));
    context.metric("removed-points", static_cast<double>(result.unused_points));
    context.metric("flipped", static_cast<double>(result.flipped));
    context.metric("components", static_cast<double>(after.components));
    context.metric("boundary-loops", static_cast<double>(after.boundary_loops));
    context.progress(1);
    return result;
}

}  // namespace scanmill
