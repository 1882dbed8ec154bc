// SPDX-License-Identifier: GPL-3.0-or-later
#include "measure/borders.hpp"

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/mesh/half_edges.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill::measuring {

namespace {

/// Where the mesh ends.
struct Borders {
    Array<u8> has_side;    ///< by number of the side
    Array<u8> has_vertex;  ///< by vertex

    explicit Borders(const TriangleMesh& mesh)
        : has_side(3 * mesh.triangles.size(), u8(0)),
          has_vertex(mesh.positions.size(), u8(0)) {
        const sides::SidesOfVertices all = sides::sides_of_vertices(mesh);
        for (std::size_t vertex = 0; vertex + 1 < all.begin.size(); ++vertex)
            for (u32 i = all.begin[vertex]; i < all.begin[vertex + 1]; ++i) {
                const u32 other = all.sides[i].other;
                const bool is_like_previous = i > all.begin[vertex] && all.sides[i - 1].other == other;
                const bool is_like_next = i + 1 < all.begin[vertex + 1] && all.sides[i + 1].other == other;
                if (is_like_previous || is_like_next) continue;
                has_side[all.sides[i].number] = 1;
                has_vertex[vertex] = has_vertex[other] = 1;
            }
    }
};

bool is_on_border(const Borders& borders, const TriangleMesh& mesh, const Vec3& point, u32 row, double rounding) {
    const Triangle& triangle = mesh.triangles[row];
    const auto corner = [&](u32 i) -> const Vec3& { return mesh.positions[triangle[i % 3]]; };
    const Vec3 foot = nearest_on_triangle(point, corner(0), corner(1), corner(2));
    const auto is_there = [&](const Vec3& place) { return (place - foot).squaredNorm() <= rounding * rounding; };
    for (u32 i = 0; i < 3; ++i) {
        if (borders.has_vertex[triangle[i]] && is_there(corner(i))) return true;
        if (borders.has_side[3 * row + i] && is_there(nearest_on_segment(foot, corner(i), corner(i + 1)))) return true;
    }
    return false;
}

}  // namespace

std::size_t leave_out_borders(NearestDistances& nearest, std::span<const Vec3> points, const TriangleMesh& mesh,
                              double rounding) {
    const Borders borders(mesh);
    std::size_t kept = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
        if (is_on_border(borders, mesh, points[i], nearest.triangles[i], rounding)) continue;
        nearest.distances[kept] = nearest.distances[i];
        nearest.triangles[kept] = nearest.triangles[i];
        ++kept;
    }
    if (kept == 0)
        throw Error("{} nearest to a border of the mesh; none is left to measure it by",
                    points.size() == 1 ? "the only point of the truth is"
                                       : fmt::format("all {} points of the truth are", points.size()))
            .hint("say borders: include");
    nearest.distances.resize(kept);
    nearest.triangles.resize(kept);
    return points.size() - kept;
}

}  // namespace scanmill::measuring
