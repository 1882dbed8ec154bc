// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numeric>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/fit/quadric.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill::a_patches {

namespace {

constexpr std::size_t neighbours = 25, chunk = 256;
constexpr std::size_t most_candidates = 100, least_neighbours = 6;  // at sharp edges
constexpr double same_cosine = 0.99999;  // 0.26 degrees
constexpr double rounding = 1e-14;  // of cosines

/// The normal at `point` of a quadric through it that is fitted to the others. If there is no such quadric, the normal
/// of their plane.
Vec3 normal_at(const Vec3& point, std::span<const Vec3> others) {
    std::vector<Vec3> relative{Vec3::Zero()};
    for (const Vec3& p : others) relative.push_back(p - point);
    const Vec3 n = scatter_of(relative).normal, x = perpendicular(n), y = n.cross(x);
    double spread = 0;
    for (const Vec3& p : relative) spread += (p - n * n.dot(p)).squaredNorm() / static_cast<double>(others.size());
    if (!(spread > 0)) return n;
    std::vector<QuadricSample> samples;
    for (const Vec3& p : std::span(relative).subspan(1)) {
        const double u = p.dot(x), v = p.dot(y);
        samples.push_back({u, v, p.dot(n), 1 / (u * u + v * v + spread)});
    }
    const std::optional<Quadric> quadric = fit_quadric(samples);
    return quadric ? Vec3((n - quadric->d * x - quadric->e * y).normalized()) : n;
}

/// See most_normal(). The smallest cap that contains all normals has one, two or three of them on its border, so all
/// such caps are tried.
Vec3 most_normal_of_few(std::span<const Vec3> normals) {
    Vec3 best = normals[0];
    double greatest = -2;
    const auto offer = [&](const Vec3& direction) {
        const double length = direction.norm();
        if (!(length > 0)) return;
        const Vec3 unit = direction / length;
        double least = 1;
        for (const Vec3& n : normals) {
            least = std::min(least, n.dot(unit));
            if (least <= greatest) return;
        }
        greatest = least;
        best = unit;
    };
    for (std::size_t i = 0; i < normals.size(); ++i) {
        offer(normals[i]);
        for (std::size_t j = 0; j < i; ++j) {
            const Vec3 sum = normals[i] + normals[j];
            offer(sum.norm() > rounding ? sum : perpendicular(normals[i]));
            for (std::size_t k = 0; k < j; ++k) {
                const Vec3 centre = (normals[i] - normals[j]).cross(normals[j] - normals[k]);
                offer(centre);
                offer(-centre);
            }
        }
    }
    return best;
}

}  // namespace

Sectors sectors_of(const TriangleMesh& mesh) {
    const Array<u32> opposites = half_edges::opposites(mesh);
    const std::span sharp = mesh.sharp_edges.span();
    const std::size_t corners = opposites.size();
    std::vector<bool> is_at_sharp(mesh.positions.size(), false);
    for (const Edge& edge : sharp)
        for (const u32 v : edge) is_at_sharp[v] = true;
    DisjointSets sets(corners);
    for (u32 half = 0; half < corners; ++half) {
        const u32 other = opposites[half];
        if (other == half_edges::boundary || other < half) continue;
        const u32 a = half_edges::start(mesh, half), b = half_edges::end(mesh, half);
        if (is_at_sharp[a] && is_at_sharp[b] && std::ranges::binary_search(sharp, make_edge(a, b))) continue;
        for (const auto& [one, second] :
             {std::pair(half, half_edges::after(other)), std::pair(half_edges::after(half), other)})
            sets.unite(one, second);
    }
    Sectors sectors;
    sectors.of_corner.resize(corners / 3);
    for (u32 corner = 0; corner < corners; ++corner) {
        const u32 first = sets.find(corner);
        if (first == corner) {
            sectors.of_corner[corner / 3][corner % 3] = static_cast<u32>(sectors.size());
            sectors.vertex.push_back(half_edges::start(mesh, corner));
            sectors.is_whole.push_back(!is_at_sharp[sectors.vertex.back()]);
        } else {
            sectors.of_corner[corner / 3][corner % 3] = sectors.of_corner[first / 3][first % 3];
        }
    }
    return sectors;
}

std::vector<std::vector<u32>> corners_of(const Sectors& sectors) {
    std::vector<std::vector<u32>> corners(sectors.size());
    for (u32 f = 0; f < sectors.of_corner.size(); ++f)
        for (u32 i = 0; i < 3; ++i) corners[sectors.of_corner[f][i]].push_back(3 * f + i);
    return corners;
}

CornerNormals at_corners(const Sectors& sectors, std::span<const Vec3> normals) {
    CornerNormals result(sectors.of_corner.size());
    for (std::size_t f = 0; f < result.size(); ++f)
        for (std::size_t i = 0; i < 3; ++i) result[f][i] = normals[sectors.of_corner[f][i]];
    return result;
}

