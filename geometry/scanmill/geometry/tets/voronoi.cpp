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

/// f(t) = ((y - apex)·axis)² - sin² |y - apex|² for y = foot + t normal, as c + 2 b t + a t². The cocone is f ≤ 0. The
/// offset from the apex to the foot is perpendicular to the normal, so f keeps its digits near the apex even if the
/// ends of the edge are circumcentres of flat cells, far away.
struct ConeFunction {
    double a, b, c;

    ConeFunction(const Cocone& cocone, const VoronoiEdge& edge) {
        const Vec3 to_foot = edge.foot - cocone.apex;
        const double tilt = edge.normal.dot(cocone.axis), height = to_foot.dot(cocone.axis);
        a = tilt * tilt - cocone.squared_sine;
        b = tilt * height;
        c = height * height - cocone.squared_sine * to_foot.squaredNorm();
    }
    double at(double t) const { return (a * t + 2 * b) * t + c; }
    bool is_inside(double t) const {
        return std::isinf(t) ? a < 0 || (a == 0 && b < 0) : at(t) <= 0;  // only `to` is infinite
    }
};

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
    const ConeFunction f(*this, edge);
    if (f.is_inside(edge.from) || f.is_inside(edge.to)) return true;
    if (!(f.a > 0)) return false;
    const double lowest = -f.b / f.a;
    return lowest > edge.from && lowest < edge.to && f.c + f.b * lowest <= 0;
}

double Cocone::squared_reach(const VoronoiEdge& edge) const {
    const Vec3 to_foot = edge.foot - apex;
    const double tilt = edge.normal.dot(axis), height = to_foot.dot(axis), t = -height / tilt;
    return tilt != 0 && t >= edge.from && t <= edge.to ? to_foot.squaredNorm() + t * t : -1;
}

Array<std::uint16_t> cocone_hits(const TetMesh& tets, std::span<const Vec3> centres, const Poles& poles,
                                 double cone_angle, Execution& execution) {
    const std::size_t count = tets.cells.size();
    const double sine = elementary::turn_of(cone_angle).sine, squared_sine = sine * sine;
    Array<std::uint16_t> hits(count);
    for_each_chunk(execution.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t c = begin; c < end; ++c) {
            const u32 cell = static_cast<u32>(c);
            unsigned bits = 0;
            for (int i = 0; i < 4; ++i) {
                if (!owns_facet(tets, cell, i)) continue;
                const VoronoiEdge edge = dual_edge(tets, centres, cell, i);
                for (int j = 0; j < 4; ++j) {
                    if (j == i) continue;
                    const u32 vertex = tets.cells[cell][static_cast<std::size_t>(j)];
                    const Cocone cocone{tets.positions[vertex], poles.directions[vertex], squared_sine};
                    bits |= unsigned(cocone.meets(edge)) << (4 * i + j);
                }
            }
            hits[cell] = static_cast<std::uint16_t>(bits);
        }
    });
    // The other cell of each facet gets the same bits.
    Array<std::uint16_t> own = hits;
    for_each_chunk(execution.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        for (std::size_t c = begin; c < end; ++c) {
            const u32 cell = static_cast<u32>(c);
            unsigned bits = own[cell];
            for (int i = 0; i < 4; ++i) {
                if (owns_facet(tets, cell, i)) continue;
                const u32 across = tets.neighbours[cell][static_cast<std::size_t>(i)];
                const int back = corner_across(tets, cell, i);
                for (int j = 0; j < 4; ++j) {
                    const u32 vertex = tets.cells[cell][static_cast<std::size_t>(j)];
                    if (j == i) continue;
                    const Tetrahedron& corners = tets.cells[across];
                    const int its = corners[0] == vertex ? 0 : corners[1] == vertex ? 1 : corners[2] == vertex ? 2 : 3;
                    bits |= (unsigned(own[across]) >> (4 * back + its) & 1u) << (4 * i + j);
                }
            }
            hits[cell] = static_cast<std::uint16_t>(bits);
        }
    });
    return hits;
}

}  // namespace scanmill
