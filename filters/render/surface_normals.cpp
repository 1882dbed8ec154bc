// SPDX-License-Identifier: GPL-3.0-or-later
#include "render/surface_normals.hpp"

#include <cmath>

#include "scanmill/base/parallel.hpp"
#include "scanmill/geometry/mesh/coincident.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

/// The facets around a vertex of more than this many are long and thin, as in the fan of a flat end. They keep their
/// normals.
constexpr u32 most_around = 64;
constexpr double smooth_cosine = 0.766044443118978;  // of 40 degrees

const Column* numbers_of(const ColumnTable& columns, std::string_view name, u32 components) {
    const Column* column = columns.find(name);
    return column && column->components() == components ? column : nullptr;
}

Vec3 unit(const Vec3& vector) {
    const double length = vector.stableNorm();
    return length > 0 && std::isfinite(length) ? Vec3(vector / length) : Vec3(Vec3::Zero());
}

}  // namespace

SurfaceNormals::SurfaceNormals(const TriangleMesh& mesh, unsigned threads)
    : mesh_(mesh),
      corner_normals_(numbers_of(mesh.face_columns, "corner-normals", 9)),
      vertex_normals_(numbers_of(mesh.vertex_columns, "normal", 3)) {
    constexpr std::size_t chunk = 1 << 14;
    area_vectors_.resize(mesh.triangles.size());
    for_each_chunk(threads, mesh.triangles.size(), chunk, [&](std::size_t begin, std::size_t end) {
        for (std::size_t t = begin; t < end; ++t) {
            area_vectors_[t] = area_vector(mesh.positions.span(), mesh.triangles[t]);
        }
    });
    if (corner_normals_ || vertex_normals_) return;
    lowest_ = lowest_at_position(mesh.positions.span());
    begin_.assign(mesh.positions.size() + 1, 0);
    for (const Triangle& triangle : mesh.triangles)
        for (const u32 vertex : triangle) ++begin_[lowest_[vertex] + 1];
    for (std::size_t v = 0; v < mesh.positions.size(); ++v) begin_[v + 1] += begin_[v];
    around_.resize(3 * mesh.triangles.size());
    Array<u32> next(begin_.begin(), begin_.end() - 1);
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        for (const u32 vertex : mesh.triangles[t]) around_[next[lowest_[vertex]]++] = static_cast<u32>(t);
}

Vec3 SurfaceNormals::facet(u32 triangle) const { return unit(area_vectors_[triangle]); }

Vec3 SurfaceNormals::corner(u32 triangle, std::size_t corner, const Vec3& facet) const {
    const u32 vertex = mesh_.triangles[triangle][corner];
    Vec3 normal;
    if (corner_normals_) {
        for (u32 i = 0; i < 3; ++i) normal[i] = corner_normals_->number(triangle, static_cast<u32>(3 * corner) + i);
    } else if (vertex_normals_) {
        for (u32 i = 0; i < 3; ++i) normal[i] = vertex_normals_->number(vertex, i);
    } else {
        normal.setZero();
        const u32 lowest = lowest_[vertex];
        if (begin_[lowest + 1] - begin_[lowest] > most_around) return facet;
        for (u32 i = begin_[lowest]; i < begin_[lowest + 1]; ++i) {
            const Vec3& other = area_vectors_[around_[i]];
            const double along = other.dot(facet);
            if (along > 0 && along * along >= smooth_cosine * smooth_cosine * other.squaredNorm()) normal += other;
        }
    }
    normal = unit(normal);
    return normal == Vec3::Zero() ? facet : normal;
}

Vec3 SurfaceNormals::at(u32 triangle, const std::array<double, 3>& weights) const {
    const Vec3 own = facet(triangle);
    if (own == Vec3::Zero()) return own;
    Vec3 normal = Vec3::Zero();
    for (std::size_t i = 0; i < 3; ++i)
        if (weights[i] != 0) normal += weights[i] * corner(triangle, i, own);
    normal = unit(normal);
    return normal == Vec3::Zero() ? own : normal;
}

}  // namespace scanmill
