// SPDX-License-Identifier: GPL-3.0-or-later
/// A mesh as a scene: a z-buffer in double precision, one ray through every pixel's centre.
///
/// The side of an edge on which a pixel lies is computed from the edge's ends in a fixed order. So the two triangles of
/// an edge get the same number with opposite signs, and no ray passes between them. Source: Catmull 1974 for the
/// z-buffer, Pineda 1988 for the edge functions.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/array.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "scanmill/kinds/length_scale.hpp"
#include "virtual_scan/scene.hpp"

namespace scanmill::scan {

namespace {

constexpr u32 no_triangle = ~u32(0);

struct DepthImage {
    Array<double> depth;
    Array<u32> triangle;
};

/// Twice the signed area of the triangle a, b, (x, y); positive if it turns left. Swapping a and b gives exactly the
/// negative.
double edge_function(const Vec3& a, const Vec3& b, double x, double y) {
    const bool swapped = std::pair(b.x(), b.y()) < std::pair(a.x(), a.y());
    const Vec3& from = swapped ? b : a;
    const Vec3& to = swapped ? a : b;
    const double value = (to.x() - from.x()) * (y - from.y()) - (to.y() - from.y()) * (x - from.x());
    return swapped ? -value : value;
}

/// First pixel whose centre may lie in [low, high], and the one after the last such pixel, clipped to [0, count].
std::pair<std::size_t, std::size_t> pixels_between(double low, double high, double start, double resolution,
                                                   std::size_t count) {
    const double first = std::floor(low / resolution - start - 0.5);
    const double last = std::ceil(high / resolution - start - 0.5);
    const double most = static_cast<double>(count);
    return {static_cast<std::size_t>(std::clamp(first, 0.0, most)),
            static_cast<std::size_t>(std::clamp(last + 1, 0.0, most))};
}

/// Draws a triangle into the image. Pre: a, b, c turn left or lie on one line.
void draw(const Vec3& a, const Vec3& b, const Vec3& c, u32 row_of_triangle, const View& view, DepthImage& image) {
    const Vec3 low = a.cwiseMin(b).cwiseMin(c), high = a.cwiseMax(b).cwiseMax(c);
    const auto [left, right] = pixels_between(low.x(), high.x(), view.left, view.resolution, view.width);
    const auto [bottom, top] = pixels_between(low.y(), high.y(), view.bottom, view.resolution, view.height);
    for (std::size_t row = bottom; row < top; ++row) {
        const double y = view.along(row);
        for (std::size_t column = left; column < right; ++column) {
            const double x = view.across(column);
            const double weight_a = edge_function(b, c, x, y);
            const double weight_b = edge_function(c, a, x, y);
            const double weight_c = edge_function(a, b, x, y);
            const double sum = weight_a + weight_b + weight_c;
            if (!(weight_a >= 0 && weight_b >= 0 && weight_c >= 0 && sum > 0)) continue;
            const double depth = (weight_a * a.z() + weight_b * b.z() + weight_c * c.z()) / sum;
            const std::size_t pixel = row * view.width + column;
            if (depth < image.depth[pixel]) {
                image.depth[pixel] = depth;
                image.triangle[pixel] = row_of_triangle;
            }
        }
    }
}

DepthImage depth_image(const TriangleMesh& mesh, const View& view) {
    const std::size_t pixels = view.width * view.height;
    DepthImage image{Array<double>(pixels, std::numeric_limits<double>::infinity()), Array<u32>(pixels, no_triangle)};
    Array<Vec3> projected(mesh.positions.size());
    for (std::size_t i = 0; i < projected.size(); ++i) projected[i] = view.project(mesh.positions[i]);
    for (u32 row = 0; row < mesh.triangles.size(); ++row) {
        const auto& [a, b, c] = mesh.triangles[row];
        const double turn = edge_function(projected[a], projected[b], projected[c].x(), projected[c].y());
        if (turn > 0) draw(projected[a], projected[b], projected[c], row, view, image);
        if (turn < 0) draw(projected[a], projected[c], projected[b], row, view, image);
    }
    return image;
}

std::vector<Hit> hits_of(const TriangleMesh& mesh, const View& view) {
    const DepthImage image = depth_image(mesh, view);
    std::vector<Hit> hits;
    for (std::size_t row = 0; row < view.height; ++row)
        for (std::size_t column = 0; column < view.width; ++column) {
            const std::size_t pixel = row * view.width + column;
            if (image.triangle[pixel] == no_triangle) continue;
            Vec3 normal = area_vector(mesh.positions, mesh.triangles[image.triangle[pixel]]).normalized();
            if (normal.dot(view.forward) > 0) normal = -normal;
            hits.push_back({view.point(view.across(column), view.along(row), image.depth[pixel]), normal});
        }
    return hits;
}

}  // namespace

Scene scene_of(const TriangleMesh& mesh) {
    require_consistent(mesh);
    require_finite(mesh.positions.span(), "vertices");
    if (mesh.triangles.empty())
        throw Error("the mesh has {} and no triangles to scan", count_text(mesh.positions.size(), "vertex", "vertices"))
            .hint("make a mesh of them first, or scan a shape: `shape: sphere`");
    Scene scene;
    scene.frame = mesh.frame;
    const TriangleMesh used = without_unused_vertices(mesh);
    scene.box = bounding_box(used.positions.span());
    if (!(scene.box.diagonal() > 0))
        throw Error("the mesh has no extent: {} one point",
                    mesh.triangles.size() == 1 ? "its only triangle is"
                                               : fmt::format("all {} triangles are", mesh.triangles.size()))
            .hint("`scanmill info` shows the content of a file");
    scene.hull.assign(used.positions.begin(), used.positions.end());
    scene.scale.unit = mesh.frame.unit;
    scene.scale.diagonal = [diagonal = scene.box.diagonal()] { return diagonal; };
    scene.scale.spacing = [&mesh] { return edge_spacing(mesh); };
    scene.hits = [&mesh](const View& view) { return hits_of(mesh, view); };
    return scene;
}

}  // namespace scanmill::scan
