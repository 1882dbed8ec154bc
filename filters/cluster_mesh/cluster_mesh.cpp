// SPDX-License-Identifier: GPL-3.0-or-later
#include "cluster_mesh/cluster_mesh.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <deque>
#include <limits>
#include <numbers>

#include "cluster_mesh/clusters.hpp"
#include "cluster_mesh/insertion_order.hpp"
#include "cluster_mesh/triangulation.hpp"
#include "edge_flip/edge_flip.hpp"
#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/statistics.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/topology.hpp"
#include "scanmill/filter/inputs.hpp"
#include "scanmill/geometry/distance/self_intersections.hpp"
#include "scanmill/geometry/distance/sides.hpp"
#include "scanmill/geometry/growing/components.hpp"
#include "scanmill/geometry/growing/finished_mesh.hpp"
#include "scanmill/geometry/growing/holes.hpp"
#include "scanmill/geometry/growing/point_normals.hpp"
#include "scanmill/geometry/mesh/doubtful_surface.hpp"
#include "scanmill/geometry/spatial/direction.hpp"

namespace scanmill {

namespace {

using namespace clustering;
using growing::DistinctPoints;
using growing::Neighbourhoods;

double sine(double degrees) { return elementary::turn_of(Angle::degrees(degrees).in_radians()).sine; }
double cosine(double degrees) { return elementary::turn_of(Angle::degrees(degrees).in_radians()).cosine; }
/// max_edge is far too large if more other points than this are within max_edge of a point.
constexpr std::size_t most_near = 1000;

/// The limits of the insertion, then the relaxed limits of the completion. They limit the longest edge, the smallest
/// angle, the dihedral deviation, and the angles to the normals of points on faces and at edges. The angles to the
/// points' normals keep sheets apart and boundaries open. So do the short edges of the insertion, because the next
/// sheet is farther away than the next point of the same sheet. The tested shares of max_edge are 0.5, 0.6, 2/3, 0.7,
/// 0.75, 0.85 and 1. Only with 2/3, sheets 1.5 spacings apart are joined at their borders alone. On 26 thinned models
/// 2/3 leaves as many loops as 1, and fewer unused points.
const std::array<Limits, 5> passes{{{2.0 / 3, sine(5), 0, cosine(60), cosine(85), true, true, false},
                                    {1, sine(5), 0, cosine(60), cosine(85), true, true, false},
                                    {1, sine(3), cosine(105), cosine(75), cosine(110), true, true, true},
                                    {1, sine(3), cosine(105), cosine(75), cosine(110), false, true, true},
                                    {1, sine(0.5), cosine(120), cosine(80), -1, false, false, true}}};

/// Inserts all points, and completes the mesh.
class Insertion {
public:
    /// `is_given`: whether max_edge is a parameter of the user.
    Insertion(Surface& surface, double max_edge, bool is_given, const Vec3& up, const WinnerLimits& winner,
              Context& context)
        : surface_(surface),
          max_edge_(max_edge),
          is_given_(is_given),
          clusters_(surface.positions.size()),
          triangulation_(surface, max_edge, up, winner),
          context_(context) {}

    void insert_all(std::span<const u32> order) {
        for (std::size_t i = 0; i < order.size(); ++i) {
            if (i % 1024 == 0) {
                context_.check_cancelled();
                context_.progress(0.3 + 0.4 * static_cast<double>(i) / static_cast<double>(order.size()));
            }
            insert(order[i]);
        }
    }

    void complete() {
        triangulation_.remove_small_meshes();
        for (const Limits& limits : passes)
            while (complete_once(limits)) context_.check_cancelled();
    }

    void count(ClusterMeshResult& result) {
        result.cases = cases_;
        result.splits = splits_;
        result.extra = extra_;
    }
    Clusters& clusters() { return clusters_; }

private:
    std::span<const u32> near(u32 point) {
        near_.clear();
        surface_.neighbourhoods.within(point, max_edge_ * max_edge_, buffer_, near_);
        return near_;
    }

