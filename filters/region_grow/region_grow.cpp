// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/region_grow.hpp"

#include <fmt/format.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>

#include "region_grow/beside_lines.hpp"
#include "region_grow/boundaries.hpp"
#include "region_grow/given_normals.hpp"
#include "region_grow/growth.hpp"
#include "region_grow/line_edges.hpp"
#include "region_grow/patch_edges.hpp"
#include "region_grow/search_radii.hpp"
#include "scanmill/base/elementary.hpp"
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/points.hpp"
#include "scanmill/geometry/distance/sides.hpp"
#include "scanmill/geometry/growing/components.hpp"
#include "scanmill/geometry/growing/holes.hpp"
#include "scanmill/geometry/growing/restored_edges.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

namespace scanmill {

namespace {

using namespace growing;

void require_in_range(const RegionGrowParams& params, std::size_t points) {
    const double least = params.min_angle.in_degrees(), most = params.max_normal_angle.in_degrees();
    if (!(least >= 0 && least < 60))
        throw Error("min-angle is {} degrees; it must be at least 0 and below 60, the angle of an equilateral triangle",
                    least)
            .hint("`10 deg` suits most scans");
    if (!(most > 0 && most <= 180))
        throw Error("max-normal-angle is {} degrees; it must be above 0 and at most 180", most)
            .hint("`90 deg` suits most scans");
    if (params.search_radius) {
        const double radius = params.search_radius->value();
        if (!(radius > 0 && std::isfinite(radius)))
            throw Error("search-radius is {}; it must be above 0", radius)
                .hint("leave search-radius out to derive it from the density of the points");
    }
    if (params.noise) {
        const double noise = params.noise->value();
        if (!(noise >= 0 && std::isfinite(noise)))
            throw Error("noise is {}; it must be at least 0", noise)
                .hint("leave noise out to estimate it; with 0, every triangle is judged by itself");
    }
    if (params.close_holes > 100)
        throw Error("close-holes is {}; at most 100 edges are closed", params.close_holes)
            .hint("fill-holes closes loops of any number of edges");
    if (params.start && *params.start >= points)
        throw Error("start is row {}; the cloud has {} points, counted from 0", *params.start, points)
            .hint("leave start at `auto` to begin at the flattest point");
}

[[noreturn]] void refuse_start(u32 row) {
    throw Error("no seed triangle at row {}: no two other points near it satisfy the limits", row)
        .hint("start at another point, on a flat and evenly sampled part, or leave start at `auto`");
}

/// Refuses a cloud without any seed triangle. The hint gives a voxel size that would merge several layers into one
/// sheet.
[[noreturn]] void refuse_all(const Surface& surface, const RegionGrowParams& params, LengthUnit unit,
                             unsigned threads) {
    const std::string radius = params.search_radius ? fmt::format("search-radius {} u", params.search_radius->value())
                                                    : std::string("the automatic search-radius");
    throw Error("no seed triangle among the {} distinct points: none has angles of at least {} within {}",
                surface.points.size(), params.min_angle.text(), radius)
        .hint(fmt::format(
            "enlarge search-radius, or lessen min-angle; if the points lie in layers, thin with voxels of {:.3g} {}",
            2 * equivalent_voxel_size(surface, threads), symbol(unit)));
}

/// The given limits, and the relaxed ones under which parked edges are retried.
std::vector<Limits> limits_of(const RegionGrowParams& params) {
    struct Round {
        double angle_factor, normal_angle_factor, point_angle, sharp_point_angle, radius_factor;
    };
    // The limits to the points' own normals keep sheets apart and boundaries open.
    constexpr std::array<Round, 4> rounds{{{1, 1, 60, 85, 1},
                                           {2.0 / 3, 7.0 / 6, 75, 110, 1.1},
                                           {1.0 / 3, 4.0 / 3, 80, 180, 1.15},
                                           {1.0 / 30, 4.0 / 3, 80, 180, 1.15}}};
    std::vector<Limits> limits;
    const auto cosine = [](double radians) { return elementary::turn_of(std::min(std::numbers::pi, radians)).cosine; };
    const auto normal_cosine = [&](const Round& round) {
        return cosine(params.max_normal_angle.in_radians() * round.normal_angle_factor) - 1e-9;
    };
    for (const Round& round : rounds) {
        const double least_angle = params.min_angle.in_radians() * round.angle_factor;
        limits.push_back({elementary::turn_of(least_angle).sine * (1 - 1e-12), normal_cosine(round),
                          normal_cosine(rounds.back()), cosine(Angle::degrees(round.point_angle).in_radians()),
                          cosine(Angle::degrees(round.sharp_point_angle).in_radians()), round.radius_factor,
                          static_cast<Pass>(limits.size())});
    }
    return limits;
}

/// Largest dihedral deviation with which narrow holes are closed, in radians. If max-normal-angle is at least 90
/// degrees, no patch ends at a sharp edge, and tips of any angle are closed. Otherwise surfaces end where the last
/// round of growth ends them.
double largest_dihedral(const RegionGrowParams& params) {
    const double angle = params.max_normal_angle.in_radians();
    constexpr double right_angle = std::numbers::pi / 2;
    return angle >= right_angle * (1 - 1e-12) ? 2 * right_angle : angle * 4 / 3;
}

SearchRadii search_radii(const PointCloud& cloud, const DistinctPoints& points, const Neighbourhoods& neighbourhoods,
                         const PointNormals& normals, const RegionGrowParams& params, Context& context) {
    const Array<double> given = params.search_radius ? Array<double>() : given_voxel_sizes(cloud, points, context);
    SearchRadii found =
        automatic_radii(points, neighbourhoods, normals.directions, normals.variation, given, context.threads());
    if (params.search_radius) {
        std::ranges::fill(found.radii, params.search_radius->value());
        return found;
    }
    warn_of_contradiction(given, found, cloud.frame.unit, context);
    context.metric("known-bins", static_cast<double>(found.known));
    return found;
}

std::optional<u32> point_of(const DistinctPoints& points, const PointCloud& cloud, std::optional<u32> row) {
    if (!row) return std::nullopt;
    return static_cast<u32>(std::ranges::find(points.positions, cloud.positions[*row]) - points.positions.begin());
}

/// Metrics as plugin.cpp declares them, except `known-bins`.
void report_metrics(const RegionGrowResult& result, Context& context) {
    const auto count = [&](std::string_view name, std::size_t value) {
        context.metric(name, static_cast<double>(value));
    };
    count("triangles", result.mesh.triangles.size());
    count("components", result.components);
    count("loops", result.loops);
    count("holes", result.holes);
    count("thin-loops", result.thin_loops);
    count("unused-points", result.unused_points);
    count("duplicates", result.duplicates);
    count("patch-edges", result.patch_edges);
    count("creases", result.creases);
    count("corners", result.corners);
    count("closed-holes", result.closed_holes);
    count("removed-triangles", result.removed_triangles);
    count("ambiguous", result.ambiguous_loops);
    count("without-area", result.triangles_without_area);
    context.metric("noise", result.noise, Unit::length);
    count("relaxed-triangles", static_cast<std::size_t>(std::ranges::count_if(
                                   result.passes, [](u8 pass) { return pass > 0 && pass < closing_pass; })));
}

void report_unused(const RegionGrowResult& result, const Surface& surface, Context& context) {
    const std::size_t points = surface.points.size(), unused = result.unused_points;
    if (200 * unused <= points) return;
    std::string text = fmt::format(
        "{} of {} distinct points are in no triangle; thin the scan, or remove its noise first", unused, points);
    constexpr std::size_t points_per_unused = 50;  // clean models leave up to 1.4 %, noisy scans 4.6 % and more
    if (points_per_unused * unused > points)
        context.doubt(std::move(text));
    else
        context.warn(std::move(text));
}

/// Number of creases that the triangles make by themselves, without regard to noise. Pre: `mesh` has no declared sharp
/// edges.
std::size_t creases_of_triangles(const TriangleMesh& mesh, FeatureParams params, const FeatureLines& lines,
                                 const Context& context) {
    if (lines.counts.unreliable == 0) return lines.counts.creases;
    params.noise = 0;
    return find_features(mesh, params, context).counts.creases;
}

/// Creases of an object are long polylines: on the clean scans of the tests there is at most one per 80 edges. Where
/// triangles are judged by themselves, noise makes creases of one or two edges everywhere: one per 11 edges at a noise
/// of 0.05 % of the diagonal. A curved object with few points looks the same: a figure eight of 317 points has 89
/// creases on 951 edges.
void doubt_roughness(const RegionGrowResult& result, std::size_t creases, Context& context) {
    constexpr std::size_t edges_per_crease = 20;
    const std::size_t edges = 3 * result.mesh.triangles.size() / 2;
    constexpr std::size_t few_edges = 10'000;
    if (edges > few_edges && edges_per_crease * creases > edges)
        context.doubt(
            fmt::format("the triangles by themselves make {} creases on {} edges: the surface is rough at the distance "
                        "of its points, like a noisy scan; thin the scan with larger voxels, or smooth it first",
                        creases, edges));
}

void doubt_seams(const Surface& surface, Context& context) {
    if (!surface.oriented) return;
    if (const std::size_t points = points_at_seams(surface); points > 2)
        context.doubt(
            fmt::format("the surface ends at {} points where the normals of the column 'normal' reverse from one point "
                        "to the next, "
                        "as normals oriented towards a camera do; drop the column if the surface continues there",
                        points));
}

void doubt_thin_parts(const RegionGrowResult& result, const ThinParts& thin, Context& context) {
    if (thin.loops == 0) return;
    const std::string_view unit = symbol(result.mesh.frame.unit);
    context.doubt(
        fmt::format("{} of {} boundary loops {} where two sides or layers are less than {} voxels apart; the nearest "
                    "are {:.3g} {} apart, with voxels of {:.3g} {}: the surface may continue there; use smaller voxels "
                    "where the object is thin, larger ones where the scan is noisy",
                    thin.loops, result.loops, by_count(thin.loops, "lies", "lie"), thin_in_voxels, thin.least, unit,
                    thin.voxel, unit));
}

/// The params with `start` as a row of the prepared cloud.
RegionGrowParams for_prepared(RegionGrowParams params, const PreparedLines& lines) {
    if (!params.start) return params;
    const auto row = std::ranges::lower_bound(lines.rows, *params.start);
    if (row == lines.rows.end() || *row != *params.start)
        throw Error("start is row {}, a point that is left out because a line is near", *params.start)
            .hint("start at another point, or leave start at `auto`");
    params.start = static_cast<u32>(row - lines.rows.begin());
    return params;
}

/// Points beside lines take the normal of their side, with the sign of their own. The limits for points at sharp edges
/// apply, because with noise triangles beside a line are steeper than elsewhere.
void use_normals_of_sides(const EdgeSides& sides, PointNormals& normals) {
    for (u32 point = 0; point < normals.directions.size(); ++point) {
        const Vec3 normal = sides.normal(point);
        if (normal.isZero()) continue;
        Vec3& own = normals.directions[point];
        own = own.dot(normal) < 0 ? Vec3(-normal) : normal;
        normals.variation[point] = std::nextafter(sharp_variation, 1.0f);
    }
}

/// `lines`: nullptr, or the lines whose cloud is `cloud`.
RegionGrowResult grow(const PointCloud& cloud, const PreparedLines* lines, const RegionGrowParams& params,
                      Context& context) {
    const DistinctPoints points = distinct_points_of(cloud.positions.span());
    growing::require_area(points, cloud.size());
    context.progress(0.05);
    context.check_cancelled();
    const Neighbourhoods neighbourhoods(points, context.threads());
    context.check_cancelled();
    context.progress(0.3);
    PointNormals normals = principal_normals(points, neighbourhoods, context.threads());
    FixedEdges edges;
    EdgeSides sides;
    std::optional<BesideLines> beside;
    if (lines) {
        const std::vector<std::array<u32, 2>> pairs = edges_of(*lines, points);
        edges = FixedEdges(pairs, points.size());
        sides = EdgeSides(points, neighbourhoods, edges, pairs, lines->spacings);
        beside.emplace(points, edges, context.threads());
        // Triangles agree with any normal at tips.
        for (u32 point = 0; point < points.size(); ++point)
            if (edges.at(point)) normals.variation[point] = 1;
    }
    const GivenNormals given = take_given_normals(cloud, points, neighbourhoods, normals, context);
    const bool oriented = given.signs_count;
    if (lines) use_normals_of_sides(sides, normals);
    SearchRadii radii = beside ? beside->radii_of_all(search_radii(cloud, beside->points(), beside->neighbourhoods(),
                                                                   beside->normals_of(normals), params, context))
                               : search_radii(cloud, points, neighbourhoods, normals, params, context);
    Surface surface(points, neighbourhoods, std::move(normals), std::move(radii.radii), std::move(radii.by_density),
                    oriented);
    surface.fixed_edges = std::move(edges);
    surface.edge_sides = std::move(sides);
    context.progress(0.4);

    const std::vector<Limits> limits = limits_of(params);
    const Score score = params.score == RegionGrowParams::Score::midpoint ? Score::midpoint : Score::circumradius;
    Growth growth(surface, score, limits, context);
    Array<u32> groups;
    if (!grow_all_components(surface, growth, point_of(points, cloud, params.start), groups))
        refuse_start(*params.start);
    if (surface.triangles.empty()) refuse_all(surface, params, cloud.frame.unit, context.threads());
    context.progress(0.9);

    RegionGrowResult result;
    if (params.close_holes >= 3) {
        result.closed_holes = close_small_holes(surface, params.close_holes, context);
        result.removed_triangles = remove_extra_fans(surface);
        // The removal may have left small holes. With single fans, closing them cannot make new extra fans.
        const NarrowHoles narrow = close_narrow_holes(
            surface, {largest_empty_circle * limits.back().radius_factor, params.close_holes, largest_dihedral(params)},
            context);
        result.closed_holes += narrow.closed;
        result.removed_triangles += narrow.replaced;
    } else
        result.removed_triangles = remove_extra_fans(surface);
    if (lines)
        result.removed_triangles +=
            restore_fixed_edges(surface, largest_empty_circle * limits.back().radius_factor, context);
    PointChooser chooser(surface, score);
    const std::vector<PatchEdge> patch_edges = find_patch_edges(surface, chooser, limits.front(), context);
    context.check_cancelled();
    const Components components = find_components(surface);
    if (!oriented) orient_outwards(surface, components, groups);
    if (!given.doubtful.empty()) orient_like_normals(surface, components, given.doubtful);

    FinishedMesh finished = finish_mesh(cloud, surface);
    if (!oriented && given.doubtful.empty()) face_outwards(finished.mesh, context);
    finished.mesh.sharp_edges = segments_in(finished, surface);
    FeatureParams feature_params;
    feature_params.sharp_angle = params.sharp_angle;
    feature_params.noise = params.noise;
    feature_params.exact_declared = lines != nullptr;
    FeatureLines found = find_features(finished.mesh, feature_params, context);
    const std::size_t by_themselves = creases_of_triangles(finished.mesh, feature_params, found, context);
    set_sharp_edges(finished, found, patch_edges, segments_in(finished, surface));
    set_normals_beyond(found.graph, finished, patch_edges);
    result.mesh = std::move(finished.mesh);
    result.rows = std::move(finished.rows);
    result.passes = std::move(surface.passes);
    result.features = std::move(found.graph);
    result.loops = found.counts.holes + found.counts.boundaries;
    result.holes = found.counts.holes;
    const ThinParts thin = params.search_radius ? ThinParts() : find_thin_parts(surface, components, context);
    result.thin_loops = thin.loops;
    result.creases = found.counts.creases;
    result.noise = found.noise;
    result.corners = found.counts.corners;
    result.ambiguous_loops = found.counts.ambiguous;
    result.triangles_without_area = found.counts.without_area;
    result.patch_edges = patch_edges.size();
    result.components = components.count;
    result.duplicates = points.repeats.size();
    result.unused_points = points.size() - result.rows.size();
    report_metrics(result, context);
    report_unused(result, surface, context);
    doubt_roughness(result, by_themselves, context);
    for (std::string& sentence : doubts(found.counts)) context.warn(std::move(sentence));
    doubt_seams(surface, context);
    doubt_thin_parts(result, thin, context);
    if (lines) report_lines(*lines, surface, result, context);
    context.progress(1);
    return result;
}

void require_valid(const PointCloud& cloud, const RegionGrowParams& params) {
    require_finite(cloud.positions.span());
    require_in_range(params, cloud.size());
}

}  // namespace

RegionGrowResult region_grow(const PointCloud& cloud, const RegionGrowParams& params, Context& context) {
    require_valid(cloud, params);
    return grow(cloud, nullptr, params, context);
}

RegionGrowResult region_grow(const PointCloud& cloud, const FeatureGraph& lines, const RegionGrowParams& params,
                             Context& context) {
    require_valid(cloud, params);
    const PreparedLines prepared = prepare_lines(cloud, lines, context);
    RegionGrowResult result = grow(prepared.cloud, &prepared, for_prepared(params, prepared), context);
    for (u32& row : result.rows) row = prepared.rows[row];
    return result;
}

}  // namespace scanmill
