// SPDX-License-Identifier: GPL-3.0-or-later
#include "inspect/on_nominal.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numeric>

#include "scanmill/base/parallel.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/spatial/cell_grid.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::inspecting {

namespace {

/// Triangles from which on a finer map would take longer than the comparison itself.
constexpr double most_triangles = 2e6;
constexpr double longer_step = 1.25;
/// Cosine of the largest angle between the normals of a foot and of a vertex.
constexpr double least_cosine = 0.5;
constexpr u32 none = ~u32(0);

/// One round of splitting: the midpoints of all long edges.
struct Midpoints {
    Array<u32> of_half_edge;  ///< the vertex at the middle, or none
    Array<Vec3> positions;  ///< where the new vertices are
    Array<Edge> sharp;
};

Midpoints midpoints_of(const TriangleMesh& mesh, double longest) {
    Midpoints found;
    found.of_half_edge.assign(3 * mesh.triangles.size(), none);
    const u32 first = static_cast<u32>(mesh.positions.size());
    auto sharp = mesh.sharp_edges.begin();
    half_edges::for_each_edge(half_edges::by_smaller_vertex(mesh), [&](u32 smaller, auto edge) {
        const Edge ends{smaller, edge[0].other};
        // Edges come in the order of the sharp edges.
        for (; sharp != mesh.sharp_edges.end() && *sharp < ends; ++sharp) found.sharp.push_back(*sharp);
        const bool is_sharp = sharp != mesh.sharp_edges.end() && *sharp == ends;
        const Vec3 &p = mesh.positions[ends[0]], &q = mesh.positions[ends[1]];
        if (!((p - q).squaredNorm() > longest * longest)) return;
        const u32 middle = first + static_cast<u32>(found.positions.size());
        found.positions.push_back((p + q) / 2);
        for (const auto& half_edge : edge) found.of_half_edge[half_edge.number] = middle;
        if (!is_sharp) return;
        ++sharp;
        found.sharp.push_back({ends[0], middle});
        found.sharp.push_back({ends[1], middle});
    });
    found.sharp.insert(found.sharp.end(), sharp, mesh.sharp_edges.end());
    std::ranges::sort(found.sharp);
    return found;
}

/// Calls add() with the triangles into which a triangle is split. `middles`: the middle of the edge after each corner,
/// or none.
template <class Add>
void split(const Triangle& corners, const Triangle& middles, std::span<const Vec3> positions, const Add& add) {
    const auto splits = std::ranges::count_if(middles, [](u32 middle) { return middle != none; });
    if (splits == 0) return add(corners);
    if (splits == 3) {
        for (u32 i = 0; i < 3; ++i) add({corners[i], middles[i], middles[(i + 2) % 3]});
        return add(middles);
    }
    u32 i = 0;  // the split edge after an edge that is not split
    while (middles[i] == none || middles[(i + 2) % 3] != none) ++i;
    const u32 a = corners[i], b = corners[(i + 1) % 3], c = corners[(i + 2) % 3];
    const u32 ab = middles[i], bc = middles[(i + 1) % 3];
    if (splits == 1) {
        add({a, ab, c});
        return add({ab, b, c});
    }
    add({ab, b, bc});
    // The quadrilateral a, ab, bc, c is cut along its shorter diagonal.
    if ((positions[ab] - positions[c]).squaredNorm() <= (positions[a] - positions[bc]).squaredNorm()) {
        add({a, ab, c});
        add({ab, bc, c});
    } else {
        add({a, ab, bc});
        add({a, bc, c});
    }
}

/// The triangles of the given mesh at each vertex, each once.
Lists<u32> parents_at(const RefinedMesh& refined) {
    const std::size_t vertices = refined.mesh.positions.size();
    return Lists<u32>(vertices, [&](const auto& add) {
        Array<u32> last(vertices, none);  // parents are ascending
        for (std::size_t t = 0; t < refined.parents.size(); ++t)
            for (const u32 vertex : refined.mesh.triangles[t]) {
                if (last[vertex] == refined.parents[t]) continue;
                add(vertex, refined.parents[t]);
                last[vertex] = refined.parents[t];
            }
    });
}

}  // namespace