    void insert(u32 point) {
        const auto around = near(point);
        if (around.size() > most_near)
            throw Error("max-edge {:.3g} u is too large: {} other points are within this distance of the point at {}",
                        max_edge_, around.size(), at(surface_.positions[point]))
                .hint(fmt::format("{}use about {:.3g} u", is_given_ ? "leave max-edge at `auto`, or " : "",
                                  2.5 * std::sqrt(surface_.neighbourhoods.squared_reach(point)) / 2));
        inserted_near_.clear();
        for (u32 other : around)
            if (triangulation_.is_inserted(other)) inserted_near_.push_back(other);
        const int found = clusters_.meet(point, inserted_near_);
        ++cases_[static_cast<std::size_t>(found - 1)];
        if (!try_point(point, around, passes[0], false)) return;
        // Waiting points near the new triangles are tried again.
        waiting_.assign(1, point);
        while (!waiting_.empty()) {
            const u32 joined = waiting_.front();
            waiting_.pop_front();
            loose_.clear();
            for (u32 other : near(joined))
                if (triangulation_.is_loose(other)) loose_.push_back(other);
            for (u32 other : loose_)
                if (triangulation_.is_loose(other) && try_point(other, near(other), passes[0], true))
                    waiting_.push_back(other);
        }
    }

    static std::string at(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x(), p.y(), p.z()); }

    /// Returns whether the point is in a triangle now.
    bool try_point(u32 point, std::span<const u32> around, const Limits& limits, bool again) {
        const Outcome outcome = triangulation_.insert(point, around, !again, limits);
        if (outcome == Outcome::extra) {
            extra_ += !again;
            return false;
        }
        if (!again) clusters_.join(point);
        if (outcome == Outcome::loose) return false;
        splits_ += outcome == Outcome::split;
        clusters_.unite(point, triangulation_.partner());
        return true;
    }

    /// Tries points that wait and boundary points, in order. Returns whether the mesh changed.
    bool complete_once(const Limits& limits) {
        std::vector<u32> open;
        for (u32 point = 0; point < surface_.states.size(); ++point)
            if (triangulation_.is_loose(point) || triangulation_.is_open(point)) open.push_back(point);
        bool changed = false;
        for (u32 point : open) {
            const auto around = near(point);
            if (triangulation_.is_loose(point)) {
                const Outcome outcome = triangulation_.insert(point, around, true, limits);
                if (outcome == Outcome::loose || outcome == Outcome::extra) continue;
                splits_ += outcome == Outcome::split;
                changed = true;
            } else if (triangulation_.is_open(point))
                changed = triangulation_.complete(point, around, limits) || changed;
        }
        return changed;
    }