std::vector<Vec3> mesh_normals(const TriangleMesh& mesh, const Sectors& sectors) {
    std::vector<Vec3> sums(sectors.size(), Vec3::Zero());
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f) {
        const Triangle& t = mesh.triangles[f];
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& p = mesh.positions[t[i]];
            const Vec3 u = mesh.positions[t[(i + 1) % 3]] - p, v = mesh.positions[t[(i + 2) % 3]] - p;
            sums[sectors.of_corner[f][i]] += u.cross(v) / (u.squaredNorm() * v.squaredNorm());
        }
    }
    for (Vec3& sum : sums) sum.normalize();  // leaves zero as it is
    return sums;
}

std::vector<Vec3> point_normals(const TriangleMesh& mesh, const Sectors& sectors, std::span<const Vec3> points,
                                std::span<const Vec3> outwards, Execution& execution) {
    std::vector<Vec3> all(mesh.positions.begin(), mesh.positions.end());
    all.insert(all.end(), points.begin(), points.end());
    const PointTree tree(all, execution.threads());
    const TriangleTree triangles(mesh.positions.span(), mesh.triangles.span(), execution.threads());
    const std::vector<std::vector<u32>> corners = corners_of(sectors);
    std::vector<Vec3> normals(sectors.size());
    for_each_chunk(execution.threads(), normals.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        NeighbourBuffer buffer;
        std::vector<Vec3> near;
        for (std::size_t s = begin; s < end; ++s) {
            const u32 v = sectors.vertex[s];
            const std::size_t candidates = sectors.is_whole[s] ? neighbours : most_candidates;
            near.clear();
            for (const Neighbour& neighbour : tree.nearest(tree.index_of_row()[v], candidates, buffer)) {
                const Vec3& p = tree.positions()[neighbour.index];
                if (!sectors.is_whole[s]) {
                    const u32 nearest = triangles.nearest(p).triangle;
                    if (std::ranges::none_of(corners[s], [&](u32 corner) { return corner / 3 == nearest; })) continue;
                }
                near.push_back(p);
                if (near.size() == neighbours) break;
            }
            if (!sectors.is_whole[s] && near.size() < least_neighbours) {
                normals[s] = outwards[s];
                continue;
            }
            normals[s] = normal_at(mesh.positions[v], near);
            if (normals[s].dot(outwards[s]) < 0) normals[s] = -normals[s];
        }
    });
    return normals;
}

GivenNormals given_normals(const TriangleMesh& mesh, const Sectors& sectors) {
    const Column* column = mesh.face_columns.find("corner-normals");
    if (!column)
        throw Error("`normals: given` needs the face column 'corner-normals'; the mesh has none")
            .hint("'decimate' computes this column; 'normals: mesh' does not need it");
    constexpr u32 components = 9;
    if (column->components() != components)
        throw Error("the face column 'corner-normals' has {} numbers per triangle; 9 are needed", column->components())
            .hint("'decimate' computes them, three per corner; 'normals: mesh' does not need the column");
    GivenNormals result{std::vector<Vec3>(sectors.size(), Vec3::Zero()), 0};
    std::vector<Vec3> first(sectors.size(), Vec3::Zero());
    std::vector<bool> differs(sectors.size(), false);
    std::size_t invalid = 0, first_invalid = 0;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        for (u32 i = 0; i < 3; ++i) {
            const u32 sector = sectors.of_corner[f][i];
            const Vec3 n(column->number(f, 3 * i), column->number(f, 3 * i + 1), column->number(f, 3 * i + 2));
            if (!n.allFinite()) {
                if (invalid++ == 0) first_invalid = f;
                continue;
            }
            if (n == Vec3::Zero()) continue;
            const Vec3 unit = n.normalized();
            if (first[sector] == Vec3::Zero()) first[sector] = unit;
            if (first[sector].dot(unit) < same_cosine) differs[sector] = true;
            result.normals[sector] += unit;
        }
    if (invalid > 0)
        throw Error("{} of {} corner normals are NaN or infinite, the first at triangle {}", invalid,
                    3 * mesh.triangles.size(), first_invalid)
            .hint("'normals: mesh' computes the normals from the triangles");
    for (Vec3& n : result.normals) n.normalize();
    result.several = static_cast<std::size_t>(std::ranges::count(differs, true));
    return result;
}

Vec3 most_normal(std::span<const Vec3> normals) {
    // Finds the direction of a few normals, and adds the farthest other normal until none is farther.
    std::vector<std::size_t> few{0};
    for (;;) {
        std::vector<Vec3> chosen;
        for (const std::size_t i : few) chosen.push_back(normals[i]);
        const Vec3 direction = most_normal_of_few(chosen);
        const auto cosine = [&](const Vec3& n) { return n.dot(direction); };
        const double least = cosine(*std::ranges::min_element(chosen, {}, cosine));
        const auto farthest = std::ranges::min_element(normals, {}, cosine);
        if (cosine(*farthest) >= least - rounding) return direction;
        const auto number = static_cast<std::size_t>(farthest - normals.begin());
        few.insert(std::ranges::lower_bound(few, number), number);
    }
}

}  // namespace scanmill::a_patches
