// SPDX-License-Identifier: GPL-3.0-or-later
#include "virtual_scan/virtual_scan.hpp"

#include <cmath>

#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/spatial/cell_grid.hpp"
#include "virtual_scan/scene.hpp"
#include "virtual_scan/view.hpp"

namespace scanmill {

namespace {

using Shape = VirtualScanParams::Shape;
constexpr double most_rays = 1 << 28;
/// Independent random numbers for each purpose.
enum Stream : std::uint64_t { noise_stream, overlap_stream, outlier_stream };

scan::Scene scene_of(const TriangleMesh* mesh, const VirtualScanParams& params) {
    if (mesh && params.shape != Shape::none)
        throw Error("there is a mesh and a shape to scan; only one is possible").hint("omit `shape`, or wire no mesh");
    if (mesh) return scan::scene_of(*mesh);
    if (params.shape == Shape::none)
        throw Error("there is nothing to scan: no mesh, and no shape named")
            .hint("wire a mesh, or write `shape: sphere`");
    return scan::scene_of(params.shape, params.size);
}

/// Lower limits are not needed: too fine a resolution needs too many rays, and any noise is small enough.
void require_supported(std::string_view name, double length) {
    if (length > scan::largest_size)
        throw Error("the {} is {:.3g} u; at most {:.0e} u is supported", name, length, scan::largest_size)
            .hint("give it as a share of the object: 0.5 %diag");
}

void require_sound(const VirtualScanParams& params, double resolution, double noise) {
    if (!(resolution > 0) || !std::isfinite(resolution))
        throw Error("the resolution is {} u; it must be above 0", resolution)
            .hint("0.5 %diag puts some 200 points across the object");
    require_supported("resolution", resolution);
    if (!(noise >= 0) || !std::isfinite(noise))
        throw Error("the noise is {} u; it must be 0 or more", noise).hint("write `noise: 0 u` for none");
    require_supported("noise", noise);
    const double outliers = params.outliers.value(), overlap = params.overlap.value();
    if (!(outliers >= 0 && outliers <= 10))
        throw Error("outliers is {}; it must be from 0 % to 1000 %", params.outliers.text())
            .hint("it is a share of the points: 1 % adds one outlier to a hundred points");
    if (!(overlap >= 0 && overlap <= 1))
        throw Error("overlap is {}; it must be from 0 % to 100 %", params.overlap.text())
            .hint("100 % keeps the points of all views, 0 % only those of the first view");
    const double angle = params.max_angle.in_degrees();
    if (!(angle > 0 && angle <= 90))
        throw Error("max-angle is {}; it must be above 0 deg and at most 90 deg", params.max_angle.text())
            .hint("90 deg keeps every point that is seen");
}

std::vector<scan::View> views_at(const scan::Scene& scene, const std::vector<Vec3>& directions, double resolution) {
    const Vec3 centre = 0.5 * scene.box.low + 0.5 * scene.box.high;
    std::vector<scan::View> views;
    for (const Vec3& direction : directions) views.push_back(scan::view_from(direction, centre, resolution));
    return views;
}

double rays_over(std::span<const scan::View> views, const scan::Scene& scene) {
    double total = 0;
    for (const scan::View& view : views) total += scan::rays_over(view, scene.hull);
    return total;
}

/// Names a resolution that fits. It is computed from the number of rays at a fine resolution.
std::string resolution_that_fits(const scan::Scene& scene, const std::vector<Vec3>& directions) {
    const double fine = 1e-6 * scene.box.diagonal();
    const double total = rays_over(views_at(scene, directions, fine), scene);
    return fmt::format("a resolution of {:.3g} u or coarser fits", 1.01 * fine * std::sqrt(total / most_rays));
}

std::vector<scan::View> views_over(const scan::Scene& scene, const std::vector<Vec3>& directions, double resolution,
                                   std::size_t& rays) {
    std::vector<scan::View> views = views_at(scene, directions, resolution);
    const double total = rays_over(views, scene);
    if (!(total <= most_rays))
        throw Error("{} at a resolution of {:.6g} u {} {:.6g} rays; at most {} are possible",
                    count_text(views.size(), "view", "views"), resolution, by_count(views.size(), "takes", "take"),
                    total, most_rays)
            .hint(resolution_that_fits(scene, directions));
    for (scan::View& view : views) view = scan::covering(view, scene.hull);
    rays = static_cast<std::size_t>(total);
    return views;
}

/// The points of the result and their columns.
struct Samples {
    Array<Vec3> positions;
    Array<double> normals;
    Array<std::int32_t> view;

