// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/tets/voronoi.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/base/elementary.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr std::size_t chunk = 1 << 13;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// Outward normals of the hull's facets, summed by vertex; zero at other vertices.
Array<Vec3> hull_directions(const TetMesh& tets) {
    Array<Vec3> sums(tets.positions.size(), Vec3::Zero());
    for (u32 cell = 0; cell < tets.cells.size(); ++cell)
        for (std::size_t corner = 0; corner < 4; ++corner) {
            if (tets.neighbours[cell][corner] != TetMesh::outside_hull) continue;
            Triangle facet;
            for (std::size_t k = 0; k < 3; ++k)
                facet[k] = tets.cells[cell][static_cast<std::size_t>(outward_facet[corner][k])];
            const Vec3 normal = area_vector(tets.positions, facet).normalized();
            for (const u32 vertex : facet) sums[vertex] += normal;
        }
    return sums;
}

}  // namespace

VoronoiEdge dual_edge(const TetMesh& tets, std::span<const Vec3> centres, u32 cell, int corner) {
    const auto& [i, j, k] = outward_facet[static_cast<std::size_t>(corner)];
    const Tetrahedron& corners = tets.cells[cell];
    const Vec3& a = tets.positions[corners[i]];
    const Vec3 u = tets.positions[corners[j]] - a, v = tets.positions[corners[k]] - a, normal = u.cross(v);
    const double squared = normal.squaredNorm();
    VoronoiEdge edge;
    if (squared == 0) return {centres[cell], Vec3::Zero(), 0, 0};
    edge.foot = a + (v.squaredNorm() * normal.cross(u) + u.squaredNorm() * v.cross(normal)) / (2 * squared);
    edge.normal = normal / std::sqrt(squared);
    edge.from = (centres[cell] - edge.foot).dot(edge.normal);
    const u32 across = tets.neighbours[cell][static_cast<std::size_t>(corner)];
    edge.to = across == TetMesh::outside_hull ? infinity : (centres[across] - edge.foot).dot(edge.normal);
    if (edge.to < edge.from) edge.from = edge.to = edge.from + (edge.to - edge.from) / 2;  // by rounding
    return edge;
}

Poles poles(const TetMesh& tets, std::span<const Vec3> centres, const VertexCells& cells_at, Execution& execution) {
    Poles result;
    const std::size_t count = tets.positions.size();
    result.directions = hull_directions(tets);
    result.heights.resize(count);
    for_each_chunk(execution.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t vertex = begin; vertex < end; ++vertex) {
            const Vec3& p = tets.positions[vertex];
            Vec3& direction = result.directions[vertex];
            const auto farthest = [&](auto&& accepts) {
                double most = -1;
                u32 best = TetMesh::outside_hull;
                for (const u32 cell : cells_at[vertex]) {
                    const Vec3 to = centres[cell] - p;
                    const double squared = to.squaredNorm();
                    if ((squared > most || (squared == most && cell < best)) && accepts(to)) {
                        most = squared;
                        best = cell;
                    }
                }
                return best;
            };
            double height = infinity;
            if (direction.squaredNorm() == 0) {
                const u32 pole = farthest([](const Vec3&) { return true; });
                if (pole != TetMesh::outside_hull) {
                    direction = centres[pole] - p;
                    height = direction.norm();
                }
            }
            if (direction.squaredNorm() > 0) direction.normalize();
            const u32 opposite = farthest([&](const Vec3& to) { return to.dot(direction) < 0; });
            if (opposite != TetMesh::outside_hull) height = std::min(height, (centres[opposite] - p).norm());
            result.heights[vertex] = height;
        }
    });
    return result;
}

bool Cocone::meets(const VoronoiEdge& edge) const {
    const auto side_at = [&](double t) {
        return side(std::isinf(t) ? edge.normal : Vec3(edge.foot - apex + t * edge.normal));
    };
    const int from = side_at(edge.from);
    return from == 0 || from != side_at(edge.to);
}

double Cocone::squared_reach(const VoronoiEdge& edge) const {
    // The offset to the foot is perpendicular to the normal, so the result keeps its digits even if the ends of the
    // edge are circumcentres of flat cells, far away.
    const Vec3 to_foot = edge.foot - apex;
    const double tilt = edge.normal.dot(axis), height = to_foot.dot(axis), t = -height / tilt;
    return tilt != 0 && t >= edge.from && t <= edge.to ? to_foot.squaredNorm() + t * t : -1;
}

Array<std::uint16_t> cocone_hits(const TetMesh& tets, std::span<const Vec3> centres, const Poles& poles,
                                 double cone_angle, Execution& execution) {
    const std::size_t count = tets.cells.size();
    const double sine = elementary::turn_of(cone_angle).sine;
    const auto cocone_of = [&](u32 vertex) {
        return Cocone{tets.positions[vertex], poles.directions[vertex], sine * sine};
    };
    // By cell, two bits per corner: the side on which the corner's cocone has the cell's circumcentre, plus 1.
    Array<u8> sides(count);
    for_each_chunk(execution.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t cell = begin; cell < end; ++cell) {
            unsigned bits = 0;
            for (unsigned j = 0; j < 4; ++j) {
                const Cocone cocone = cocone_of(tets.cells[cell][j]);
                bits |= static_cast<unsigned>(cocone.side(centres[cell] - cocone.apex) + 1) << 2 * j;
            }
            sides[cell] = static_cast<u8>(bits);
        }
    });
    Array<std::uint16_t> hits(count);
    for_each_chunk(execution.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t c = begin; c < end; ++c) {
            const u32 cell = static_cast<u32>(c);
            unsigned bits = 0;
            for (unsigned i = 0; i < 4; ++i) {
                const u32 across = tets.neighbours[cell][i];
                const bool at_hull = across == TetMesh::outside_hull;
                const Vec3 ray = at_hull ? dual_edge(tets, centres, cell, static_cast<int>(i)).normal : Vec3();
                for (unsigned j = 0; j < 4; ++j) {
                    if (j == i) continue;
                    const u32 vertex = tets.cells[cell][j];
                    const int here = static_cast<int>(sides[cell] >> 2 * j & 3) - 1;
                    int there = 0;
                    if (at_hull) {
                        there = cocone_of(vertex).side(ray);
                    } else {
                        const Tetrahedron& its = tets.cells[across];
                        const int k = its[0] == vertex ? 0 : its[1] == vertex ? 1 : its[2] == vertex ? 2 : 3;
                        there = static_cast<int>(sides[across] >> 2 * k & 3) - 1;
                    }
                    bits |= unsigned(here == 0 || here != there) << (4 * i + j);
                }
            }
            hits[cell] = static_cast<std::uint16_t>(bits);
        }
    });
    return hits;
}

}  // namespace scanmill
