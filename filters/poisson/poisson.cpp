// SPDX-License-Identifier: GPL-3.0-or-later
#include "poisson/poisson.hpp"

#include <fmt/format.h>
#include <pcl/point_types.h>
#include <pcl/surface/poisson.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <memory>
#include <mutex>
#include <numeric>
#include <span>
#include <vector>

#include "fill_holes/fill_holes.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/parallel.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/half_edges.hpp"
#include "scanmill/data/point_tree.hpp"
#include "scanmill/data/spacing.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/distance/sides.hpp"
#include "scanmill/geometry/fit/covariance.hpp"
#include "scanmill/geometry/mesh/boundary_loops.hpp"
#include "scanmill/geometry/mesh/facet_normals.hpp"
#include "scanmill/geometry/mesh/handles.hpp"
#include "scanmill/geometry/spatial/triangle_tree.hpp"
#include "scanmill/geometry/spatial/vectors.hpp"

namespace scanmill {

namespace {

constexpr u32 least_depth = 3, most_depth = 12;
constexpr int full_depth = 5;  // PCL accepts no smaller depth for dividing its octree
constexpr double most_scale = 10;
constexpr std::size_t neighbours = 8;
constexpr double far_factor = 2;  // points are far beyond this multiple of the distance to the 8th neighbour
constexpr double doubtful_share = 0.05;
/// A vertex farther than this from every point, in spacings of the surface, is invented.
constexpr double wired_spacings = 4;
constexpr double least_flatness = 1e-12;  // points with a smaller flatness are on one line
constexpr u32 most_crack_edges = 12;  // a longer loop is where the surface leaves the octree's cube
constexpr std::size_t chunk = 1 << 10;

void require_usable(const PointCloud& cloud, const PoissonParams& params) {
    if (params.depth < least_depth || params.depth > most_depth)
        throw Error("depth must be from {} to {}; it is {}", least_depth, most_depth, params.depth)
            .hint("9 suits most scans; time and memory grow up to fourfold with every step");
    if (!(params.scale > 1 && params.scale <= most_scale))
        throw Error("scale must be above 1 and at most {}; it is {:g}", most_scale, params.scale)
            .hint("1.5 suits most scans; a larger cube needs a larger depth for cells of the same size");
    if (const double trim = params.trim.value(); !(trim >= 0 && trim < 1))
        throw Error("trim must be from 0 to below 100 %; it is {:g} %", 100 * trim)
            .hint("`0 %` keeps the whole surface; `2 %` removes the 2 % of the vertices that have the fewest points");
    if (params.max_distance && !(params.max_distance->value() > 0 && std::isfinite(params.max_distance->value())))
        throw Error("max-distance must be above 0; it is {:g} u", params.max_distance->value())
            .hint("`5 spacing` suits most scans; leave max-distance out to keep every distance");
    require_points(cloud, "poisson needs at least 4 with normals");
    const Column* normal = cloud.columns.find("normal");
    if (!normal)
        throw Error("the scan has no column 'normal'; poisson needs a normal at every point")
            .hint("put the filter `normals` before it");
    if (normal->components() != 3)
        throw Error("the column 'normal' has {} per point; 3 are needed",
                    normal->is_list() ? "a list" : count_text(normal->components(), "number", "numbers"))
            .hint("put the filter `normals` before it, which replaces the column");
}

/// The points that have a normal.
struct Oriented {
    Array<Vec3> positions, normals;
};

Oriented oriented_points(const PointCloud& cloud) {
    const Column& column = *cloud.columns.find("normal");
    Oriented points;
    points.positions.reserve(cloud.size());
    points.normals.reserve(cloud.size());
    for (std::size_t row = 0; row < cloud.size(); ++row) {
        const Vec3 normal(column.number(row, 0), column.number(row, 1), column.number(row, 2));
        const double length = normal.stableNorm();
        if (!(length > 0) || !std::isfinite(length)) continue;
        points.positions.push_back(cloud.positions[row]);
        points.normals.push_back(normal / length);
    }
    if (points.positions.empty())
        throw Error("none of the {} has a normal: all are 0, NaN or infinite",
                    count_text(cloud.size(), "point", "points"))
            .hint("put the filter `normals` before it, which replaces the column");
    return points;
}

void require_extent(const PointTree& tree) {
    const std::span<const Vec3> positions = tree.positions();
    if (positions.size() < 4)
        throw Error("the points with normals have {}; poisson needs at least 4",
                    count_text(positions.size(), "distinct position", "distinct positions"))
            .hint("`scanmill info` shows what a file contains");
    const BoundingBox box = bounding_box(positions);
    Array<Vec3> offsets(positions.begin(), positions.end());
    for (Vec3& offset : offsets) offset = (offset - (box.low + box.high) / 2) / box.diagonal();
    if (scatter_of(offsets).flatness < least_flatness)
        throw Error("the {} distinct positions with normals lie on one line; poisson needs a surface", positions.size())
            .hint("a scan of one line has no surface");
}

/// Returns PCL's surface of the points, and in `cell` the edge of the octree's smallest possible cell. PCL's memory is
/// static, so calls from several threads wait for each other.
TriangleMesh surface_of(const Oriented& points, const Frame& frame, const PoissonParams& params, double& cell) {
    const BoundingBox box = bounding_box(points.positions);
    const Vec3 centre = (box.low + box.high) / 2;
    const double size = (box.high - box.low).maxCoeff();
    const auto scaled = std::make_shared<pcl::PointCloud<pcl::PointNormal>>();
    for (std::size_t i = 0; i < points.positions.size(); ++i) {
        pcl::PointNormal& point = scaled->emplace_back();
        point.getVector3fMap() = ((points.positions[i] - centre) / size).cast<float>();
        point.getNormalVector3fMap() = points.normals[i].cast<float>();
    }
    pcl::Poisson<pcl::PointNormal> solver;
    solver.setInputCloud(scaled);
    solver.setDepth(static_cast<int>(params.depth));
    solver.setScale(static_cast<float>(params.scale));
    const int undivided = std::max(static_cast<int>(params.depth), full_depth);
    solver.setSolverDivide(undivided);
    solver.setIsoDivide(undivided);
    solver.setThreads(1);
    pcl::PointCloud<pcl::PointNormal> vertices;
    std::vector<pcl::Vertices> triangles;
    {
        static std::mutex one_at_a_time;
        const std::scoped_lock lock(one_at_a_time);
        solver.performReconstruction(vertices, triangles);
    }
    if (triangles.empty())
        throw Error("no surface separates the {} points: their normals cancel out, or the octree is too coarse",
                    points.positions.size())
            .hint("check that the normals point outwards, or raise depth");
    cell = params.scale * size / (1 << params.depth);
    Array<Vec3> positions;
    positions.reserve(vertices.size());
    for (const pcl::PointNormal& vertex : vertices)
        positions.push_back(centre + size * vertex.getVector3fMap().cast<double>());
    require_finite(positions, "vertices of the surface");
    TriangleMesh mesh;
    mesh.frame = frame;
    mesh.positions = std::move(positions);
    Array<Triangle> corners;
    corners.reserve(triangles.size());
    for (const auto& [v] : triangles) corners.push_back({u32(v[0]), u32(v[1]), u32(v[2])});
    mesh.triangles = std::move(corners);
    return mesh;
}

/// Counts of the cracks that PCL leaves.
struct Cracks {
    std::size_t filled = 0, open = 0;
};

Cracks fill_cracks(TriangleMesh& mesh, Context& context) {
    ContextOptions options;
    options.threads = context.threads();
    options.is_cancelled = [&] { return context.cancelled(); };
    Context own(options);
    FillHolesParams params;
    params.outer = FillHolesParams::Outer::fill;
    params.max_edges = most_crack_edges;
    params.fair = false;
    params.together = false;
    params.outwards = false;
    FillHolesResult filled = fill_holes(mesh, params, own);
    mesh.positions = filled.mesh.positions;
    mesh.triangles = filled.mesh.triangles;
    return {filled.filled, filled.failed};
}

/// Support of the vertices by the points. All members but `spread` and `usual` have one value per vertex.
struct Support {
    Array<double> nearest, last;  ///< distances to the nearest and to the 8th nearest position
    std::vector<u8> far, against;  ///< flags, as poisson.hpp defines them
    Array<double> spread;  ///< distance from each position to the 8th nearest other one
    double usual = 0;  ///< median of `spread`
};

Support support_of(const TriangleMesh& mesh, const Oriented& points, const PointTree& tree, Context& context) {
    const std::span<const Vec3> positions = tree.positions();
    Array<Vec3> normals(positions.size(), Vec3::Zero());
    for (std::size_t row = 0; row < points.normals.size(); ++row)
        normals[tree.index_of_row()[row]] += points.normals[row];
    Array<double> spread(positions.size());
    tree.for_each_nearest(neighbours, context.threads(), [&](const NeighbourBatch& batch) {
        context.check_cancelled();
        for (std::size_t i = 0; i < batch.indices.size(); ++i)
            spread[batch.indices[i]] = std::sqrt(batch.of(i).back().squared);
    });

    const std::size_t count = mesh.positions.size();
    const Array<Vec3> outward = vertex_area_vectors(mesh);
    Support support{Array<double>(count), Array<double>(count), std::vector<u8>(count), std::vector<u8>(count), {}, 0};
    std::atomic<std::size_t> done = 0;
    for_each_chunk(context.threads(), count, chunk, [&](std::size_t begin, std::size_t end) {
        context.check_cancelled();
        NeighbourBuffer buffer;
        for (std::size_t i = begin; i < end; ++i) {
            const std::span<const Neighbour> near = tree.nearest_to(mesh.positions[i], neighbours, buffer);
            Vec3 sum = Vec3::Zero();
            for (const Neighbour& neighbour : near) sum += normals[neighbour.index];
            support.nearest[i] = std::sqrt(near.front().squared);
            support.last[i] = std::sqrt(near.back().squared);
            support.far[i] = support.nearest[i] > far_factor * spread[near.front().index];
            support.against[i] = sum.dot(outward[i]) < 0;
        }
        context.progress(0.85 + 0.1 * static_cast<double>(done += end - begin) / static_cast<double>(count));
    });
    support.spread = spread;
    support.usual = median(spread);
    return support;
}

/// Share of the positions that are far from the surface. Only every n-th position is tested, at most 10,000.
double missed_share(const TriangleMesh& mesh, std::span<const Vec3> positions, const Support& support, double cell,
                    Context& context) {
    constexpr std::size_t most = 10'000;
    const TriangleTree tree(mesh.positions.span(), mesh.triangles.span(), context.threads());
    const std::size_t step = positions.size() / most + 1;
    std::size_t missed = 0, all = 0;
    u32 hint = NearestTriangle::none;
    for (std::size_t i = 0; i < positions.size(); i += step) {
        const double limit = far_factor * std::max(support.spread[i], cell);
        missed += !tree.is_within(positions[i], limit * limit, hint);
        ++all;
    }
    return static_cast<double>(missed) / static_cast<double>(all);
}

/// Returns one flag per vertex: 1 if trimming removes the vertex.
std::vector<u8> removed_vertices(const Support& support, const PoissonParams& params) {
    const std::size_t count = support.last.size();
    std::vector<u8> removed(count, 0);
    Array<u32> order(count);
    std::iota(order.begin(), order.end(), 0);
    const auto least = static_cast<std::ptrdiff_t>(params.trim.value() * static_cast<double>(count));
    std::nth_element(order.begin(), order.begin() + least, order.end(), [&](u32 a, u32 b) {
        return support.last[a] != support.last[b] ? support.last[a] > support.last[b] : a < b;
    });
    for (std::ptrdiff_t i = 0; i < least; ++i) removed[order[static_cast<std::size_t>(i)]] = 1;
    if (params.max_distance)
        for (std::size_t i = 0; i < count; ++i)
            if (support.nearest[i] > params.max_distance->value()) removed[i] = 1;
    return removed;
}

/// Returns the mesh without the removed vertices and their triangles, with the column `density`.
TriangleMesh trimmed(TriangleMesh mesh, const Support& support, const std::vector<u8>& removed,
                     const PoissonParams& params) {
    Array<Triangle> kept;
    kept.reserve(mesh.triangles.size());
    for (const Triangle& t : mesh.triangles)
        if (!removed[t[0]] && !removed[t[1]] && !removed[t[2]]) kept.push_back(t);
    if (kept.empty())
        throw Error("trimming leaves none of the {} triangles: trim is {:g} %{}", mesh.triangles.size(),
                    100 * params.trim.value(),
                    params.max_distance ? fmt::format(", max-distance {:g} u", params.max_distance->value()) : "")
            .hint("lower trim, or raise max-distance; `trim: 0 %` keeps the whole surface");
    Array<float> density(mesh.positions.size());
    for (std::size_t i = 0; i < density.size(); ++i) {
        const double ratio = support.usual / support.last[i];
        density[i] = static_cast<float>(ratio * ratio);
    }
    mesh.triangles = std::move(kept);
    mesh.vertex_columns.add(Column("density", 1, Buffer<float>(std::move(density))));
    return without_unused_vertices(mesh);
}

void warn_of_columns(const PointCloud& cloud, Context& context) {
    ColumnTable others;
    for (const Column& column : cloud.columns)
        if (column.name() != "normal") others.add(column);
    warn_of_dropped(others, "columns of the points", "the vertices are new", context);
}

void report_doubts(const PoissonResult& result, std::size_t ends, std::size_t open_cracks, std::size_t turned,
                   Context& context) {
    if (result.without_normal > 0)
        context.warn(fmt::format("{} not used: {} 0, NaN or infinite",
                                 count_text(result.without_normal, "point is", "points are"),
                                 by_count(result.without_normal, "its normal is", "their normals are")));
    if (ends > 0)
        context.warn(
            fmt::format("the surface leaves the octree's cube and ends there, in {}; a larger scale may close it",
                        count_text(ends, "boundary loop", "boundary loops")));
    if (open_cracks > 0)
        context.warn(
            fmt::format("{} between cells of different sizes {} open in the surface: every triangulation of the hole "
                        "would intersect something",
                        count_text(open_cracks, "crack", "cracks"), by_count(open_cracks, "stays", "stay")));
    if (turned > 0)
        context.warn(fmt::format(
            "the normals point into the volume that the surface encloses; {} turned to face outwards, or inwards round "
            "a cavity",
            count_text(turned, "triangle was", "triangles were")));
    if (result.invented > doubtful_share)
        context.doubt(
            fmt::format("{:.1f} % of the area is far from all points, and so invented; a higher trim, or "
                        "max-distance, removes it",
                        100 * result.invented));
    if (result.missed > doubtful_share)
        context.doubt(
            fmt::format("{:.1f} % of the points are far from the surface (more than {:g} cells, and more than twice "
                        "the distance to their 8th neighbours): parts are too small for cells of {:.3g} u; raise depth",
                        100 * result.missed, far_factor, result.cell));
    if (result.against > doubtful_share)
        context.doubt(
            fmt::format("at {:.1f} % of the vertices the surface faces away from the normals of the nearest "
                        "points: normals are not on the same side everywhere, or depth is too low",
                        100 * result.against));
}

}  // namespace

PoissonResult poisson(const PointCloud& cloud, const PoissonParams& params, Context& context) {
    require_usable(cloud, params);
    context.check_cancelled();
    const Oriented points = oriented_points(cloud);
    const PointTree tree(points.positions, context.threads());
    require_extent(tree);
    context.check_cancelled();
    context.progress(0.02);

    PoissonResult result;
    result.without_normal = cloud.size() - points.positions.size();
    TriangleMesh whole = surface_of(points, cloud.frame, params, result.cell);
    context.check_cancelled();
    context.progress(0.8);
    const Cracks cracks = fill_cracks(whole, context);
    result.cracks = cracks.filled;
    context.progress(0.85);
    const Support support = support_of(whole, points, tree, context);
    const std::size_t vertices = whole.positions.size();
    result.against = static_cast<double>(std::ranges::count(support.against, u8(1))) / static_cast<double>(vertices);
    const auto ends = static_cast<std::size_t>(
        std::ranges::count_if(boundary_loops(whole, half_edges::opposites(whole)),
                              [](const auto& loop) { return loop.size() > most_crack_edges; }));

    result.missed = missed_share(whole, tree.positions(), support, result.cell, context);

    const std::vector<u8> removed = removed_vertices(support, params);
    double area = 0, invented = 0;
    for (const Triangle& t : whole.triangles) {
        if (removed[t[0]] || removed[t[1]] || removed[t[2]]) continue;
        const double its = area_vector(whole.positions, t).norm();
        area += its;
        invented += its * (support.far[t[0]] + support.far[t[1]] + support.far[t[2]]) / 3;
    }
    result.invented = area > 0 ? invented / area : 0;
    result.mesh = trimmed(std::move(whole), support, removed, params);
    const std::size_t turned = face_outwards(result.mesh, context);
    result.trimmed = vertices - result.mesh.positions.size();
    result.loops = boundary_loops(result.mesh, half_edges::opposites(result.mesh)).size();
    warn_of_columns(cloud, context);
    report_doubts(result, ends, cracks.open, turned, context);
    const double reach = wired_spacings * edge_spacing(result.mesh);
    NeighbourBuffer buffer;
    const auto is_invented = [&](u32 vertex) {
        return tree.nearest_to(result.mesh.positions[vertex], 1, buffer).front().squared > reach * reach;
    };
    for (std::string& doubt : doubts_about_handles(result.mesh, context, is_invented)) context.doubt(std::move(doubt));

    context.metric("triangles", static_cast<double>(result.mesh.triangles.size()));
    context.metric("trimmed", static_cast<double>(result.trimmed));
    context.metric("invented", result.invented, Unit::ratio);
    context.metric("missed", result.missed, Unit::ratio);
    context.metric("against", result.against, Unit::ratio);
    context.metric("without-normal", static_cast<double>(result.without_normal));
    context.metric("cracks", static_cast<double>(result.cracks));
    context.metric("loops", static_cast<double>(result.loops));
    context.metric("cell", result.cell, Unit::length);
    context.progress(1);
    return result;
}

}  // namespace scanmill