    void add(const Vec3& position, const Vec3& normal, std::int32_t number) {
        positions.push_back(position);
        normals.insert(normals.end(), {normal.x(), normal.y(), normal.z()});
        view.push_back(number);
    }
};

/// Returns the hits within `max_angle`, view by view.
std::vector<std::vector<scan::Hit>> returns_of(const scan::Scene& scene, const std::vector<scan::View>& views,
                                               Angle max_angle, Context& context) {
    const double least_cosine = max_angle.in_degrees() < 90 ? elementary::turn_of(max_angle.in_radians()).cosine : 0;
    std::vector<std::vector<scan::Hit>> returns(views.size());
    for_each_chunk(context.threads(), views.size(), 1, [&](std::size_t number, std::size_t) {
        context.check_cancelled();
        returns[number] = scene.hits(views[number]);
        std::erase_if(returns[number],
                      [&](const scan::Hit& hit) { return -hit.normal.dot(views[number].forward) < least_cosine; });
    });
    return returns;
}

/// Visits view by view the hits near a kept hit of an earlier view, and removes all but `share` of them. Returns the
/// number of removed hits.
std::size_t thin_overlap(std::vector<std::vector<scan::Hit>>& returns, const BoundingBox& box, double radius,
                         double share, const Random& random) {
    std::size_t dropped = 0;
    CellGrid grid(box, radius);
    std::vector<std::vector<Vec3>> seen;  // positions of kept hits, by cell
    for (std::size_t view = 0; view < returns.size(); ++view) {
        Random draw = random.stream(view);
        dropped += std::erase_if(returns[view], [&](const scan::Hit& hit) {
            const auto is_near = [&](const Vec3& other) {
                return (other - hit.position).squaredNorm() < radius * radius;
            };
            const auto has_near = [&](u32 cell) { return std::ranges::any_of(seen[cell], is_near); };
            return grid.any_near(hit.position, has_near) && draw.uniform() >= share;
        });
        for (const scan::Hit& hit : returns[view]) {
            const u32 cell = grid.enter(hit.position);
            if (cell == seen.size()) seen.emplace_back();
            seen[cell].push_back(hit.position);
        }
    }
    return dropped;
}

void add_outliers(Samples& samples, std::size_t count, const BoundingBox& box, Random random) {
    const Vec3 margin = 0.1 * (box.high - box.low);
    const Vec3 low = box.low - margin, high = box.high + margin;
    for (std::size_t i = 0; i < count; ++i) {
        Vec3 position;
        for (int axis = 0; axis < 3; ++axis) position[axis] = random.uniform(low[axis], high[axis]);
        samples.add(position, Vec3::Zero(), -1);
    }
}

}  // namespace

VirtualScanResult virtual_scan(const TriangleMesh* mesh, const VirtualScanParams& params, Context& context) {
    const scan::Scene scene = scene_of(mesh, params);
    VirtualScanResult result;
    result.resolution = params.resolution.resolved(scene.scale).value();
    result.noise = params.noise.resolved(scene.scale).value();
    require_sound(params, result.resolution, result.noise);
    result.directions = scan::view_directions(params.views);
    const std::vector<scan::View> views = views_over(scene, result.directions, result.resolution, result.rays);

    std::vector<std::vector<scan::Hit>> returns = returns_of(scene, views, params.max_angle, context);
    context.progress(0.8);
    const Random random = context.random();
    const double share = params.overlap.value();
    if (share < 1)
        result.dropped = thin_overlap(returns, scene.box, result.resolution, share, random.stream(overlap_stream));

    Samples samples;
    for (std::size_t number = 0; number < views.size(); ++number) {
        Random error = random.stream(noise_stream).stream(number);
        for (const scan::Hit& hit : returns[number]) {
            const Vec3 shift =
                result.noise > 0 ? Vec3(result.noise * error.normal() * views[number].forward) : Vec3::Zero();
            samples.add(hit.position + shift, hit.normal, static_cast<std::int32_t>(number));
        }
    }
    if (samples.positions.empty())
        throw Error("none of {} in {} came back from the surface", count_text(result.rays, "ray", "rays"),
                    count_text(views.size(), "view", "views"))
            .hint("use a finer resolution, more views, or a larger max-angle");
    result.outliers = static_cast<std::size_t>(
        std::floor(params.outliers.value() * static_cast<double>(samples.positions.size()) + 0.5));
    add_outliers(samples, result.outliers, scene.box, random.stream(outlier_stream));

    result.points.frame = scene.frame;
    result.points.positions = std::move(samples.positions);
    result.points.columns.add(Column("normal", 3, Buffer<double>(std::move(samples.normals))));
    result.points.columns.add(Column("view", 1, Buffer<std::int32_t>(std::move(samples.view))));
    context.metric("points", static_cast<double>(result.points.size()));
    context.metric("outliers", static_cast<double>(result.outliers));
    context.metric("dropped", static_cast<double>(result.dropped));
    context.progress(1);
    return result;
}

}  // namespace scanmill
