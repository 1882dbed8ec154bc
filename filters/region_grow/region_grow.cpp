// SPDX-License-Identifier: GPL-3.0-or-later
#include "region_grow/region_grow.hpp"

#include <Eigen/Geometry>

#include <fmt/format.h>
#include <algorithm>
#include <cmath>
#include <numbers>
#include "scanmill/base/error.hpp"
#include "scanmill/base/text.hpp"
#include "scanmill/geometry/mesh/feature_lines.hpp"

#include "region_grow/components.hpp"
#include "region_grow/finished_mesh.hpp"
#include "region_grow/growth.hpp"
#include "region_grow/holes.hpp"
#include "region_grow/normals.hpp"
#include "region_grow/search_radii.hpp"
#include "region_grow/surface.hpp"
#include "region_grow/thin_parts.hpp"
#include "scanmill/data/frame.hpp"
#include "scanmill/data/points.hpp"

namespace scanmill {

namespace {

using namespace growing;

constexpr const char* few_points_hint =
    "look at the file with `scanmill info`; thin less coarsely if the scan was thinned";

void require_in_range(const RegionGrowParams& params, std::size_t points) {
    const double least = params.min_angle.in_degrees(), bend = params.max_normal_angle.in_degrees();
    if (!(least >= 0 && least < 60))
        throw Error("min-angle is {} degrees; it must be at least 0 and below 60, what no triangle exceeds", least);
    if (!(bend > 0 && bend <= 180))
        throw Error("max-normal-angle is {} degrees; it must be above 0 and at most 180", bend);
    if (params.search_radius) {
        const double radius = params.search_radius->value();
        if (!(radius > 0 && std::isfinite(radius))) throw Error("search-radius is {}; it must be above 0", radius);
    }
    if (params.close_holes > 100) throw Error("close-holes is {}; at most 100 edges are closed", params.close_holes);
    if (params.start && *params.start >= points)
        throw Error("start is row {}; the cloud has {} points, counted from 0", *params.start, points);
}

void require_area(const Samples& samples, std::size_t points) {
    if (points == 0) throw Error("needs at least 3 distinct points; the cloud has none").hint(few_points_hint);
    if (samples.size() < 3)
        throw Error("needs at least 3 distinct points; the cloud has {} in {} rows", samples.size(), points)
            .hint(few_points_hint);
    // The place farthest from the first, and the one farthest from the line through both.
    const auto& p = samples.positions;
    const auto farthest = [&](const auto& distance) { return *std::ranges::max_element(p, {}, distance); };
    const Vec3 end = farthest([&](const Vec3& x) { return (x - p[0]).squaredNorm(); });
    const Vec3 along = (end - p[0]).normalized();
    const auto off_line = [&](const Vec3& x) { return (x - p[0]).cross(along).norm(); };
    const double off = off_line(farthest(off_line));
    if (off <= 1e-9 * (end - p[0]).norm())
        throw Error("all {} distinct points lie on one line, to within {:.2g} u; a surface needs some off it",
                    samples.size(), off)
            .hint("scan more than a single profile, or check that the columns x, y and z are read as such");
}

void refuse_start(u32 row) {
    throw Error("no triangle can start at row {}: no two other points near it make one within the limits", row)
        .hint("start at another point, on a flat and evenly sampled part, or leave start to `auto`");
}

void refuse_all(const Surface& surface, const RegionGrowParams& params, LengthUnit unit, unsigned threads) {
    const Samples& samples = surface.samples;
    const std::string radius = params.search_radius ? fmt::format("search-radius {} u", params.search_radius->value())
                                                    : std::string("the automatic search-radius");
    throw Error("no three of the {} distinct points make a triangle with angles of at least {} and {}", samples.size(),
                params.min_angle.text(), radius)
        .hint(fmt::format("enlarge search-radius, or lessen min-angle; points in layers, thin with bins of {:.3g} {}",
                          2 * bins_as_dense(surface, threads), symbol(unit)));
}

void count_all(const RegionGrowResult& result, Context& context) {
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
    count("relaxed-triangles", static_cast<std::size_t>(std::ranges::count_if(
                                   result.passes, [](u8 pass) { return pass > 0 && pass < closing_pass; })));
}

void warn_of_unused(const RegionGrowResult& result, const Surface& surface, Context& context) {
    const std::size_t places = surface.samples.size(), unused = result.unused_points;
    if (200 * unused > places)
        context.warn(fmt::format(
            "{} of {} distinct points are in no triangle; thin the scan, or remove its noise first", unused, places));
}

void warn_of_thin_parts(const RegionGrowResult& result, const ThinParts& thin, Context& context) {
    if (thin.loops == 0) return;
    const std::string_view unit = symbol(result.mesh.frame.unit);
    context.warn(fmt::format(
        "{} of {} boundary loops {} where two sides, or layers, are nearer to each other than {} bins, the "
        "nearest {:.3g} "
        "{} with bins of {:.3g} {}: the surface may go on there; thin less where the object is thin, more "
        "where the scan "
        "is noisy",
        thin.loops, result.loops, by_count(thin.loops, "lies", "lie"), thin_in_bins, thin.least, unit, thin.bin, unit));
}

void warn_of_seams(const Surface& surface, Context& context) {
    if (!surface.oriented) return;
    if (const std::size_t places = places_at_seams(surface); places > 2)
        context.warn(fmt::format(
            "the surface ends at {} points where normals of the column 'normal' turn to the opposite from one point to "
            "the next, as those do that were turned towards a camera; drop the column if it goes on there",
            places));
}

void report(const RegionGrowResult& result, const FeatureCounts& lines, const Surface& surface, const ThinParts& thin,
            Context& context) {
    count_all(result, context);
    warn_of_unused(result, surface, context);
    for (std::string& sentence : doubts(lines)) context.warn(std::move(sentence));
    warn_of_seams(surface, context);
    warn_of_thin_parts(result, thin, context);
}

/// The given limits and those that parked edges are retried under.
std::vector<Limits> limits_of(const RegionGrowParams& params) {
    struct Round {
        double angle, bend, point, rough, reach;
    };
    // Angles shrink and bends grow by these factors. The limits to the points' own normals keep sheets apart and
    // ends open.
    constexpr std::array<Round, 4> rounds{{{1, 1, 60, 85, 1},
                                           {2.0 / 3, 7.0 / 6, 75, 110, 1.1},
                                           {1.0 / 3, 4.0 / 3, 80, 180, 1.15},
                                           {1.0 / 30, 4.0 / 3, 80, 180, 1.15}}};
    constexpr double degree = 3.14159265358979323846 / 180;
    std::vector<Limits> limits;
    const auto bend_cosine = [&](const Round& round) {
        return std::cos(std::min(180 * degree, params.max_normal_angle.in_radians() * round.bend)) - 1e-9;
    };
    for (const Round& round : rounds) {
        limits.push_back({std::sin(params.min_angle.in_radians() * round.angle) * (1 - 1e-12), bend_cosine(round),
                          bend_cosine(rounds.back()), std::cos(round.point * degree), std::cos(round.rough * degree),
                          round.reach, static_cast<Pass>(limits.size())});
    }
    return limits;
}

/// Of what closes narrow holes, in radians. From 90 degrees on no patch is meant to end at a sharp edge, and a tip is
/// closed whatever its angle; below, surfaces end at what growth would not bend over in its last round.
double largest_bend(const RegionGrowParams& params) {
    const double angle = params.max_normal_angle.in_radians();
    constexpr double right_angle = std::numbers::pi / 2;
    return angle >= right_angle * (1 - 1e-12) ? 2 * right_angle : angle * 4 / 3;
}

SearchRadii search_radii(const PointCloud& cloud, const Samples& samples, const Neighbourhoods& neighbourhoods,
                         const PointNormals& normals, const RegionGrowParams& params, Context& context) {
    const Array<double> thinned = params.search_radius ? Array<double>() : thinned_bins(cloud, samples, context);
    SearchRadii found =
        automatic_radii(samples, neighbourhoods, normals.directions, normals.roughness, thinned, context.threads());
    if (params.search_radius) {
        std::ranges::fill(found.radii, params.search_radius->value());
        return found;
    }
    tell_contradiction(thinned, found, cloud.frame.unit, context);
    context.metric("known-bins", static_cast<double>(found.known));
    return found;
}

std::optional<u32> place_of(const Samples& samples, const PointCloud& cloud, std::optional<u32> row) {
    if (!row) return std::nullopt;
    return static_cast<u32>(std::ranges::find(samples.positions, cloud.positions[*row]) - samples.positions.begin());
}

}  // namespace

RegionGrowResult region_grow(const PointCloud& cloud, const RegionGrowParams& params, Context& context) {
    require_finite(cloud.positions.span());
    require_in_range(params, cloud.size());
    const Samples samples = distinct_samples(cloud.positions.span());
    require_area(samples, cloud.size());
    context.progress(0.05);
    context.check_cancelled();
    const Neighbourhoods neighbourhoods(samples, context.threads());
    context.check_cancelled();
    context.progress(0.3);
    PointNormals normals = principal_normals(samples, neighbourhoods, context.threads());
    const GivenNormals given = take_given_normals(cloud, samples, neighbourhoods, normals, context);
    const bool oriented = given.signs_count;
    SearchRadii radii = search_radii(cloud, samples, neighbourhoods, normals, params, context);
    Surface surface(samples, neighbourhoods, std::move(normals), std::move(radii.radii), std::move(radii.by_density),
                    oriented);
    context.progress(0.4);

    const std::vector<Limits> limits = limits_of(params);
    const Score score = params.score == RegionGrowParams::Score::midpoint ? Score::midpoint : Score::circumradius;
    Growth growth(surface, score, limits, context);
    Array<u32> groups;
    if (!grow_all_pieces(surface, growth, place_of(samples, cloud, params.start), groups)) refuse_start(*params.start);
    if (surface.triangles.empty()) refuse_all(surface, params, cloud.frame.unit, context.threads());
    context.progress(0.9);

    RegionGrowResult result;
    if (params.close_holes >= 3) {
        result.closed_holes = close_small_holes(surface, params.close_holes, context);
        result.removed_triangles = remove_pinches(surface);
        // What was removed may have left a small hole; at single fans closing makes no new pinch.
        const NarrowHoles narrow = close_narrow_holes(
            surface, {largest_circle * limits.back().reach, params.close_holes, largest_bend(params)}, context);
        result.closed_holes += narrow.closed;
        result.removed_triangles += narrow.replaced;
    } else
        result.removed_triangles = remove_pinches(surface);
    PointChooser chooser(surface, score);
    const std::vector<PatchEdge> patch_edges = find_patch_edges(surface, chooser, limits.front(), context);
    context.check_cancelled();
    const Pieces pieces = find_pieces(surface);
    if (!oriented) face_outwards(surface, pieces, groups);
    if (!given.doubtful.empty()) face_as_given(surface, pieces, given.doubtful);

    FinishedMesh finished = finish_mesh(cloud, surface, patch_edges, params.sharp_angle);
    FeatureParams feature_params;
    feature_params.sharp_angle = params.sharp_angle;
    FeatureLines lines = find_features(finished.mesh, feature_params, context.threads());
    tell_far_sides(lines.graph, finished, samples, patch_edges);
    result.mesh = std::move(finished.mesh);
    result.rows = std::move(finished.rows);
    result.passes = std::move(surface.passes);
    result.features = std::move(lines.graph);
    result.loops = lines.counts.holes + lines.counts.boundaries;
    result.holes = lines.counts.holes;
    const ThinParts thin = params.search_radius ? ThinParts() : find_thin_parts(surface, pieces, context);
    result.thin_loops = thin.loops;
    result.creases = lines.counts.creases;
    result.corners = lines.counts.corners;
    result.ambiguous_loops = lines.counts.ambiguous;
    result.triangles_without_area = lines.counts.without_area;
    result.patch_edges = patch_edges.size();
    result.components = pieces.count;
    result.duplicates = samples.repeats.size();
    result.unused_points = samples.size() - result.rows.size();
    report(result, lines.counts, surface, thin, context);
    context.progress(1);
    return result;
}

}  // namespace scanmill
