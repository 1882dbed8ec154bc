// SPDX-License-Identifier: GPL-3.0-or-later
#include "patch_distance/patch_distance.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/patches/a_patch.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"
#include "tessellate/tessellate.hpp"

namespace scanmill {

namespace {

constexpr std::size_t chunk = 1024;
constexpr const char* column_name = "distance-to-patches";
constexpr u32 subdivision = 2;  // segments per edge of the tessellation that gives the start points
constexpr double farthest = 0.1;  // as a share of the surface's diagonal
constexpr double rounding = 1e-12;

/// The vertices and edges at which the surface ends.
class Boundary {
public:
    explicit Boundary(const TriangleMesh& mesh)
        : mesh_(mesh),
          opposites_(half_edges::opposites(mesh)),
          has_vertex_(mesh.positions.size(), false) {
        for (u32 half = 0; half < opposites_.size(); ++half)
            if (opposites_[half] == half_edges::boundary)
                has_vertex_[half_edges::start(mesh, half)] = has_vertex_[half_edges::end(mesh, half)] = true;
    }

    bool is_empty() const { return std::ranges::find(has_vertex_, true) == has_vertex_.end(); }

    /// Whether `point`, which lies on `triangle`, is within `rounded` of the boundary.
    bool contains(u32 triangle, const Vec3& point, double rounded) const {
        for (u32 half = 3 * triangle; half < 3 * triangle + 3; ++half) {
            const u32 a = half_edges::start(mesh_, half), b = half_edges::end(mesh_, half);
            const Vec3 to = point - mesh_.positions[a];
            if (has_vertex_[a] && to.norm() <= rounded) return true;
            if (opposites_[half] != half_edges::boundary) continue;
            const Vec3 along = (mesh_.positions[b] - mesh_.positions[a]).normalized();
            if ((to - along.dot(to) * along).norm() <= rounded) return true;
        }
        return false;
    }

private:
    const TriangleMesh& mesh_;
    Array<u32> opposites_;
    std::vector<bool> has_vertex_;
};

}  // namespace

PatchDistances distances_to_patches(const PatchComplex& patches, std::span<const Vec3> points, Execution& execution) {
    const PatchSurface surface(patches, execution.threads());
    const TriangleMesh mesh = tessellate(patches, {subdivision, {}}, execution);
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), execution.threads());
    const Boundary boundary(mesh);
    const bool is_closed = boundary.is_empty();
    const double limit = farthest * surface_box(mesh).diagonal();
    // A ray test needs a closed surface. On an open surface, the side of the nearest triangle decides.
    const auto is_inside = [&](const Vec3& point, const Vec3& nearest, u32 triangle) {
        if (is_closed) return surface.is_inside(point);
        return (point - nearest).dot(area_vector(mesh.positions, mesh.triangles[triangle])) < 0;
    };
    Array<double> distances(points.size());
    for_each_chunk(execution.threads(), points.size(), chunk, [&](std::size_t begin, std::size_t end) {
        execution.check_cancelled();
        u32 hint = NearestTriangle::none;
        for (std::size_t i = begin; i < end; ++i) {
            const Vec3& p = points[i];
            distances[i] = std::nan("");
            const NearestTriangle nearest = tree.nearest(p, hint);
            hint = nearest.slot;
            if (nearest.squared_distance > limit * limit) continue;
            const Vec3 start = tree.nearest_point(p, hint);
            if (const auto foot = surface.foot(p, start)) distances[i] = foot->distance;
            // There is no foot at corners of creases, and between faces that have no tetrahedra between them.
            else if (!boundary.contains(nearest.triangle, start, rounding * limit))
                distances[i] = (is_inside(p, start, nearest.triangle) ? -1 : 1) * (p - start).norm();
        }
    });
    return {std::move(distances), limit};
}

PatchDistanceResult patch_distance(const PatchComplex& patches, const PointCloud& points, Context& context) {
    if (patches.tets.empty()) throw Error("the patches have no tetrahedra").hint("'a-patch' makes patches of a mesh");
    if (points.size() == 0) throw Error("needs points; there are none").hint("wire the scan: 'in: {points: scan}'");
    require_finite(points.positions.span());
    require_same_frame(points.frame, "the points are", patches.frame, "the patches");
    auto [distances, limit] = distances_to_patches(patches, points.positions.span(), context);
    PatchDistanceResult result;
    std::vector<double> found;
    double squares = 0;
    for (const double d : distances) {
        if (std::isnan(d)) continue;
        found.push_back(std::abs(d));
        squares += d * d;
    }
    if (found.empty())
        throw Error("none of {} is within {:.3g} {}, a tenth of the surface's diagonal, of the surface",
                    count_text(points.size(), "point", "points"), limit, symbol(points.frame.unit))
            .hint("are points and patches in the same frame and unit?");
    const auto count = static_cast<double>(found.size());
    result.unlocated = distances.size() - found.size();
    result.rms = std::sqrt(squares / count);
    result.p95 = quantile(found, 0.95);
    result.max = *std::ranges::max_element(found);
    result.points = points;
    add_column(result.points.columns,
               Column(column_name, 1, Buffer<double>(std::move(distances))).with_length_exponent(1), context);
    if (result.unlocated > 0)
        context.warn(fmt::format(
            "{} of {} points {} no distance: more than {:.3g} u from the surface, or nearest to its boundary",
            result.unlocated, points.size(), by_count(result.unlocated, "has", "have"), limit));
    context.metric("rms", result.rms, Unit::length);
    context.metric("p95", result.p95, Unit::length);
    context.metric("max", result.max, Unit::length);
    context.metric("unlocated", static_cast<double>(result.unlocated));
    return result;
}

}  // namespace scanmill