    Surface& surface_;
    double max_edge_;
    bool is_given_;
    Clusters clusters_;
    Triangulation triangulation_;
    Context& context_;
    std::vector<u32> near_, inserted_near_, loose_;
    std::deque<u32> waiting_;
    NeighbourBuffer buffer_;
    std::array<std::size_t, 4> cases_{};
    std::size_t splits_ = 0, extra_ = 0;
};

void require_in_range(const ClusterMeshParams& params) {
    const auto require_length = [](const char* name, const std::optional<Length>& length) {
        if (length && !(length->value() > 0 && std::isfinite(length->value())))
            throw Error("{} is {} u; it must be above 0", name, length->value())
                .hint(fmt::format("leave {} at `auto`", name));
    };
    require_length("max-edge", params.max_edge);
    require_length("slice", params.slice);
    const auto require_angle = [](const char* name, const Angle& angle, double most, bool inclusive) {
        const double degrees = angle.in_degrees();
        if (!(degrees > 0 && (inclusive ? degrees <= most : degrees < most)))
            throw Error("{} is {} degrees; it must be above 0 and {} {}", name, degrees,
                        inclusive ? "at most" : "below", most);
    };
    require_angle("max-normal-angle", params.max_normal_angle, 180, true);
    require_angle("neighbour-angle", params.neighbour_angle, 180, true);
    require_angle("overlap-angle", params.overlap_angle, 90, false);
}

/// The median distance between a point and its neighbour number `rank`, counted from 0 for the nearest one. A point
/// with fewer known neighbours uses the last one.
double median_distance(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, std::size_t rank) {
    std::vector<double> squares(points.size());
    for (u32 point = 0; point < points.size(); ++point) {
        const auto nearest = neighbourhoods.of(point);
        const u32 other = nearest[std::min(rank, nearest.size() - 1)];
        squares[point] = (points.positions[other] - points.positions[point]).squaredNorm();
    }
    return std::sqrt(median(squares));
}

/// The max_edge for hints: 2.5 spacings. Near-duplicates do not lower it, because the eighth nearest point gives the
/// spacing, too: on a square grid it is at the square root of 2.
double suggested_max_edge(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, double spacing) {
    return 2.5 * std::max(spacing, median_distance(points, neighbourhoods, 7) / std::numbers::sqrt2);
}

/// Throws Error if most points have no other point nearer than max_edge.
void require_neighbours(const DistinctPoints& points, const Neighbourhoods& neighbourhoods, double max_edge,
                        double spacing) {
    std::size_t alone = 0;
    for (u32 point = 0; point < points.size(); ++point) {
        const Vec3& nearest = points.positions[neighbourhoods.of(point)[0]];
        alone += !((nearest - points.positions[point]).squaredNorm() < max_edge * max_edge);
    }
    if (2 * alone > points.size())
        throw Error(
            "max-edge {:.3g} u is {:.2g} times the spacing {:.3g} u: {} of {} points would be clusters of one point",
            max_edge, max_edge / spacing, spacing, alone, points.size())
            .hint(fmt::format("try {:.3g} u, or leave max-edge at `auto`",
                              suggested_max_edge(points, neighbourhoods, spacing)));
}

/// The distance between the slicing planes. Throws Error if a given distance makes too many slices.
double slice_of(const DistinctPoints& points, const ClusterMeshParams& params, double max_edge) {
    constexpr double most = 1e9;
    const BoundingBox box = bounding_box(points.positions);
    const double extent = (box.high - box.low)[static_cast<int>(params.axis)];
    if (!params.slice) return std::max(0.25 * max_edge, extent / most);
    const double slice = params.slice->value();
    if (extent > most * slice)
        throw Error("slice {:.3g} u divides {:.3g} u into {:.3g} slices; at most {:.0e} are possible", slice, extent,
                    extent / slice, most)
            .hint("leave slice at `auto`, a quarter of max-edge");
    return slice;
}

double automatic_max_edge(const PointCloud& cloud, double spacing, Context& context) {
    double largest = 0, smallest = std::numeric_limits<double>::infinity();
    if (const Column* sizes = cloud.columns.find("bin-size"); sizes && sizes->components() == 1)
        for (std::size_t row = 0; row < sizes->rows(); ++row) {
            const double size = sizes->number(row);
            if (!(size > 0 && std::isfinite(size))) continue;
            largest = std::max(largest, size);
            smallest = std::min(smallest, size);
        }
    if (largest == 0) return 2.5 * spacing;
    if (largest > 2 * smallest)
        context.warn(
            fmt::format("the column 'bin-size' has values from {:.3g} to {:.3g} u; max-edge follows the largest value "
                        "and may bridge gaps in the finer parts; give max-edge, or thin with one voxel size",
                        smallest, largest));
    return std::max(2.3 * largest, 2.5 * spacing);
}

/// Lists the triangles of the fans in surface.triangles, in the order of their lowest points.
void list_triangles(Surface& surface) {
    surface.triangles.clear();
    surface.passes.clear();
    for (u32 point = 0; point < surface.states.size(); ++point) {
        const std::size_t before = surface.triangles.size();
        surface.fans.any(point, [&](const growing::Fans::LinkEdge& edge) {
            if (edge.first > point && edge.last > point) surface.triangles.push_back({point, edge.first, edge.last});
            return false;
        });
        std::sort(surface.triangles.begin() + static_cast<std::ptrdiff_t>(before), surface.triangles.end());
    }
    surface.passes.resize(surface.triangles.size());
    std::ranges::fill(surface.passes, growing::Pass(0));
}

/// Flips edges as edge_flip() does, except where the new triangles would intersect others. Returns the number of flips.
std::size_t flip_edges(Surface& surface, double max_edge, Context& context) {
    list_triangles(surface);
    TriangleMesh mesh;
    mesh.positions = Array<Vec3>(surface.positions);
    mesh.triangles = Array<Triangle>(surface.triangles);
    ContextOptions options;
    options.threads = context.threads();
    options.is_cancelled = [&] { return context.cancelled(); };
    Context silent(std::move(options));
    EdgeFlipParams params;
    params.max_edge = Length(max_edge);
    const EdgeFlipResult flipped = edge_flip(mesh, params, silent);
    growing::NearTriangles near;
    std::size_t flips = 0;
    for (const auto& [a, b, c, d] : flipped.flips) {
        growing::Fans& fans = surface.fans;
        const std::array<Triangle, 2> before{{{a, b, c}, {b, a, d}}}, after{{{c, a, d}, {d, b, c}}};
        // One of the triangles may not exist, because an earlier flip was left out.
        if (fans.left_of(a, b) != c || fans.left_of(b, a) != d || fans.left_of(c, d) != growing::invalid_index ||
            fans.left_of(d, c) != growing::invalid_index)
            continue;
        for (const Triangle& triangle : before) fans.remove(triangle);
        const bool intersects = std::ranges::any_of(after, [&](const Triangle& triangle) {
            near.gather_near(surface, triangle);
            return near.intersect(surface, triangle);
        });
        for (const Triangle& triangle : intersects ? before : after) fans.add(triangle);
        flips += !intersects;
    }
    return flips;
}

/// Of every two triangles that intersect, removes the one whose smallest angle is smaller. Then removes extra fans.
/// Returns the number of removed triangles.
std::size_t remove_intersecting(Surface& surface, Context& context) {
    const auto& p = surface.positions;
    const TriangleTree tree(p, surface.triangles, context.threads());
    const SelfIntersections found = self_intersections(p, surface.triangles, tree, context);
    if (found.count == 0) return 0;
    // The sine of the smallest angle is the shortest side over the diameter of the circumcircle.
    const auto roundness = [&](u32 row) {
        const auto& [a, b, c] = surface.triangles[row];
        const Vec3 u = p[b] - p[a], v = p[c] - p[a];
        const double x = u.norm(), y = v.norm(), z = (u - v).norm();
        return u.cross(v).norm() * std::min({x, y, z}) / (x * y * z);
    };
    std::vector<bool> is_removed(surface.triangles.size(), false);
    std::vector<Triangle> removed;
    for (const auto& [one, other] : found.pairs) {
        if (is_removed[one] || is_removed[other]) continue;
        const u32 row = roundness(one) < roundness(other) ? one : other;
        is_removed[row] = true;
        removed.push_back(surface.triangles[row]);
    }
    for (const Triangle& triangle : removed) {
        surface.fans.remove(triangle);
        for (u32 corner : triangle)
            surface.states[corner] =
                surface.fans.empty(corner) ? growing::PointState::unused : growing::PointState::front;
    }
    const std::size_t count = removed.size();
    surface.drop(std::move(removed));
    return count + growing::remove_extra_fans(surface);
}

/// Joins clusters of level 2 whose points are corners of one triangle, because the completion makes such triangles.
void unite_along_triangles(Clusters& clusters, const Surface& surface) {
    for (const auto& [a, b, c] : surface.triangles) {
        clusters.unite(a, b);
        clusters.unite(b, c);
    }
}

/// Adds the columns `cluster-1` and `cluster-2`. Replaces older columns of these names, with a warning.
void add_clusters(Clusters& clusters, const growing::FinishedMesh& finished, TriangleMesh& mesh, Context& context) {
    const auto column = [&](const char* name, const Clusters::Numbers& numbers) {
        Array<u32> values(mesh.positions.size());
        for (u32 point = 0; point < numbers.of_point.size(); ++point)
            if (const u32 vertex = finished.vertex_of_point[point]; vertex != growing::invalid_index)
                values[vertex] = numbers.of_point[point];
        add_column(mesh.vertex_columns, Column(name, 1, Buffer<u32>(std::move(values))), context);
    };
    column("cluster-1", clusters.first_level());
    column("cluster-2", clusters.second_level());
}

/// Reports the metrics that plugin.cpp declares, and warnings and doubts.
void report(const ClusterMeshResult& result, std::size_t points, Context& context) {
    const auto count = [&](std::string_view name, std::size_t value) {
        context.metric(name, static_cast<double>(value));
    };
    for (std::size_t i = 0; i < 4; ++i) count(fmt::format("case-{}", i + 1), result.cases[i]);
    count("splits", result.splits);
    count("extra", result.extra);
    count("clusters", result.clusters);
    count("loops", result.loops);
    count("boundary-edges", result.boundary_edges);
    count("components", result.components);
    count("triangles", result.mesh.triangles.size());
    count("unused-points", result.unused_points);
    count("duplicates", result.duplicates);
    count("closed-holes", result.closed_holes);
    count("removed-triangles", result.removed_triangles);
    count("flips", result.flips);
    context.metric("max-edge", result.max_edge, Unit::length);

    constexpr std::size_t points_per_unused = 50;
    std::string text = fmt::format(
        "{} of {} distinct points are in no triangle; thin the scan, remove its noise first, or enlarge max-edge",
        result.unused_points, points);
    if (points_per_unused * result.unused_points > points)
        context.doubt(std::move(text));
    else if (200 * result.unused_points > points)
        context.warn(std::move(text));
    for (std::string& doubt : doubts_about_surface(result.mesh)) context.doubt(std::move(doubt));
}

}  // namespace