RefinedMesh refined(const TriangleMesh& mesh, double longest, const Execution& execution) {
    assert(longest > 0);
    RefinedMesh result;
    result.mesh.frame = mesh.frame;
    result.mesh.positions = mesh.positions;
    result.mesh.triangles = mesh.triangles;
    result.mesh.sharp_edges = mesh.sharp_edges;
    result.parents.resize(mesh.triangles.size());
    std::iota(result.parents.begin(), result.parents.end(), u32(0));
    while (true) {
        execution.check_cancelled();
        Midpoints middles = midpoints_of(result.mesh, longest);
        if (middles.positions.empty()) return result;
        Array<Vec3> positions(result.mesh.positions.begin(), result.mesh.positions.end());
        positions.insert(positions.end(), middles.positions.begin(), middles.positions.end());
        Array<Triangle> triangles;
        Array<u32> parents;
        for (u32 t = 0; t < result.mesh.triangles.size(); ++t) {
            const u32* of_edges = &middles.of_half_edge[3 * t];
            split(result.mesh.triangles[t], {of_edges[0], of_edges[1], of_edges[2]}, positions,
                  [&](const Triangle& triangle) {
                      triangles.push_back(triangle);
                      parents.push_back(result.parents[t]);
                  });
        }
        result.mesh.positions = std::move(positions);
        result.mesh.triangles = std::move(triangles);
        result.mesh.sharp_edges = std::move(middles.sharp);
        result.parents = std::move(parents);
    }
}

double affordable_edge(const TriangleMesh& mesh, double wanted) {
    struct Size {
        double longest, height;
    };
    Array<Size> sizes;
    double longest_of_all = 0;
    for (const auto& [a, b, c] : mesh.triangles) {
        const Vec3 &p = mesh.positions[a], &q = mesh.positions[b], &r = mesh.positions[c];
        const double longest =
            std::sqrt(std::max({(q - p).squaredNorm(), (r - q).squaredNorm(), (p - r).squaredNorm()}));
        sizes.push_back({longest, longest > 0 ? area_vector(p, q, r).norm() / longest : 0});
        longest_of_all = std::max(longest_of_all, longest);
    }
    const auto triangles_with = [&](double edge) {
        double sum = 0;
        // Halving makes edges between half of `edge` and `edge`, so there are about three triangles in its square.
        for (const Size& size : sizes)
            sum += size.longest <= edge ? 1 : 3 * (size.longest / edge) * std::max(1.0, size.height / edge);
        return sum;
    };
    double edge = wanted;
    while (edge < longest_of_all && triangles_with(edge) > most_triangles) edge *= longer_step;
    return edge;
}

Array<double> averaged(const RefinedMesh& refined, std::span<const Vec3> positions, const Nominal& nominal,
                       const Footprints& footprints, double radius, const Execution& execution) {
    Array<double> means(positions.size(), std::numeric_limits<double>::quiet_NaN());
    if (footprints.feet.empty()) return means;
    BoundingBox box = bounding_box(footprints.feet);
    for (const Vec3& position : positions) box.add(position);
    CellGrid grid(box, radius);
    Array<u32> cell_of(footprints.feet.size());
    u32 cells = 0;
    for (std::size_t i = 0; i < cell_of.size(); ++i) {
        cell_of[i] = grid.enter(footprints.feet[i]);
        cells = std::max(cells, cell_of[i] + 1);
    }
    const Lists<u32> in_cell(cells, [&](const auto& add) {
        for (u32 i = 0; i < cell_of.size(); ++i) add(cell_of[i], i);
    });
    Array<u32> surface_row(refined.parents.empty() ? 0 : refined.parents.back() + 1, none);
    for (u32 row = 0; row < nominal.rows().size(); ++row) surface_row[nominal.rows()[row]] = row;
    const Lists<u32> parents = parents_at(refined);
    const auto is_on_side = [&](u32 vertex, const Vec3& normal) {
        return std::ranges::any_of(parents[vertex], [&](u32 parent) {
            return surface_row[parent] != none && nominal.normals()[surface_row[parent]].dot(normal) >= least_cosine;
        });
    };
    for_each_chunk(execution.threads(), positions.size(), 1 << 10, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            if (parents[vertex].empty()) continue;
            double sum = 0, weights = 0;
            grid.any_near(positions[vertex], [&](u32 cell) {
                for (const u32 i : in_cell[cell]) {
                    const double weight =
                        1 - (footprints.feet[i] - positions[vertex]).squaredNorm() / (radius * radius);
                    if (!(weight > 0) ||
                        !is_on_side(static_cast<u32>(vertex), nominal.normals()[footprints.triangles[i]]))
                        continue;
                    sum += weight * footprints.deviations[i];
                    weights += weight;
                }
                return false;
            });
            if (weights > 0) means[vertex] = sum / weights;
        }
    });
    return means;
}

}  // namespace scanmill::inspecting
