// SPDX-License-Identifier: GPL-3.0-or-later
#include "scanmill/geometry/mesh/editable_mesh.hpp"

#include <algorithm>
#include <cassert>

#include "scanmill/base/error.hpp"

namespace scanmill {

namespace {

void require_proper_triangles(const TriangleMesh& mesh) {
    const auto repeated = [](const Triangle& t) { return half_edges::has_repeated_vertex(t); };
    const auto count = std::ranges::count_if(mesh.triangles, repeated);
    if (count == 0) return;
    const auto first = std::ranges::find_if(mesh.triangles, repeated) - mesh.triangles.begin();
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(first)];
    throw Error(
        "triangle {} has the vertices {}, {} and {}; a triangle needs three different vertices (such triangles: {})",
        first, t[0], t[1], t[2], count)
        .hint("remove triangles with a repeated vertex first, or mesh the points again with sculpt or region-grow");
}

}  // namespace

EditableMesh::EditableMesh(const TriangleMesh& mesh) : EditableMesh(mesh, half_edges::opposites(mesh)) {}

EditableMesh::EditableMesh(const TriangleMesh& mesh, Array<u32> opposite)
    : opposite_(std::move(opposite)),
      first_(mesh.positions.size(), none),
      triangles_(mesh.triangles.size()) {
    require_proper_triangles(mesh);
    corners_.reserve(3 * mesh.triangles.size());
    for (const Triangle& triangle : mesh.triangles) corners_.insert(corners_.end(), triangle.begin(), triangle.end());
    std::vector<u32> corners_at(mesh.positions.size(), 0);
    for (u32 half_edge = 0; half_edge < corners_.size(); ++half_edge) {
        const u32 vertex = corners_[half_edge];
        ++corners_at[vertex];
        if (first_[vertex] == none || is_boundary(half_edge)) first_[vertex] = half_edge;
    }
    std::size_t crowded = 0;
    u32 first_crowded = none;
    for (u32 vertex = 0; vertex < first_.size(); ++vertex) {
        if (first_[vertex] == none) continue;
        u32 corners = 0;
        for_each_around(vertex, [&](u32) { ++corners; });
        if (corners == corners_at[vertex]) continue;
        if (crowded++ == 0) first_crowded = vertex;
    }
    if (crowded > 0) {
        const Vec3 world = mesh.frame.origin + mesh.positions[first_crowded];
        throw Error(
            "the triangles at vertex {} ({:.9g}, {:.9g}, {:.9g}) form several fans; a surface has one fan at a vertex "
            "(such vertices: {})",
            first_crowded, world.x(), world.y(), world.z(), crowded)
            .hint("give each fan its own vertex, or mesh the points again with sculpt or region-grow");
    }
}

u32 EditableMesh::valence(u32 vertex) const {
    u32 edges = is_boundary_vertex(vertex) ? 1 : 0;
    for_each_around(vertex, [&](u32) { ++edges; });
    return edges;
}

bool EditableMesh::has_edge(u32 a, u32 b) const {
    if (!is_used(a)) return false;
    bool found = false;
    for_each_around(a, [&](u32 half_edge) { found |= end(half_edge) == b || apex(half_edge) == b; });
    return found;
}

void EditableMesh::set(u32 row, u32 a, u32 b, u32 c) {
    corners_[3 * row] = a;
    corners_[3 * row + 1] = b;
    corners_[3 * row + 2] = c;
}

void EditableMesh::link(u32 one, u32 other) {
    if (one != half_edges::boundary) opposite_[one] = other;
    if (other != half_edges::boundary) opposite_[other] = one;
}

bool EditableMesh::can_flip(u32 half_edge) const {
    if (is_boundary(half_edge)) return false;
    const u32 c = apex(half_edge), d = apex(opposite_[half_edge]);
    // If an end of the edge has too few edges for a flip, c and d are already connected.
    return c != d && !has_edge(c, d);
}

u32 EditableMesh::flip(u32 half_edge) {
    assert(can_flip(half_edge));
    const u32 other = opposite_[half_edge];
    const u32 a = start(half_edge), b = end(half_edge), c = apex(half_edge), d = apex(other);
    const u32 bc = opposite_[after(half_edge)], ca = opposite_[before(half_edge)];
    const u32 ad = opposite_[after(other)], db = opposite_[before(other)];
    // Corner i of the row is the start of half-edge i. So `half_edge` keeps its number; it now goes from d to c.
    const u32 h0 = half_edge, h1 = after(h0), h2 = before(h0), o0 = other, o1 = after(o0), o2 = before(o0);
    corners_[h0] = d, corners_[h1] = c, corners_[h2] = a;
    corners_[o0] = c, corners_[o1] = d, corners_[o2] = b;
    link(h1, ca);
    link(h2, ad);
    link(o1, db);
    link(o2, bc);
    link(h0, o0);
    // The flip gives the four outer half-edges of the two triangles other numbers.
    if (first_[a] == h0 || first_[a] == o1) first_[a] = h2;
    if (first_[b] == o0 || first_[b] == h1) first_[b] = o2;
    if (first_[c] == h2) first_[c] = h1;
    if (first_[d] == o2) first_[d] = o1;
    return other / 3;
}