ClusterMeshResult cluster_mesh(const PointCloud& cloud, const ClusterMeshParams& params, Context& context) {
    require_finite(cloud.positions.span());
    require_in_range(params);
    const Vec3 up = direction_of(params.up, "up");
    const DistinctPoints points = growing::distinct_points_of(cloud.positions.span());
    growing::require_area(points, cloud.size());
    const Neighbourhoods neighbourhoods(points, context.threads());
    context.check_cancelled();
    context.progress(0.15);
    const double spacing = median_distance(points, neighbourhoods, 0);
    ClusterMeshResult result;
    result.max_edge = params.max_edge ? params.max_edge->value() : automatic_max_edge(cloud, spacing, context);
    require_neighbours(points, neighbourhoods, result.max_edge, spacing);
    const Array<u32> order = insertion_order(
        points, neighbourhoods, static_cast<int>(params.axis), slice_of(points, params, result.max_edge),
        params.in_plane == ClusterMeshParams::InPlane::paper ? InPlane::paper : InPlane::nearest, context);
    Array<double> radii(points.size());
    std::ranges::fill(radii, result.max_edge);
    Array<double> density(points.size());
    std::ranges::fill(density, result.max_edge);
    Surface surface(points, neighbourhoods, growing::principal_normals(points, neighbourhoods, context.threads()),
                    std::move(radii), std::move(density), false);
    context.progress(0.3);

    const elementary::Turn overlap = elementary::turn_of(params.overlap_angle.in_radians());
    const WinnerLimits winner{elementary::turn_of(params.max_normal_angle.in_radians()).cosine - 1e-9,
                              elementary::turn_of(params.neighbour_angle.in_radians()).cosine + 1e-9, overlap.cosine,
                              overlap.sine / overlap.cosine};
    Insertion insertion(surface, result.max_edge, params.max_edge.has_value(), up, winner, context);
    insertion.insert_all(order);
    context.progress(0.7);
    insertion.complete();
    list_triangles(surface);
    if (surface.triangles.empty())
        throw Error("there is no triangle with edges below max-edge {:.3g} u; the {} points have a spacing of {:.3g} u",
                    result.max_edge, points.size(), spacing)
            .hint(fmt::format("try max-edge {:.3g} u; thin the scan with larger voxels if it is noisy",
                              suggested_max_edge(points, neighbourhoods, spacing)));
    result.removed_triangles = growing::remove_extra_fans(surface);
    constexpr std::size_t few_edges = 4;
    result.closed_holes = growing::close_small_holes(surface, few_edges, context, result.max_edge);
    result.removed_triangles += growing::remove_extra_fans(surface);
    // The circumradius of an equilateral triangle with edges of length max_edge, in units of max_edge.
    const double largest_radius = 1 / std::sqrt(3.0);
    const growing::NarrowHoles narrow =
        growing::close_narrow_holes(surface, {largest_radius, few_edges, std::numbers::pi, result.max_edge}, context);
    result.closed_holes += narrow.closed;
    result.removed_triangles += narrow.replaced;
    result.flips = flip_edges(surface, result.max_edge, context);
    list_triangles(surface);
    result.removed_triangles += remove_intersecting(surface, context);
    const growing::Components components = growing::find_components(surface);
    Array<u32> groups(points.size());
    std::ranges::fill(groups, growing::invalid_index);
    growing::orient_outwards(surface, components, groups, up);
    context.progress(0.9);

    growing::FinishedMesh finished = growing::finish_mesh(cloud, surface);
    face_outwards(finished.mesh, context);
    insertion.count(result);
    unite_along_triangles(insertion.clusters(), surface);
    add_clusters(insertion.clusters(), finished, finished.mesh, context);
    result.clusters = insertion.clusters().first_level().count;
    result.components = components.count;
    result.duplicates = points.repeats.size();
    result.unused_points = points.size() - finished.rows.size();
    result.rows = std::move(finished.rows);
    result.mesh = std::move(finished.mesh);
    const MeshTopology shape = topology(result.mesh);
    result.loops = shape.boundary_loops;
    result.boundary_edges = shape.boundary_edges;
    report(result, points.size(), context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
