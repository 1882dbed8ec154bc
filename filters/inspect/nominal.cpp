// SPDX-License-Identifier: GPL-3.0-or-later
#include "inspect/nominal.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <optional>

#include "scanmill/base/disjoint_sets.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/geometry/distance/nearest_distances.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/spatial/angle.hpp"
#include "scanmill/geometry/spatial/triangle_distance.hpp"

namespace scanmill::inspecting {

using half_edges::after, half_edges::before;

namespace {

/// A direction whose cosine with a normal is at most this is level with the surface.
constexpr double level_cosine = 1e-9;
/// Largest error of a nearest point, as a share of the largest coordinate; a hundred times that of
/// nearest_on_triangle(). A nearest point that is this near an edge counts as on it. That is harmless: near an edge,
/// its normal gives the same sign as that of the face.
constexpr double foot_error = 0x1p-40;

constexpr double not_a_number = std::numeric_limits<double>::quiet_NaN();

/// The mesh with the lowest vertex at each position in place of the others, without triangles that then have a vertex
/// twice. `rows`: the original rows of the triangles.
TriangleMesh welded(const TriangleMesh& mesh, const Buffer<Vec3>& positions, Array<u32>& rows) {
    const Array<u32> lowest = lowest_at_position(positions.span());
    Array<Triangle> triangles;
    triangles.reserve(mesh.triangles.size());
    for (u32 row = 0; row < mesh.triangles.size(); ++row) {
        const auto& [a, b, c] = mesh.triangles[row];
        const Triangle triangle{lowest[a], lowest[b], lowest[c]};
        if (half_edges::has_repeated_vertex(triangle)) continue;
        triangles.push_back(triangle);
        rows.push_back(row);
    }
    Array<Edge> sharp;
    for (const auto& [a, b] : mesh.sharp_edges)
        if (lowest[a] != lowest[b]) sharp.push_back(make_edge(lowest[a], lowest[b]));
    std::ranges::sort(sharp);
    sharp.erase(std::ranges::unique(sharp).begin(), sharp.end());
    TriangleMesh surface;
    surface.frame = mesh.frame;
    surface.positions = positions;
    surface.triangles = std::move(triangles);
    surface.sharp_edges = std::move(sharp);
    return surface;
}

double largest_coordinate(const TriangleMesh& mesh) {
    const BoundingBox box = surface_box(mesh);
    return std::max(box.low.cwiseAbs().maxCoeff(), box.high.cwiseAbs().maxCoeff());
}

/// 1 or -1 for the side of a normal on which `way` leads; 0 if it is level.
int side_of(const Vec3& way, const Vec3& normal) {
    const double product = way.dot(normal), level = level_cosine * way.norm() * normal.norm();
    return product > level ? 1 : product < -level ? -1 : 0;
}

SignedDistance signed_distance_by(const Vec3& way, int side) {
    if (side == 0) return {not_a_number, Side::undecided};
    return {side * way.norm(), Side::decided};
}

SignedDistance beyond(SignedDistance distance) {
    distance.side = Side::beyond;
    return distance;
}

}  // namespace

Nominal::Nominal(const TriangleMesh& mesh, const Buffer<Vec3>& positions, unsigned threads)
    : surface_(welded(mesh, positions, rows_)),
      tree_(surface_.positions.span(), surface_.triangles.span(), threads),
      rounding_(position_rounding(largest_coordinate(surface_))),
      near_(foot_error * largest_coordinate(surface_)) {
    find_edges();
    normals_ = facet_normals(surface_, opposites_, threads).unit;
    find_vertex_kinds();
    find_vertex_normals();
}

void Nominal::find_edges() {
    const std::size_t half_edges = 3 * surface_.triangles.size();
    opposites_.assign(half_edges, half_edges::boundary);
    is_irregular_.assign(half_edges, u8(0));
    half_edges::for_each_edge(half_edges::by_smaller_vertex(surface_), [&](u32 smaller, auto edge) {
        const u32 first = edge[0].number;
        if (edge.size() == 1) {
            return;
        }
        const bool starts = half_edges::start(surface_, first) == smaller;
        if (edge.size() == 2 && starts != (half_edges::start(surface_, edge[1].number) == smaller)) {
            opposites_[first] = edge[1].number;
            opposites_[edge[1].number] = first;
            return;
        }
        for (const auto& half_edge : edge) is_irregular_[half_edge.number] = 1;
    });
}

void Nominal::find_vertex_kinds() {
    kinds_.assign(surface_.positions.size(), Kind::inner);
    DisjointSets fans(opposites_.size());  // of corners
    for (u32 half_edge = 0; half_edge < opposites_.size(); ++half_edge) {
        const u32 other = opposites_[half_edge];
        if (other != half_edges::boundary) {
            fans.unite(half_edge, after(other));
            continue;
        }
        for (const u32 vertex : {half_edges::start(surface_, half_edge), half_edges::end(surface_, half_edge)})
            if (is_irregular_[half_edge])
                kinds_[vertex] = Kind::irregular;
            else if (kinds_[vertex] == Kind::inner)
                kinds_[vertex] = Kind::border;
    }
    Array<u32> fan_of(surface_.positions.size(), half_edges::boundary);
    for (u32 corner = 0; corner < opposites_.size(); ++corner) {
        const u32 vertex = half_edges::start(surface_, corner), fan = fans.find(corner);
        if (fan_of[vertex] == half_edges::boundary)
            fan_of[vertex] = fan;
        else if (fan_of[vertex] != fan)
            kinds_[vertex] = Kind::irregular;
    }
    corners_ = Lists<u32>(surface_.positions.size(), [&](const auto& add) {
        for (u32 corner = 0; corner < opposites_.size(); ++corner)
            if (const u32 vertex = half_edges::start(surface_, corner); kinds_[vertex] != Kind::inner)
                add(vertex, corner);
    });
}

void Nominal::find_vertex_normals() {
    vertex_normals_.assign(surface_.positions.size(), Vec3(Vec3::Zero()));
    for (u32 row = 0; row < surface_.triangles.size(); ++row) {
        const auto& [a, b, c] = surface_.triangles[row];
        const Vec3 &p = surface_.positions[a], &q = surface_.positions[b], &r = surface_.positions[c];
        const auto [at_a, at_b] = angles_between(q - p, r - p, r - q, p - q);
        vertex_normals_[a] += at_a * normals_[row];
        vertex_normals_[b] += at_b * normals_[row];
        vertex_normals_[c] += angle_between(p - r, q - r) * normals_[row];
    }
}

bool Nominal::leads_across(const Vec3& way, u32 border) const {
    const Vec3 along =
        surface_.positions[half_edges::end(surface_, border)] - surface_.positions[half_edges::start(surface_, border)];
    const Vec3 outward = along.cross(normals_[border / 3]);
    return way.dot(outward) > (level_cosine * way.norm() + near_) * outward.norm();
}

SignedDistance Nominal::at_edge(const Vec3& way, u32 half_edge) const {
    const Vec3& normal = normals_[half_edge / 3];
    if (is_irregular_[half_edge]) {
        const u32 end = half_edges::end(surface_, half_edge);
        int side = 0;
        for (const u32 corner : corners_[half_edges::start(surface_, half_edge)]) {
            if (std::ranges::find(surface_.triangles[corner / 3], end) == surface_.triangles[corner / 3].end())
                continue;
            const int here = side_of(way, normals_[corner / 3]);
            if (here == -side && here != 0) return {not_a_number, Side::undecided};
            if (here != 0) side = here;
        }
        return signed_distance_by(way, side);
    }
    const u32 other = opposites_[half_edge];
    if (other != half_edges::boundary) return signed_distance_by(way, side_of(way, normal + normals_[other / 3]));
    const SignedDistance found = signed_distance_by(way, side_of(way, normal));
    return leads_across(way, half_edge) ? beyond(found) : found;
}

SignedDistance Nominal::at_vertex(const Vec3& way, u32 vertex) const {
    SignedDistance found = signed_distance_by(way, side_of(way, vertex_normals_[vertex]));
    if (kinds_[vertex] == Kind::inner) return found;
    if (kinds_[vertex] == Kind::irregular) {
        int side = 0;
        bool agree = true;
        for (const u32 corner : corners_[vertex]) {
            const int here = side_of(way, normals_[corner / 3]);
            if (here == -side && here != 0) agree = false;
            if (here != 0) side = here;
        }
        found = signed_distance_by(way, agree ? side : 0);
    }
    const auto crosses = [&](u32 half_edge) {
        return opposites_[half_edge] == half_edges::boundary && !is_irregular_[half_edge] &&
               leads_across(way, half_edge);
    };
    for (const u32 corner : corners_[vertex])
        if (crosses(corner) || crosses(before(corner))) return beyond(found);
    return found;
}

SignedDistance Nominal::signed_distance(const Vec3& point, u32 slot) const {
    const Vec3 foot = tree_.nearest_point(point, slot);
    const Vec3 way = point - foot;
    if (way.squaredNorm() <= rounding_ * rounding_) return {0, Side::decided};
    const u32 triangle = tree_.row(slot);
    const auto corner = [&](u32 i) -> const Vec3& { return surface_.positions[surface_.triangles[triangle][i % 3]]; };
    const auto is_foot = [&](const Vec3& other) { return (other - foot).squaredNorm() <= near_ * near_; };
    for (u32 i = 0; i < 3; ++i)
        if (is_foot(corner(i))) return at_vertex(way, surface_.triangles[triangle][i]);
    for (u32 i = 0; i < 3; ++i)
        if (is_foot(nearest_on_segment(foot, corner(i), corner(i + 1)))) return at_edge(way, 3 * triangle + i);
    return signed_distance_by(way, side_of(way, normals_[triangle]));
}

}  // namespace scanmill::inspecting
