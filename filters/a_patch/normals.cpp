// SPDX-License-Identifier: GPL-3.0-or-later
#include "a_patch/normals.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/fit/quadric.hpp"
#include "scanmill/geometry/spatial/point_tree.hpp"

namespace scanmill::a_patches {

namespace {

constexpr std::size_t neighbours = 25, chunk = 256;
constexpr double same_cosine = 0.99999;  // 0.26 degrees

/// Any unit vector perpendicular to a unit vector.
Vec3 perpendicular(const Vec3& n) {
    Eigen::Index least;
    n.cwiseAbs().minCoeff(&least);
    return n.cross(Vec3::Unit(least)).normalized();
}

/// The normal at `point` of the quadric through it that fits the others; that of their plane if there is none.
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

}  // namespace

std::vector<Vec3> mesh_normals(const TriangleMesh& mesh) {
    std::vector<Vec3> sums(mesh.positions.size(), Vec3::Zero());
    for (const Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const Vec3& p = mesh.positions[t[i]];
            const Vec3 u = mesh.positions[t[(i + 1) % 3]] - p, v = mesh.positions[t[(i + 2) % 3]] - p;
            sums[t[i]] += u.cross(v) / (u.squaredNorm() * v.squaredNorm());
        }
    for (Vec3& sum : sums) sum.normalize();  // leaves zero as it is
    return sums;
}

std::vector<Vec3> point_normals(const TriangleMesh& mesh, std::span<const Vec3> points, std::span<const Vec3> outwards,
                                Execution& execution) {
    std::vector<Vec3> all(mesh.positions.begin(), mesh.positions.end());
    all.insert(all.end(), points.begin(), points.end());
    const PointTree tree(all, execution.threads());
    std::vector<Vec3> normals(mesh.positions.size());
    for_each_chunk(execution.threads(), normals.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        NeighbourBuffer buffer;
        std::vector<Vec3> near;
        for (std::size_t v = begin; v < end; ++v) {
            near.clear();
            for (const Neighbour& neighbour : tree.nearest(tree.index_of_row()[v], neighbours, buffer))
                near.push_back(tree.positions()[neighbour.index]);
            normals[v] = normal_at(mesh.positions[v], near);
            if (normals[v].dot(outwards[v]) < 0) normals[v] = -normals[v];
        }
    });
    return normals;
}

GivenNormals given_normals(const TriangleMesh& mesh) {
    const Column* column = mesh.face_columns.find("corner-normals");
    if (!column)
        throw Error("normals is given, but the mesh has no face column 'corner-normals'")
            .hint("'decimate' computes it; 'normals: mesh' needs none");
    constexpr u32 components = 9;
    if (column->components() != components)
        throw Error("the face column 'corner-normals' has {} numbers per triangle; 9 are needed", column->components());
    GivenNormals result{std::vector<Vec3>(mesh.positions.size(), Vec3::Zero()), 0};
    std::vector<Vec3> first(mesh.positions.size(), Vec3::Zero());
    std::vector<bool> differs(mesh.positions.size(), false);
    std::size_t invalid = 0, first_invalid = 0;
    for (std::size_t f = 0; f < mesh.triangles.size(); ++f)
        for (u32 i = 0; i < 3; ++i) {
            const u32 v = mesh.triangles[f][i];
            const Vec3 n(column->number(f, 3 * i), column->number(f, 3 * i + 1), column->number(f, 3 * i + 2));
            if (!n.allFinite()) {
                if (invalid++ == 0) first_invalid = f;
                continue;
            }
            if (n == Vec3::Zero()) continue;
            const Vec3 unit = n.normalized();
            if (first[v] == Vec3::Zero()) first[v] = unit;
            if (first[v].dot(unit) < same_cosine) differs[v] = true;
            result.normals[v] += unit;
        }
    if (invalid > 0)
        throw Error("{} of {} corner normals are NaN or infinite, the first at triangle {}", invalid,
                    3 * mesh.triangles.size(), first_invalid)
            .hint("'normals: mesh' computes normals anew");
    for (Vec3& n : result.normals) n.normalize();
    result.several = static_cast<std::size_t>(std::ranges::count(differs, true));
    return result;
}

Vec3 most_normal(std::span<const Vec3> normals) {
    Vec3 best = normals[0];
    double greatest = -2;
    const auto offer = [&](const Vec3& direction) {
        const double length = direction.norm();
        if (!(length > 0)) return;
        const Vec3 unit = direction / length;
        double least = 1;
        for (const Vec3& n : normals) least = std::min(least, n.dot(unit));
        if (least > greatest) {
            greatest = least;
            best = unit;
        }
    };
    // The smallest cap around the normals has one, two or three of them on its border.
    for (std::size_t i = 0; i < normals.size(); ++i) {
        offer(normals[i]);
        for (std::size_t j = 0; j < i; ++j) {
            offer(normals[i] + normals[j]);
            for (std::size_t k = 0; k < j; ++k) {
                const Vec3 centre = (normals[i] - normals[j]).cross(normals[j] - normals[k]);
                offer(centre);
                offer(-centre);
            }
        }
    }
    return best;
}

}  // namespace scanmill::a_patches