void EditableMesh::ring(u32 vertex, std::vector<u32>& vertices) const {
    vertices.clear();
    u32 last = none;
    for_each_around(vertex, [&](u32 half_edge) {
        vertices.push_back(end(half_edge));
        last = half_edge;
    });
    if (is_boundary_vertex(vertex)) vertices.push_back(apex(last));
}

bool EditableMesh::can_remove(u32 vertex, std::span<const RingTriangle> triangulation) const {
    std::vector<u32> vertices;
    ring(vertex, vertices);
    const u32 size = static_cast<u32>(vertices.size());
    const bool is_open = is_boundary_vertex(vertex);
    if (triangulation.size() + 2 != size || triangulation.empty()) return false;
    for (const RingTriangle& t : triangulation)
        for (u32 i = 0; i < 3; ++i) {
            const u32 a = t[i], b = t[(i + 1) % 3];
            const bool in_ring = b == a + 1 || (!is_open && a == size - 1 && b == 0);
            if (!in_ring && has_edge(vertices[a], vertices[b])) return false;
        }
    // A closed ring of three vertices gets no new edge. But at a corner of a tetrahedron, the new triangle would be the
    // reverse of the triangle opposite the corner.
    if (is_open || size > 3) return true;
    const u32 begin = first_[vertex];
    const u32 outside = opposite_[after(begin)];
    return outside == half_edges::boundary || opposite_[after(next_around(begin))] / 3 != outside / 3;
}

void EditableMesh::remove(u32 vertex, std::span<const RingTriangle> triangulation, std::vector<u32>& new_rows) {
    const bool is_open = is_boundary_vertex(vertex);
    std::vector<u32> vertices;
    ring(vertex, vertices);
    const u32 size = static_cast<u32>(vertices.size());
    assert(triangulation.size() + 2 == size && !triangulation.empty());
    std::vector<bool> was_boundary_vertex(size);
    for (u32 i = 0; i < size; ++i) was_boundary_vertex[i] = is_boundary_vertex(vertices[i]);
    outside_.clear();
    rows_.clear();
    for_each_around(vertex, [&](u32 half_edge) {
        outside_.push_back(opposite_[after(half_edge)]);
        rows_.push_back(half_edge / 3);
    });
    std::ranges::sort(rows_);
    for (std::size_t i = triangulation.size(); i < rows_.size(); ++i) set(rows_[i], none, none, none);
    triangles_ -= rows_.size() - triangulation.size();

    by_ends_.assign(static_cast<std::size_t>(size) * size, none);
    for (std::size_t i = 0; i < triangulation.size(); ++i) {
        const RingTriangle& t = triangulation[i];
        const u32 row = rows_[i];
        set(row, vertices[t[0]], vertices[t[1]], vertices[t[2]]);
        for (u32 corner = 0; corner < 3; ++corner) by_ends_[t[corner] * size + t[(corner + 1) % 3]] = 3 * row + corner;
        new_rows.push_back(row);
    }
    for (u32 a = 0; a < size; ++a) {
        const bool is_last = a == size - 1;
        const u32 along = by_ends_[a * size + (is_last ? 0 : a + 1)];
        assert(along != none);
        link(along, is_last && is_open ? half_edges::boundary : outside_[a]);
        for (u32 b = a + 2; b < size; ++b)
            if (const u32 diagonal = by_ends_[a * size + b]; diagonal != none) link(diagonal, by_ends_[b * size + a]);
        // The first half-edge of a boundary vertex is `along`, or it is in a triangle outside the ring.
        if (is_boundary(along) || !was_boundary_vertex[a]) first_[vertices[a]] = along;
    }
    first_[vertex] = none;
}

Array<Triangle> EditableMesh::compact_triangles() const {
    Array<Triangle> result;
    result.reserve(triangles_);
    for (u32 row = 0; row < rows(); ++row)
        if (!is_empty(row)) result.push_back(triangle(row));
    return result;
}

}  // namespace scanmill
